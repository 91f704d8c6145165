// Finds how a thing is taken apart, one straight movement after the other. It is put together in
// the opposite order.
//
// What can be taken off a set can be taken off each of its subsets, so taking apart never has to go
// back; where nothing comes off alone, several are taken off as one and taken apart by themselves.
#pragma once

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
};

// Units that come off in one piece.
struct Removal {
  std::vector<int> units;  // ascending
  int direction = 0;       // in which they leave
};

struct TakenApart {
  int base = 0;  // what stays: the largest of what stands lowest
  // The steps in order of taking off; all that one entry has comes off in one step.
  std::vector<std::vector<Removal>> steps;
  // The units that could not be taken off each other, with the base; empty if all came apart.
  std::vector<int> stuck;
};

// Says which units are linked to each other.
using Links = std::vector<std::vector<bool>>;

// Whether links join all of the units.
bool InOnePiece(const std::vector<int>& units, const Links& links);

// Takes `units`, at least one, apart. `held` says which are fastened to each other; `linked` which
// are, or touch. The units that stay are kept fastened together where that can be, else touching.
// The result depends on nothing but the arguments. Once a stop is requested all that is left is
// stuck.
TakenApart TakeApart(const std::vector<int>& units, const std::vector<UnitFacts>& facts,
                     const Links& held, const Links& linked, const Blocking& blocking,
                     const std::stop_token& stop = {});

}  // namespace mortise::fabplanner
