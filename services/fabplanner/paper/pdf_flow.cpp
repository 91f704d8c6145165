#include "services/fabplanner/paper/pdf_flow.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"

namespace mortise::fabplanner {
namespace {

constexpr double kTop = 15;                    // mm
constexpr double kBottom = kPaperHeight - 18;  // mm
constexpr double kTextSize = 9.5;              // pt
constexpr double kLineHeight = 4.6;            // mm, of texts of that size
constexpr double kCellGap = 4;                 // mm, between two columns
constexpr double kPictureWidth = 24;           // mm, of a row's picture
constexpr double kPictureHeight = 9;           // mm
constexpr std::size_t kMostLines = 50;         // of a cell: a row is never more than a page
constexpr double kNarrowest = 14;              // mm, of a column that is broken
constexpr render::Color kRule{0.8, 0.8, 0.78};

// The first bytes of `text` that are no wider than `width`, at least one letter of it.
std::string Beginning(const PdfDocument& document, PdfFace face, double size,
                      const std::string& text, double width) {
  std::string begun;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t end = at + 1;
    while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) ++end;
    std::string longer = begun + text.substr(at, end - at);
    if (!begun.empty() && document.TextWidth(face, size, longer) > width) break;
    begun = std::move(longer);
    at = end;
  }
  return begun;
}

}  // namespace

std::vector<std::string> BrokenIntoLines(const PdfDocument& document, PdfFace face, double size,
                                         const std::string& text, double width) {
  std::vector<std::string> lines(1);
  const std::vector<std::string> words =
      absl::StrSplit(PrintableText(text), ' ', absl::SkipEmpty());
  for (std::string word : words) {
    std::string& line = lines.back();
    const std::string longer = line.empty() ? word : absl::StrCat(line, " ", word);
    if (document.TextWidth(face, size, longer) <= width) {
      line = longer;
      continue;
    }
    if (!line.empty()) lines.emplace_back();
    while (document.TextWidth(face, size, word) > width) {
      const std::string part = Beginning(document, face, size, word, width);
      if (part.size() == word.size()) break;
      lines.back() = part;
      lines.emplace_back();
      word.erase(0, part.size());
    }
    lines.back() = word;
  }
  return lines;
}

PdfFlow::PdfFlow(PdfDocument document, std::string title)
    : document_(std::move(document)), title_(std::move(title)) {
  document_.AddPage();
  y_ = kTop;
}

absl::StatusOr<PdfFlow> PdfFlow::Begin(const std::string& title) {
  MORTISE_ASSIGN_OR_RETURN(PdfDocument document, PdfDocument::Begin(title));
  return PdfFlow(std::move(document), title);
}

void PdfFlow::BeginPage() {
  if (y_ <= kTop) return;
  document_.AddPage();
  y_ = kTop;
}

void PdfFlow::Keep(double height) {
  if (y_ + height > kBottom) BeginPage();
}

void PdfFlow::Space(double height) { y_ += height; }

void PdfFlow::Heading(const std::string& text, bool main) {
  const double size = main ? 15 : 11, line = main ? 7 : 5.5;  // pt, mm
  const std::vector<std::string> lines =
      BrokenIntoLines(document_, PdfFace::kBold, size, text, right() - left());
  // Something of what it is over stands on its page.
  Keep(line * static_cast<double>(lines.size()) + 4 * kLineHeight);
  if (main) document_.Bookmark(text);
  if (!main && y_ > kTop) Space(3);
  for (const std::string& one : lines) {
    y_ += line;
    document_.Text(left(), y_ - 1.2, PdfFace::kBold, size, one);
  }
  Space(1);
}

void PdfFlow::Paragraph(const std::string& text, const render::Color& color) {
  for (const std::string& line :
       BrokenIntoLines(document_, PdfFace::kPlain, kTextSize, text, right() - left())) {
    Keep(kLineHeight);
    y_ += kLineHeight;
    document_.Text(left(), y_ - 1.2, PdfFace::kPlain, kTextSize, line, color);
  }
  Space(1.5);
}

std::vector<double> PdfFlow::WidthsOf(const std::vector<std::string>& columns,
                                      const std::vector<PdfRow>& rows, double room) const {
  std::vector<double> widths;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    double width = document_.TextWidth(PdfFace::kBold, kTextSize, columns[c]);
    for (const PdfRow& row : rows) {
      width = std::max(width, document_.TextWidth(PdfFace::kPlain, kTextSize, row.cells[c]));
    }
    widths.push_back(width + kCellGap);
  }
  // The widest give way until all fit.
  double over = std::accumulate(widths.begin(), widths.end(), 0.0) - room;
  while (over > 1e-6) {
    const auto widest = std::max_element(widths.begin(), widths.end());
    if (*widest <= kNarrowest) break;
    double second = kNarrowest;
    for (const double& width : widths) {
      if (&width != &*widest) second = std::max(second, std::min(width, *widest - 1));
    }
    const double less = std::min(over, std::max(*widest - second, 1.0));
    *widest -= less;
    over -= less;
  }
  return widths;
}

