#include "services/fabplanner/documents/assembly_guide_pdf.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/paper/pdf_flow.h"

namespace mortise::fabplanner {
namespace {

constexpr double kStepPictureHeight = 118;  // mm

absl::Status WriteTable(const GuideTable& table, const std::vector<GuideFastener>& fasteners,
                        PdfFlow& flow) {
  if (!table.heading.empty()) flow.Heading(table.heading, false);
  if (!table.note.empty()) flow.Paragraph(table.note, kPaleInk);
  std::vector<std::string> columns = {""};
  columns.insert(columns.end(), table.columns.begin(), table.columns.end());
  std::vector<PdfRow> rows;
  for (const GuideRow& row : table.rows) {
    PdfRow written;
    written.cells.push_back(absl::StrCat(row.count, " ×"));
    written.cells.insert(written.cells.end(), row.cells.begin(), row.cells.end());
    if (row.fastener >= 0) {
      written.picture = fasteners[static_cast<std::size_t>(row.fastener)].picture;
    }
    rows.push_back(std::move(written));
  }
  return flow.Table(columns, rows);
}

}  // namespace

absl::StatusOr<std::string> AssemblyGuidePdf(const GuideContents& contents,
                                             const std::vector<std::string>& pictures) {
  MORTISE_ASSIGN_OR_RETURN(PdfFlow flow,
                           PdfFlow::Begin(absl::StrCat(contents.title, ": assembly guide")));
  flow.Heading(contents.title, true);
  flow.Paragraph("Assembly guide. Sizes in millimetres: length × width × thickness.", kPaleInk);
  flow.Paragraph(absl::StrCat(contents.summary,
                              ". In the pictures what comes in is orange, what "
                              "is built already grey, what holds it brown; "
                              "arrows show where things go."));
  for (const std::string& note : contents.notes) flow.Paragraph(note, kPaleInk);
  for (const GuideTable& table : contents.tables) {
    MORTISE_RETURN_IF_ERROR(WriteTable(table, contents.fasteners, flow));
  }
  for (std::size_t i = 0; i < contents.steps.size(); ++i) {
    const GuideStep& step = contents.steps[i];
    flow.BeginPage();
    flow.Heading(step.title, true);
    flow.Paragraph(step.instruction);
    if (i < pictures.size() && !pictures[i].empty()) {
      MORTISE_RETURN_IF_ERROR(flow.Picture(pictures[i], kStepPictureHeight, 4.0 / 3));
    }
    for (const GuideTable& table : step.tables) {
      MORTISE_RETURN_IF_ERROR(WriteTable(table, contents.fasteners, flow));
    }
  }
  return flow.Finish();
}

}  // namespace mortise::fabplanner
