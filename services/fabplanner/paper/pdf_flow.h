// Sets headings, paragraphs, tables and pictures below each other, page after page.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/paper/pdf_document.h"

namespace mortise::fabplanner {

// A row of a table; `picture` (PNG, 8 : 3) is drawn before its cells where it is not empty.
struct PdfRow {
  std::vector<std::string> cells;  // as many as there are columns
  std::string picture = {};
};

class PdfFlow {
 public:
  // Begins a document on A4 with a first page. `title` stands below each page, with its number.
  // Fails as PdfDocument::Begin does.
  static absl::StatusOr<PdfFlow> Begin(const std::string& title);

  // Begins a page, unless nothing is on this one yet.
  void BeginPage();
  // Sees to it that `height` (mm) fits on this page, or else begins one.
  void Keep(double height);
  void Space(double height);

  // Writes headings, each a bookmark if it is the page's `main` one, and texts, broken into lines.
  void Heading(const std::string& text, bool main);
  void Paragraph(const std::string& text, const render::Color& color = kInk);

  // Writes a table; a row is never broken, and the columns' names stand again on each page. Columns
  // are as wide as their texts, the widest of them broken where they do not fit; of a cell of more
  // than 50 lines the rest is "…".
  absl::Status Table(const std::vector<std::string>& columns, const std::vector<PdfRow>& rows);

  // Draws a picture (PNG) in the middle, `height` mm high.
  absl::Status Picture(const std::string& png, double height, double aspect);

  // What is drawn by hand goes to document(), between left() and right(), from y() on downwards,
  // and then takes its height by Space.
  PdfDocument& document() { return document_; }
  double left() const { return 15; }
  double right() const { return kPaperWidth - 15; }
  double y() const { return y_; }

  // Writes titles and numbers below all pages, and returns the file.
  absl::StatusOr<std::string> Finish();

 private:
  PdfFlow(PdfDocument document, std::string title);
  std::vector<double> WidthsOf(const std::vector<std::string>& columns,
                               const std::vector<PdfRow>& rows, double room) const;
  // A row whose texts are broken into lines.
  struct BrokenRow {
    std::vector<std::vector<std::string>> cells;
    double height = 0;  // mm
  };
  BrokenRow Broken(const PdfRow& row, const std::vector<double>& widths, PdfFace face) const;
  absl::Status Write(const BrokenRow& broken, const PdfRow& row, const std::vector<double>& widths,
                     double indent, PdfFace face);

  PdfDocument document_;
  std::string title_;
  double y_ = 0;  // mm, where what comes next begins
};

// Returns the text in lines no wider than `width` mm, broken between words, and within words that
// are wider. At least one line.
std::vector<std::string> BrokenIntoLines(const PdfDocument& document, PdfFace face, double size,
                                         const std::string& text, double width);

}  // namespace mortise::fabplanner
