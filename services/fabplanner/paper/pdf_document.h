// Writes PDF: A4 pages with texts, lines, areas and pictures. Places are millimetres from the
// page's upper left corner, x to the right and y down; sizes of letters are points.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/render/image.h"

namespace mortise::fabplanner {

enum class PdfFace { kPlain, kBold };

inline constexpr double kPaperWidth = 210;   // mm
inline constexpr double kPaperHeight = 297;  // mm
inline constexpr render::Color kInk{0.1, 0.11, 0.13};
inline constexpr render::Color kPaleInk{0.4, 0.42, 0.45};

// A square of light and dark modules, row by row from the top.
struct ModuleSquare {
  int side = 0;
  std::vector<bool> dark;  // side · side
};

class PdfDocument {
 public:
  // Begins a document without pages. FAILED_PRECONDITION where the fonts are not installed, naming
  // their package. `title` is UTF-8, as all texts are: letters that the font lacks are boxes, what
  // is no UTF-8 is "?", control characters are spaces.
  static absl::StatusOr<PdfDocument> Begin(const std::string& title);

  PdfDocument(PdfDocument&&) noexcept;
  PdfDocument& operator=(PdfDocument&&) noexcept;
  ~PdfDocument();

  // Begins a page, on which all is drawn that follows.
  void AddPage();
  int pages() const;
  // Goes back to a page, from 0 to pages() − 1.
  void SelectPage(int page);

  // Returns the width of a text, mm.
  double TextWidth(PdfFace face, double size, const std::string& text) const;
  // Writes a text on the line y.
  void Text(double x, double y, PdfFace face, double size, const std::string& text,
            const render::Color& color = kInk);
  void Line(double x0, double y0, double x1, double y1, double width, const render::Color& color);
  // Fills a polygon, and draws its border.
  void Polygon(const std::vector<Eigen::Vector2d>& points, const render::Color& fill,
               const render::Color& border);
  // Draws a picture (PNG) that fills the rectangle. The same picture is kept once. INVALID_ARGUMENT
  // where it is none.
  absl::Status Picture(const std::string& png, double x, double y, double width, double height);
  // Draws a square of modules; the quiet zone around it is the caller's.
  void Modules(const ModuleSquare& square, double x, double y, double side);
  // Makes the page known by a title in the reader's list of contents.
  void Bookmark(const std::string& title);

  // Returns the file. Nothing may be drawn afterwards. INTERNAL where anything could not be
  // written.
  absl::StatusOr<std::string> Finish();

 private:
  class Pages;
  explicit PdfDocument(std::unique_ptr<Pages> pages);
  std::unique_ptr<Pages> pages_;
};

// Returns a text as documents write it: valid UTF-8 of the basic plane, without control characters.
std::string PrintableText(std::string_view text);

}  // namespace mortise::fabplanner
