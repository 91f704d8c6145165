// Makes the files of a plan, which people take to the workshop.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/documents/part_labels.h"
#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

struct PlanFile {
  std::string file_name;   // "cut-list.csv"
  std::string media_type;  // "text/csv"
  std::string bytes;
};

// The file name of the whole design, where a plan has it.
inline constexpr char kDesignStepFile[] = "design.step";

// Returns the file name of a step's picture: "step-3.png".
std::string StepPictureName(int number);

// Called before each file with how many are done and how many there are; false stops the work.
using FileProgress = std::function<bool(int done, int total)>;

// Makes cut-list.csv, bill-of-materials.csv, bill.csv and bill.xlsx (the bill as a tree),
// parts.csv, holes.csv, boards.svg and sheets.svg (where there are any), an SVG and an STL of what
// is made to shape, a picture a step, assembly-guide.html, which holds them and their shapes, and
// what is printed: assembly-guide.pdf, cut-list.pdf and, where there are parts to label,
// labels.pdf. CANCELLED if `progress` says so.
absl::StatusOr<std::vector<PlanFile>> MakePlanFiles(const FabricationPlan& plan,
                                                    const Design& design, const Items& items,
                                                    const PlanNames& names,
                                                    const FileProgress& progress);

}  // namespace mortise::fabplanner
