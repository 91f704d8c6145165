#include "services/fabplanner/documents/layout_svg.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/render/image.h"
#include "services/fabplanner/documents/alike_stock.h"
#include "services/fabplanner/documents/svg_drawing.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

constexpr double kPageWidth = 1180;     // px
constexpr double kMargin = 40;          // px
constexpr double kDrawingWidth = 1040;  // px, of the longest stock
constexpr double kBoardHeight = 40;     // px
constexpr double kRow = 15;             // px, between two rows of dimensions

// The same part has the same colour in all diagrams.
class PartColors {
 public:
  std::string Of(const std::string& label) {
    const auto [entry, is_new] =
        colors_.emplace(WithoutCopy(label), static_cast<int>(colors_.size()));
    return render::HexColor(
        render::Mix(render::PartColor(entry->second), render::Color{1, 1, 1}, 0.35));
  }

 private:
  std::map<std::string, int> colors_;
};

// A text in a box of `width`, shortened where it would stick out; nothing where even that fails.
void TextInside(SvgDrawing& drawing, double x, double y, double width, double size,
                const std::string& text, const std::string& style_class = "") {
  std::string shown = text;
  while (shown.size() > 3 && SvgDrawing::TextWidth(shown, size) > width) {
    shown.pop_back();
    while (!shown.empty() && (static_cast<unsigned char>(shown.back()) & 0xc0) == 0x80) {
      shown.pop_back();
    }
  }
  if (SvgDrawing::TextWidth(shown, size) > width) return;
  if (shown != text) shown.back() = '.';
  drawing.Text(x, y, size, TextAnchor::kMiddle, shown, style_class);
}

// The cuts at either end of a part, as the board is seen from above: its edge v = -width / 2 is the
// lower one.
class SegmentEnds {
 public:
  SegmentEnds(const BoardSegment& segment, const BoardLayout& board)
      : ends_(segment.ends), section_(board.width, board.thickness) {
    front_ = segment.start + ReachOf(ends_.front, section_);
    rear_ = segment.start + segment.length - ReachOf(ends_.rear, section_);
  }

  const EndSlope& front() const { return ends_.front; }
  const EndSlope& rear() const { return ends_.rear; }

  // Where a cut meets the lower (-1) or upper (1) edge of the upper (1) or lower (-1) face, m.
  double FrontAt(int edge, int face) const { return front_ + Off(ends_.front, edge, face); }
  double RearAt(int edge, int face) const { return rear_ + Off(ends_.rear, edge, face); }

 private:
  double Off(const EndSlope& end, int edge, int face) const {
    return edge * end.across * section_.x() / 2 + face * end.through * section_.y() / 2;
  }

  CutEnds ends_;
  Eigen::Vector2d section_;
  double front_ = 0, rear_ = 0;  // m, on the middle line
};

// Whether one cut makes the rear of one part and the front of the next.
bool IsOneCut(const EndSlope& rear, const EndSlope& front, const BoardLayout& board) {
  const Eigen::Vector2d off((rear.across - front.across) * board.width,
                            (rear.through - front.through) * board.thickness);
  return off.cwiseAbs().maxCoeff() <= 2 * kEndTolerance;
}

// A part of a board, its bevels, and how its cuts are set: where they are on the board's lower
// edge, as a stop is set, and the angles of those that are not square.
void DrawSegment(SvgDrawing& drawing, const BoardLayout& board, std::size_t index, bool single,
                 double scale, double y, PartColors& colors) {
  const BoardSegment& segment = board.segments[index];
  const SegmentEnds ends(segment, board);
  const double low = y + kBoardHeight;
  const auto at = [&](double along) { return kMargin + along * scale; };
  drawing.Polygon({{at(ends.FrontAt(1, 1)), y},
                   {at(ends.RearAt(1, 1)), y},
                   {at(ends.RearAt(-1, 1)), low},
                   {at(ends.FrontAt(-1, 1)), low}},
                  "part", colors.Of(segment.part));
  if (ends.front().through != 0) {
    drawing.Line(at(ends.FrontAt(1, -1)), y, at(ends.FrontAt(-1, -1)), low, "hidden");
  }
  if (ends.rear().through != 0) {
    drawing.Line(at(ends.RearAt(1, -1)), y, at(ends.RearAt(-1, -1)), low, "hidden");
  }
  const double x0 = at(segment.start), x1 = at(segment.start + segment.length);
  const double inner0 = at(std::max(ends.FrontAt(1, 1), ends.FrontAt(-1, 1)));
  const double inner1 = at(std::min(ends.RearAt(1, 1), ends.RearAt(-1, 1)));
  TextInside(drawing, (inner0 + inner1) / 2, y + kBoardHeight / 2 + 4, inner1 - inner0 - 6, 12,
             single ? segment.part : WithoutCopy(segment.part));
  // Lengths of neighbours whose ends reach over each other stand in two rows.
  const double raised = HasSlopedEnds(board) && index % 2 == 1 ? kRow : 0;
  drawing.Dimension(x0, x1, y - 8 - raised, Millimetres(segment.length));
  const auto mark = [&](double along, const EndSlope& end) {
    return IsSquare(end) ? Millimetres(along)
                         : absl::StrCat(Millimetres(along), " ∠ ", EndText(end));
  };
  const double rear = ends.RearAt(-1, 1);
  drawing.Text(at(rear), low + 14 + raised, 10, TextAnchor::kEnd, mark(rear, ends.rear()), "quiet");
  const bool is_made =
      index > 0 && IsOneCut(board.segments[index - 1].ends.rear, ends.front(), board);
  if (is_made || IsSquare(ends.front())) return;
  const double front = ends.FrontAt(-1, 1);
  drawing.Text(at(front), low + 14 + 2 * kRow, 10, TextAnchor::kStart, mark(front, ends.front()),
               "quiet");
}

