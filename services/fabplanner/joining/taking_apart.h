// Finds how a thing is taken apart, one straight movement after the other. It is put together in
// the opposite order.
//
// What can be taken off a set can be taken off each of its subsets, so taking apart never has to go
// back; where nothing comes off alone, several are taken off as one and taken apart by themselves.
#pragma once

#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "services/fabplanner/joining/blocking.h"

namespace mortise::fabplanner {

// The facts known of a unit besides what stands in its way.
struct UnitFacts {
  std::string family;  // those of one are taken off in one step; empty for none
  bool built = false;  // a sub-assembly: taken off first
  bool rolls = false;  // nothing is built upon a wheel
  int group = 0;       // of the drawing: what is drawn later is taken off first
  double lowest = 0;   // m, of its box
  double highest = 0;  // m
  double volume = 0;   // m³, of its box
  // What has a higher one is taken off first, what has none (0) at any time.
  int priority = 0;
};

// Units that come off in one piece.
struct Removal {
  std::vector<int> units;  // ascending
  int direction = 0;       // in which they leave
  int priority = 0;        // with which they come in; 0 for none
};

// Units whose priorities the shapes contradict: `late`, which has the higher one, only comes off
// once `early` has.
struct PriorityConflict {
  int late = 0;
  int early = 0;
};

struct TakenApart {
  // What stays: the largest of what stands lowest, of those with the lowest priority and with none.
  int base = 0;
  // The steps in order of taking off; all that one entry has comes off in one step.
  std::vector<std::vector<Removal>> steps;
  // The units that could not be taken off each other, with the base; empty if all came apart.
  std::vector<int> stuck;
  // Where taking apart ended at priorities; the rest then tells nothing.
  std::optional<PriorityConflict> conflict;
};

// Says which units are linked to each other.
using Links = std::vector<std::vector<bool>>;

// The lowest priority of the connections between two units, 0 for none; empty where there is none.
using ConnectionPriorities = std::vector<std::vector<int>>;

// Whether links join all of the units.
bool InOnePiece(const std::vector<int>& units, const Links& links);

// Takes `units`, at least one, apart. `held` says which are fastened to each other; `linked` which
// are, or touch. The units that stay are kept fastened together where that can be, else touching.
// Those of one priority that can be taken off each by itself at a time are one step. Several come
// off together if they have the highest priority of all that is left, or if what fastens them to
// the rest has.
// The result depends on nothing but the arguments. Once a stop is requested all that is left is
// stuck.
TakenApart TakeApart(const std::vector<int>& units, const std::vector<UnitFacts>& facts,
                     const Links& held, const Links& linked, const Blocking& blocking,
                     const std::stop_token& stop = {}, const ConnectionPriorities& priorities = {});

}  // namespace mortise::fabplanner
