// What an assembly guide says, as texts: the same on the page and on paper.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// A row of a table: what is alike is told once, with how many there are.
struct GuideRow {
  int count = 1;
  std::vector<std::string> cells;  // as many as the table has columns
  int fastener = -1;               // index into GuideContents::fasteners; -1 for none
};

struct GuideTable {
  std::string heading;  // may be empty
  std::string note;     // may be empty
  std::vector<std::string> columns;
  std::vector<GuideRow> rows;
};

struct GuideStep {
  int number = 0;
  std::string title;  // "Step 3", "Step 3: drawer"
  std::string instruction;
  std::vector<GuideTable>
      tables;  // fasteners, added parts, where the fasteners go; those with rows
};

// A fastener that is counted, with a small picture (PNG).
struct GuideFastener {
  std::string title;
  std::string picture;
};

struct GuideContents {
  std::string title;
  std::string summary;             // "9 parts, 22 pegs, 3 steps; make 2 of them"
  bool has_ways = false;           // whether steps know the ways of their parts
  std::vector<std::string> notes;  // what was not checked
  std::vector<GuideTable> tables;  // parts and holes; those with rows
  std::vector<GuideStep> steps;
  std::vector<GuideFastener> fasteners;
};

// Returns the contents. `title` of the design is for people. Fails where a fastener's picture
// cannot be drawn.
absl::StatusOr<GuideContents> ContentsOf(const FabricationPlan& plan, const Design& design,
                                         const Items& items, const std::string& title);

}  // namespace mortise::fabplanner