// Returns how far below `y`, the board's upper edge, the drawing ends. `single`: nothing else is
// cut alike, so that labels say which copy a part is of.
double DrawBoard(SvgDrawing& drawing, const BoardLayout& board, const WorkshopRules& rules,
                 bool single, double scale, double y, PartColors& colors) {
  const double left = kMargin;
  drawing.Rectangle(left, y, board.stock_length * scale, kBoardHeight, "stock");
  if (HasSlopedEnds(board)) {
    // Wedges between parts are waste; they show where no part covers them.
    drawing.Rectangle(left, y, (board.stock_length - board.offcut) * scale, kBoardHeight, "waste");
  } else if (!board.segments.empty() && board.segments.front().start > 0) {
    drawing.Rectangle(left, y, board.segments.front().start * scale, kBoardHeight, "waste");
  }
  for (std::size_t i = 0; i < board.segments.size(); ++i) {
    DrawSegment(drawing, board, i, single, scale, y, colors);
  }
  if (board.offcut > rules.kerf) {
    const double x0 = left + (board.stock_length - board.offcut) * scale;
    const double x1 = left + board.stock_length * scale;
    drawing.Rectangle(x0, y, x1 - x0, kBoardHeight, "waste");
    TextInside(drawing, (x0 + x1) / 2, y + kBoardHeight / 2 + 4, x1 - x0 - 6, 11,
               absl::StrCat("offcut ", Millimetres(board.offcut)), "quiet");
  }
  return kBoardHeight + (HasSlopedEnds(board) ? 2 * kRow : 0);
}

// The centre of a polygon's area: inside most outlines, where their label goes.
Eigen::Vector2d CentreOf(const std::vector<Eigen::Vector2d>& outline) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double area = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
    const double cross = a.x() * b.y() - b.x() * a.y();
    area += cross;
    sum += cross * (a + b);
  }
  return area > 0 ? Eigen::Vector2d(sum / (3 * area)) : outline.front();
}

void DrawPlacement(SvgDrawing& drawing, const SheetPlacement& placement, const SheetLayout& sheet,
                   bool single, double scale, double y, PartColors& colors) {
  std::vector<Eigen::Vector2d> points;
  Eigen::Vector2d lower = placement.outline.front(), upper = lower;
  for (const Eigen::Vector2d& point : placement.outline) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
    points.emplace_back(kMargin + point.x() * scale, y + (sheet.width - point.y()) * scale);
  }
  drawing.Polygon(points, "part", colors.Of(placement.part));
  const Eigen::Vector2d size = upper - lower;
  const double width = size.x() * scale, height = size.y() * scale;
  const Eigen::Vector2d centre = CentreOf(placement.outline);
  const double x = kMargin + centre.x() * scale;
  const double middle = y + (sheet.width - centre.y()) * scale;
  if (height > 16) {
    TextInside(drawing, x, middle + 4, width - 8, 12,
               single ? placement.part : WithoutCopy(placement.part));
  }
  if (height > 34) {
    TextInside(drawing, x, middle + 19, width - 8, 11,
               absl::StrCat(Millimetres(size.x()), " × ", Millimetres(size.y())));
  }
  if (height > 50) {
    TextInside(drawing, x, middle + 33, width - 8, 10,
               absl::StrCat("at ", Millimetres(lower.x()), ", ", Millimetres(lower.y())), "quiet");
  }
}

}  // namespace

