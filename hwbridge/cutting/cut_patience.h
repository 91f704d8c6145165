// How long a machine may take for a cut before a person has to look at it.
//
// A machine may take a cut and never end it: its tool is stuck, or its program does not say what it
// did. Nothing that it says is untrue then, so that only time can tell. What counts is the time in
// which the machine should move by itself, in Execute or on its way between two waiting states; a
// machine that is held, or cannot be reached, waits for others.
#pragma once

#include <optional>
#include <string>

#include "hwbridge/cutting/journal.h"
#include "hwbridge/registers/packml.h"

namespace mortise::hwbridge {

// Five times what a slow machine takes: 10 s for the cut, 0.1 m/s of feed, 0.01 m/s along an
// outline; but at least five minutes. In s.
double DefaultCutPatience(const Job& job);

class CutPatience {
 public:
  // `seconds` for any cut, or by default what DefaultCutPatience says. Two scans further apart
  // than `longest_scan` count as so far apart: nobody knows what the machine did in between.
  CutPatience(std::optional<double> seconds, double longest_scan);

  // The machine is in `state` at `now` (s) and has `order` to make, or in hand. Why somebody has to
  // look, once it took too long; nothing before. A new cut, or `Renew`, begins anew.
  std::optional<std::string> Note(const CutOrder& order, PackMlState state, double now);

  // No cut is to be made, or a person has looked.
  void Renew();

 private:
  std::optional<double> seconds_;
  double longest_scan_;
  std::optional<CutKey> key_;  // of the cut that is watched
  double worked_ = 0.0;        // s for that cut
  double last_ = 0.0;          // s on the clock, of the last scan
};

}  // namespace mortise::hwbridge
