// Writes what people read of a step in which connecting parts hold things together.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// The facts of a step, as indices of parts.
struct StepFacts {
  struct Arrival {
    std::vector<int> parts;   // of one part, or of what was built before
    std::string built;        // the name of a sub-assembly; empty for a part
    std::string coming_from;  // "from above"; empty for what the rest comes onto
  };
  std::string subassembly;
  std::vector<Arrival> arrivals;
  std::vector<int> connectors;
  std::vector<Mark> marks;                   // to draw for them
  std::vector<std::pair<int, int>> unknown;  // parts that reach into each other
  std::vector<int> stuck;                    // parts that block each other
};

// Returns "2 × Side and Bottom": alike parts once, with their number.
std::string CountedTitles(const Design& design, const std::vector<int>& parts);

// Returns the instruction.
std::string StepText(const Design& design, const Items& items, const StepFacts& facts);

// Returns what a mark says: "40 mm from the front and 100 mm from below".
std::string MarkText(const Design& design, const Mark& mark);

}  // namespace mortise::fabplanner