std::string BoardsSvg(const FabricationPlan& plan) {
  SvgDrawing drawing;
  PartColors colors;
  double longest = 0.001;
  for (const BoardLayout& board : plan.boards) longest = std::max(longest, board.stock_length);
  const double scale = kDrawingWidth / longest;
  double y = kMargin;
  drawing.Text(kMargin, y, 18, TextAnchor::kStart, "Cutting diagram: boards", "heading");
  drawing.Text(kMargin, y += 20, 12, TextAnchor::kStart,
               absl::StrCat("Millimetres. Saw cut ", Millimetres(plan.rules.kerf),
                            "; each end trimmed by ", Millimetres(plan.rules.board_trim),
                            ". Below a board: where to cut, measured from its front end (left)."),
               "quiet");
  if (std::any_of(plan.boards.begin(), plan.boards.end(), HasSlopedEnds)) {
    drawing.Text(kMargin, y += 16, 12, TextAnchor::kStart,
                 "∠: the cut's angle from square, leaning as drawn (heights are not to scale); the "
                 "place is on the board's lower edge.",
                 "quiet");
    drawing.Text(kMargin, y += 16, 12, TextAnchor::kStart,
                 "Broken: where a bevel comes out below. Where two cuts meet, the squarer is made "
                 "first.",
                 "quiet");
  }
  const BoardLayout* last = nullptr;
  for (const AlikeStock& alike : AlikeBoards(plan.boards)) {
    const BoardLayout& board = plan.boards[alike.first];
    if (last == nullptr || last->item != board.item || last->width != board.width ||
        last->thickness != board.thickness) {
      drawing.Text(kMargin, y += 40, 14, TextAnchor::kStart,
                   absl::StrCat(board.item, ", ", Millimetres(board.width), " × ",
                                Millimetres(board.thickness), " mm"),
                   "heading");
    }
    last = &board;
    drawing.Text(kMargin, y += 26, 12, TextAnchor::kStart,
                 absl::StrCat(LabelsText(alike), ", stock ", Millimetres(board.stock_length)));
    y += HasSlopedEnds(board) ? 30 + kRow : 30;
    y += 20 + DrawBoard(drawing, board, plan.rules, alike.labels.size() == 1, scale, y, colors);
  }
  return drawing.Finish(kPageWidth, y + kMargin, "Cutting diagram: boards");
}

std::string SheetsSvg(const FabricationPlan& plan) {
  SvgDrawing drawing;
  PartColors colors;
  double longest = 0.001;
  for (const SheetLayout& sheet : plan.sheets) longest = std::max(longest, sheet.length);
  const double scale = kDrawingWidth / longest;
  double y = kMargin;
  drawing.Text(kMargin, y, 18, TextAnchor::kStart, "Cutting diagram: sheets", "heading");
  drawing.Text(kMargin, y += 20, 12, TextAnchor::kStart,
               absl::StrCat("Millimetres. Trim ", Millimetres(plan.rules.sheet_trim),
                            " at each edge; at least ", Millimetres(plan.rules.sheet_spacing),
                            " between outlines. Positions from the lower left corner; a grain, "
                            "where there is one, runs from left to right."),
               "quiet");
  for (const AlikeStock& alike : AlikeSheets(plan.sheets)) {
    const SheetLayout& sheet = plan.sheets[alike.first];
    drawing.Text(kMargin, y += 40, 14, TextAnchor::kStart,
                 absl::StrCat(LabelsText(alike), ": ", sheet.item, ", ",
                              Millimetres(sheet.thickness), " mm"),
                 "heading");
    y += 32;
    drawing.Dimension(kMargin, kMargin + sheet.length * scale, y - 8, Millimetres(sheet.length));
    drawing.DimensionUpright(y, y + sheet.width * scale, kMargin - 10, Millimetres(sheet.width));
    drawing.Rectangle(kMargin, y, sheet.length * scale, sheet.width * scale, "stock");
    const double trim = plan.rules.sheet_trim;
    drawing.Rectangle(kMargin + trim * scale, y + trim * scale, (sheet.length - 2 * trim) * scale,
                      (sheet.width - 2 * trim) * scale, "edge");
    for (const SheetPlacement& placement : sheet.placements) {
      DrawPlacement(drawing, placement, sheet, alike.labels.size() == 1, scale, y, colors);
    }
    y += sheet.width * scale + 12;
  }
  return drawing.Finish(kPageWidth, y + kMargin, "Cutting diagram: sheets");
}

}  // namespace mortise::fabplanner
