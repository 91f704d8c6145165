#include "services/fabplanner/documents/labels_pdf.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/paper/pdf_document.h"
#include "services/fabplanner/paper/pdf_flow.h"
#include "services/fabplanner/paper/qr_code.h"

namespace mortise::fabplanner {
namespace {

constexpr int kColumns = 3, kRows = 8;
constexpr double kLabelWidth = 70, kLabelHeight = 36;                      // mm
constexpr double kAbove = (kPaperHeight - kRows * kLabelHeight) / 2;       // mm
constexpr double kPadding = 5;                                             // mm: printers' margins
constexpr double kCodeSide = 25;                                           // mm
constexpr double kTextWidth = kLabelWidth - 2 * kPadding - kCodeSide - 3;  // mm

// Writes at most `most` lines from `y` on, the last of them shortened, and returns where they end.
double WriteLines(PdfDocument& document, double x, double y, PdfFace face, double size,
                  const std::string& text, std::size_t most, const render::Color& color) {
  std::vector<std::string> lines = BrokenIntoLines(document, face, size, text, kTextWidth);
  if (lines.size() > most) {
    lines.resize(most);
    lines.back() += "…";
  }
  for (const std::string& line : lines) {
    y += 0.43 * size;
    document.Text(x, y, face, size, line, color);
  }
  return y;
}

absl::Status DrawLabel(PdfDocument& document, const LabelContents& label, double left,
                       double above) {
  MORTISE_ASSIGN_OR_RETURN(const ModuleSquare code, QrCodeOf(label.code));
  const double middle = above + kLabelHeight / 2;
  document.Modules(code, left + kPadding, middle - kCodeSide / 2, kCodeSide);
  const double x = left + kPadding + kCodeSide + 3;
  double y = above + kPadding - 1.5;
  y = WriteLines(document, x, y, PdfFace::kBold, 10.5, label.part, 2, kInk) + 0.8;
  if (label.step > 0) {
    y = WriteLines(document, x, y, PdfFace::kBold, 8.5, absl::StrCat("Step ", label.step), 1, kInk);
  }
  y = WriteLines(document, x, y, PdfFace::kPlain, 7.5, label.size, 2, kInk);
  y = WriteLines(document, x, y, PdfFace::kPlain, 7.5, label.stock, 2, kInk);
  if (y < above + kLabelHeight - 4) {
    WriteLines(document, x, y, PdfFace::kPlain, 6.5, label.item, 1, kPaleInk);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::string> LabelsPdf(const std::vector<LabelContents>& labels,
                                      const std::string& title) {
  MORTISE_ASSIGN_OR_RETURN(PdfDocument document, PdfDocument::Begin(title));
  constexpr std::size_t kOnPage = kColumns * kRows;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (i % kOnPage == 0) document.AddPage();
    const auto column = static_cast<double>(i % kColumns);
    const auto row = static_cast<double>(i % kOnPage / kColumns);
    MORTISE_RETURN_IF_ERROR(
        DrawLabel(document, labels[i], column * kLabelWidth, kAbove + row * kLabelHeight));
  }
  return document.Finish();
}

}  // namespace mortise::fabplanner
