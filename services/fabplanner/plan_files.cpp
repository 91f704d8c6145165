#include "services/fabplanner/plan_files.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/assembly_guide_html.h"
#include "services/fabplanner/assembly_picture.h"
#include "services/fabplanner/layout_svg.h"
#include "services/fabplanner/plan_csv.h"

namespace mortise::fabplanner {

std::string StepPictureName(int number) { return absl::StrCat("step-", number, ".png"); }

absl::StatusOr<std::vector<PlanFile>> MakePlanFiles(const FabricationPlan& plan,
                                                    const Design& design, const Items& items,
                                                    const std::string& title,
                                                    const FileProgress& progress) {
  std::vector<PlanFile> files;
  files.push_back({"cut-list.csv", "text/csv", CutListCsv(plan)});
  files.push_back({"bill-of-materials.csv", "text/csv", BillCsv(plan)});
  if (!plan.boards.empty()) files.push_back({"boards.svg", "image/svg+xml", BoardsSvg(plan)});
  if (!plan.sheets.empty()) files.push_back({"sheets.svg", "image/svg+xml", SheetsSvg(plan)});
  const int total = static_cast<int>(files.size() + plan.steps.size()) + 1;
  std::vector<std::string> pictures;
  for (const AssemblyStep& step : plan.steps) {
    if (!progress(static_cast<int>(files.size()), total)) return absl::CancelledError();
    MORTISE_ASSIGN_OR_RETURN(pictures.emplace_back(), StepPicture(design, plan.steps, step.number));
    files.push_back({StepPictureName(step.number), "image/png", pictures.back()});
  }
  files.push_back({"assembly-guide.html", "text/html",
                   AssemblyGuideHtml(plan, design, items, title, pictures)});
  return files;
}

}  // namespace mortise::fabplanner
