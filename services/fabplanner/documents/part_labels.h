// What stands on the labels of parts.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// What a plan's papers call it.
struct PlanNames {
  std::string title;         // of the design, for people
  std::string plan = {};     // "plans/0198c1"
  std::string address = {};  // where codes lead to: "https://example.com/shop/"; empty for nowhere
};

// What stands on one label.
struct LabelContents {
  std::string part;   // label of the part: "leg_1", of several copies "leg_1.2"
  int step = 0;       // in which it is joined; 0 for none
  std::string size;   // "720 × 45 × 45 mm"
  std::string stock;  // "board-1 at 10 mm", "sheet-1 at 10, 20 mm"; otherwise how it is come by
  std::string item;   // title of what it is made of
  std::string code;   // what the QR code holds
};

// Returns a label for each part in each copy, but for connecting parts that are bought: first what
// comes off boards and sheets, in their order, then the rest in the design's.
std::vector<LabelContents> LabelsOf(const FabricationPlan& plan, const Design& design,
                                    const Items& items, const PlanNames& names);

// Returns what a code holds: "plans/0198c1/parts/leg_1?step=2", behind the address if there is one.
// The part's label is percent-encoded but for letters, digits, ".", "-", "_" and "~", so that the
// text is the end of a link; of a part that no step joins there is no "?step".
std::string CodeText(const PlanNames& names, const std::string& part, int step);

// INVALID_ARGUMENT naming `field` unless the address is empty, or http or https with a host, of at
// most 500 bytes of printable ASCII, without a query, a fragment or a user.
absl::Status CheckLabelAddress(const std::string& address, const std::string& field);

}  // namespace mortise::fabplanner
