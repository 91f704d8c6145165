// Says how deep the connecting parts of a connection reach into what they hold.
#pragma once

#include <string>
#include <vector>

#include "common/assembly/connections/connection.h"
#include "common/assembly/connections/connection_optimizer.h"

namespace mortise::composer {

// A connecting element that reaches into a principal from one side, as the tip of a screw does into
// a board: along `axis` one of the two ends within the other.
struct Hold {
  int connecting = 0;  // index into the connection's elements
  int principal = 0;   // another
  parametric::Axis axis = parametric::Axis::kX;
  bool from_below = false;  // the connecting element's upper end is in the principal
  double depth = 0;         // m, as drawn
};

// Returns the holds of a connection as drawn. Along axes on which one of the two lies within the
// other there is none: the connection's relationships keep it there. O(elements²).
std::vector<Hold> HoldsOf(const parametric::ElementConnection& connection);

// Returns what is wrong with the connection so placed: a hold less deep than `share` of what it is
// as drawn. It is empty if nothing is.
std::string LooseHold(const parametric::ElementConnection& connection,
                      const parametric::OptimizedConnection& placed, double share);

}  // namespace mortise::composer
