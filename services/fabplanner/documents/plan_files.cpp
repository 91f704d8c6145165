#include "services/fabplanner/documents/plan_files.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/files/stl.h"
#include "services/fabplanner/documents/assembly_guide_html.h"
#include "services/fabplanner/documents/assembly_guide_pdf.h"
#include "services/fabplanner/documents/assembly_picture.h"
#include "services/fabplanner/documents/bill_table.h"
#include "services/fabplanner/documents/bill_workbook.h"
#include "services/fabplanner/documents/cut_list_pdf.h"
#include "services/fabplanner/documents/guide_contents.h"
#include "services/fabplanner/documents/guide_scene.h"
#include "services/fabplanner/documents/labels_pdf.h"
#include "services/fabplanner/documents/layout_svg.h"
#include "services/fabplanner/documents/part_drawing.h"
#include "services/fabplanner/documents/part_mesh.h"
#include "services/fabplanner/documents/plan_csv.h"

namespace mortise::fabplanner {
namespace {

constexpr int kDocuments = 4;  // besides tables, drawings and pictures
constexpr char kPdf[] = "application/pdf";
constexpr char kWorkbook[] = "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet";

// An SVG and an STL of each part that has drawings; alike parts share theirs.
absl::Status AddDrawings(const FabricationPlan& plan, const Design& design,
                         std::vector<PlanFile>* files) {
  std::set<std::string> drawn;
  for (std::size_t i = 0; i < plan.parts.size(); ++i) {
    const PlannedPart& planned = plan.parts[i];
    if (planned.drawings.size() < 2 || !drawn.insert(planned.drawings.front()).second) continue;
    const Part& part = design.parts[i];
    const render::Shape shape = PartShape(part, Eigen::Vector3d::Zero());
    if (shape.triangles.cols() == 0) continue;
    files->push_back(
        {planned.drawings[0], "image/svg+xml", PartDrawingSvg(part, planned.handwork)});
    MORTISE_ASSIGN_OR_RETURN(std::string stl,
                             mesh::WriteStl({shape.vertices, shape.triangles}, planned.part));
    files->push_back({planned.drawings[1], "model/stl", std::move(stl)});
  }
  return absl::OkStatus();
}

// The page, and what is printed of it.
absl::Status AddGuides(const FabricationPlan& plan, const Design& design, const Items& items,
                       const PlanNames& names, const std::vector<std::string>& pictures,
                       const std::vector<SceneStep>& steps, std::vector<PlanFile>* files) {
  MORTISE_ASSIGN_OR_RETURN(const GuideContents contents,
                           ContentsOf(plan, design, items, names.title));
  MORTISE_ASSIGN_OR_RETURN(const GuideScene scene, PackGuideScene(steps));
  files->push_back(
      {"assembly-guide.html", "text/html", AssemblyGuideHtml(contents, pictures, scene)});
  MORTISE_ASSIGN_OR_RETURN(std::string guide, AssemblyGuidePdf(contents, pictures));
  files->push_back({"assembly-guide.pdf", kPdf, std::move(guide)});
  return absl::OkStatus();
}

// What is printed for the saw, and to stick on what comes off it.
absl::Status AddPaper(const FabricationPlan& plan, const Design& design, const Items& items,
                      const PlanNames& names, std::vector<PlanFile>* files) {
  MORTISE_ASSIGN_OR_RETURN(std::string cut_list, CutListPdf(plan, items, names.title));
  files->push_back({"cut-list.pdf", kPdf, std::move(cut_list)});
  const std::vector<LabelContents> labels = LabelsOf(plan, design, items, names);
  if (labels.empty()) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(std::string sheet,
                           LabelsPdf(labels, absl::StrCat(names.title, ": labels")));
  files->push_back({"labels.pdf", kPdf, std::move(sheet)});
  return absl::OkStatus();
}

}  // namespace

std::string StepPictureName(int number) { return absl::StrCat("step-", number, ".png"); }

absl::StatusOr<std::vector<PlanFile>> MakePlanFiles(const FabricationPlan& plan,
                                                    const Design& design, const Items& items,
                                                    const PlanNames& names,
                                                    const FileProgress& progress) {
  std::vector<PlanFile> files;
  files.push_back({"cut-list.csv", "text/csv", CutListCsv(plan)});
  files.push_back({"bill-of-materials.csv", "text/csv", BillCsv(plan)});
  files.push_back({"bill.csv", "text/csv", BillTreeCsv(plan.bill_tree)});
  MORTISE_ASSIGN_OR_RETURN(std::string workbook, BillWorkbook(plan.bill_tree, names.title));
  files.push_back({"bill.xlsx", kWorkbook, std::move(workbook)});
  files.push_back({"parts.csv", "text/csv", PartsCsv(plan, design)});
  if (!plan.holes.empty()) files.push_back({"holes.csv", "text/csv", HolesCsv(plan, design)});
  if (!plan.boards.empty()) files.push_back({"boards.svg", "image/svg+xml", BoardsSvg(plan)});
  if (!plan.sheets.empty()) files.push_back({"sheets.svg", "image/svg+xml", SheetsSvg(plan)});
  MORTISE_RETURN_IF_ERROR(AddDrawings(plan, design, &files));
  const int total = static_cast<int>(files.size() + plan.steps.size()) + kDocuments;
  std::vector<std::string> pictures;
  std::vector<SceneStep> scene;
  for (const AssemblyStep& step : plan.steps) {
    if (!progress(static_cast<int>(files.size()), total)) return absl::CancelledError();
    StepArrangement arrangement = ArrangeStep(design, items, plan.holes, plan.steps, step.number);
    MORTISE_ASSIGN_OR_RETURN(StepPicture picture, DrawStep(arrangement));
    scene.push_back({step.number, std::move(arrangement), picture.view});
    files.push_back({StepPictureName(step.number), "image/png", picture.png});
    pictures.push_back(std::move(picture.png));
  }
  if (!progress(static_cast<int>(files.size()), total)) return absl::CancelledError();
  MORTISE_RETURN_IF_ERROR(AddGuides(plan, design, items, names, pictures, scene, &files));
  MORTISE_RETURN_IF_ERROR(AddPaper(plan, design, items, names, &files));
  return files;
}

}  // namespace mortise::fabplanner