PdfFlow::BrokenRow PdfFlow::Broken(const PdfRow& row, const std::vector<double>& widths,
                                   PdfFace face) const {
  BrokenRow broken;
  std::size_t lines = 1;
  for (std::size_t c = 0; c < row.cells.size(); ++c) {
    broken.cells.push_back(
        BrokenIntoLines(document_, face, kTextSize, row.cells[c], widths[c] - kCellGap + 0.01));
    if (broken.cells.back().size() > kMostLines) {
      broken.cells.back().resize(kMostLines);
      broken.cells.back().back() = "…";
    }
    lines = std::max(lines, broken.cells.back().size());
  }
  broken.height =
      std::max(static_cast<double>(lines) * kLineHeight, row.picture.empty() ? 0 : kPictureHeight) +
      0.8;
  return broken;
}

absl::Status PdfFlow::Write(const BrokenRow& broken, const PdfRow& row,
                            const std::vector<double>& widths, double indent, PdfFace face) {
  double x = left() + indent;
  if (!row.picture.empty()) {
    MORTISE_RETURN_IF_ERROR(
        document_.Picture(row.picture, left(), y_ + 0.4, kPictureWidth, kPictureHeight));
  }
  for (std::size_t c = 0; c < broken.cells.size(); ++c) {
    double line = y_ + kLineHeight - 1.1;
    for (const std::string& text : broken.cells[c]) {
      document_.Text(x, line, face, kTextSize, text);
      line += kLineHeight;
    }
    x += widths[c];
  }
  y_ += broken.height;
  document_.Line(left(), y_, right(), y_, 0.1, kRule);
  return absl::OkStatus();
}

absl::Status PdfFlow::Table(const std::vector<std::string>& columns,
                            const std::vector<PdfRow>& rows) {
  const bool has_pictures =
      std::any_of(rows.begin(), rows.end(), [](const PdfRow& row) { return !row.picture.empty(); });
  const double indent = has_pictures ? kPictureWidth + kCellGap : 0;
  const std::vector<double> widths = WidthsOf(columns, rows, right() - left() - indent);
  const bool is_named = std::any_of(columns.begin(), columns.end(),
                                    [](const std::string& name) { return !name.empty(); });
  const auto write_names = [&]() -> absl::Status {
    if (!is_named) return absl::OkStatus();
    const PdfRow names = {columns};
    return Write(Broken(names, widths, PdfFace::kBold), names, widths, indent, PdfFace::kBold);
  };
  Keep(3 * kLineHeight);
  MORTISE_RETURN_IF_ERROR(write_names());
  for (const PdfRow& row : rows) {
    const BrokenRow broken = Broken(row, widths, PdfFace::kPlain);
    if (y_ + broken.height > kBottom && y_ > kTop) {
      BeginPage();
      MORTISE_RETURN_IF_ERROR(write_names());
    }
    MORTISE_RETURN_IF_ERROR(Write(broken, row, widths, indent, PdfFace::kPlain));
  }
  Space(3);
  return absl::OkStatus();
}

absl::Status PdfFlow::Picture(const std::string& png, double height, double aspect) {
  const double width = std::min(height * aspect, right() - left());
  const double drawn = width / aspect;
  Keep(drawn);
  MORTISE_RETURN_IF_ERROR(document_.Picture(png, (kPaperWidth - width) / 2, y_, width, drawn));
  Space(drawn + 2);
  return absl::OkStatus();
}

absl::StatusOr<std::string> PdfFlow::Finish() {
  for (int page = 0; page < document_.pages(); ++page) {
    document_.SelectPage(page);
    const double line = kPaperHeight - 9;
    const std::string number = absl::StrCat(page + 1, "/", document_.pages());
    document_.Text(right() - document_.TextWidth(PdfFace::kPlain, 8, number), line, PdfFace::kPlain,
                   8, number, kPaleInk);
    const std::vector<std::string> title =
        BrokenIntoLines(document_, PdfFace::kPlain, 8, title_, right() - left() - 25);
    document_.Text(left(), line, PdfFace::kPlain, 8, title.front(), kPaleInk);
  }
  return document_.Finish();
}

}  // namespace mortise::fabplanner
