#include "services/fabplanner/documents/cut_list_pdf.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/documents/alike_stock.h"
#include "services/fabplanner/paper/pdf_flow.h"
#include "services/fabplanner/plan/bill_of_materials.h"
#include "services/fabplanner/plan/dimension_text.h"
#include "services/fabplanner/plan/money.h"

namespace mortise::fabplanner {
namespace {

constexpr double kBoardDiagramHeight = 11;  // mm
constexpr double kMostSheetDiagram = 95;    // mm high
constexpr double kDiagramText = 7;          // pt
constexpr render::Color kStockFill{0.985, 0.975, 0.95};
constexpr render::Color kStockBorder{0.3, 0.3, 0.3};

class CutListWriter {
 public:
  CutListWriter(const FabricationPlan& plan, const Items& items, PdfFlow flow)
      : plan_(plan), items_(items), flow_(std::move(flow)) {}

  absl::StatusOr<std::string> Write(const std::string& title) {
    flow_.Heading(title, true);
    flow_.Paragraph(
        absl::StrCat("Cut list. Millimetres; saw cut ", Millimetres(plan_.rules.kerf),
                     ". Places are from a board's front end (left), and from a sheet's lower left "
                     "corner."),
        kPaleInk);
    MORTISE_RETURN_IF_ERROR(WriteBoards());
    MORTISE_RETURN_IF_ERROR(WriteSheets());
    if (!plan_.handwork.empty()) {
      flow_.Heading("By hand", true);
      for (const std::string& handwork : plan_.handwork) flow_.Paragraph(handwork);
    }
    MORTISE_RETURN_IF_ERROR(WriteBill());
    return flow_.Finish();
  }

 private:
  std::string ItemTitle(const std::string& name) const {
    const auto found = items_.find(name);
    return found == items_.end() || found->second.title.empty() ? name : found->second.title;
  }

  // The part's colour in all diagrams.
  render::Color ColorOf(const std::string& label) {
    const int number =
        colors_.emplace(WithoutCopy(label), static_cast<int>(colors_.size())).first->second;
    return render::Mix(render::PartColor(number), render::Color{1, 1, 1}, 0.45);
  }

  // A text in the middle of a box, where it fits.
  void WriteInside(double left, double right, double y, const std::string& text) {
    PdfDocument& document = flow_.document();
    const double width = document.TextWidth(PdfFace::kPlain, kDiagramText, text);
    if (width > right - left - 1) return;
    document.Text((left + right - width) / 2, y, PdfFace::kPlain, kDiagramText, text);
  }

  void DrawRectangle(double x0, double y0, double x1, double y1, const render::Color& fill) {
    flow_.document().Polygon({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}}, fill, kStockBorder);
  }

  absl::Status WriteBoards() {
    double longest = 0;
    for (const BoardLayout& board : plan_.boards) longest = std::max(longest, board.stock_length);
    const double scale = longest > 0 ? (flow_.right() - flow_.left()) / longest : 0;
    bool first = true;
    for (const AlikeStock& alike : AlikeBoards(plan_.boards)) {
      const BoardLayout& board = plan_.boards[alike.first];
      if (std::exchange(first, false)) flow_.Heading("Boards", true);
      flow_.Keep(34);
      flow_.Heading(absl::StrCat(LabelsText(alike), ": ", ItemTitle(board.item), ", ",
                                 Millimetres(board.width), " × ", Millimetres(board.thickness),
                                 ", ", Millimetres(board.stock_length), " long"),
                    false);
      DrawBoard(board, scale, alike.labels.size() > 1);
      MORTISE_RETURN_IF_ERROR(WriteSegments(board, alike.labels.size() > 1));
    }
    return absl::OkStatus();
  }

  // Ends that are not square are drawn square, and told in the table.
  void DrawBoard(const BoardLayout& board, double scale, bool is_alike) {
    const double top = flow_.y() + 0.5, low = top + kBoardDiagramHeight;
    DrawRectangle(flow_.left(), top, flow_.left() + board.stock_length * scale, low, kStockFill);
    for (const BoardSegment& segment : board.segments) {
      const double x0 = flow_.left() + segment.start * scale, x1 = x0 + segment.length * scale;
      DrawRectangle(x0, top, x1, low, ColorOf(segment.part));
      WriteInside(x0, x1, top + 4.6, is_alike ? WithoutCopy(segment.part) : segment.part);
      WriteInside(x0, x1, top + 8.6, Millimetres(segment.length));
    }
    flow_.Space(kBoardDiagramHeight + 1.5);
  }

  absl::Status WriteSegments(const BoardLayout& board, bool is_alike) {
    std::vector<PdfRow> rows;
    for (const BoardSegment& segment : board.segments) {
      rows.push_back(
          {{is_alike ? WithoutCopy(segment.part) : segment.part, Millimetres(segment.start),
            Millimetres(segment.length), AreSquare(segment.ends) ? "" : EndsText(segment.ends)}});
    }
    return flow_.Table({"Part", "From", "Length", ""}, rows);
  }

  absl::Status WriteSheets() {
    bool first = true;
    for (const AlikeStock& alike : AlikeSheets(plan_.sheets)) {
      const SheetLayout& sheet = plan_.sheets[alike.first];
      const double scale =
          std::min((flow_.right() - flow_.left()) / sheet.length, kMostSheetDiagram / sheet.width);
      if (std::exchange(first, false)) flow_.Heading("Sheets", true);
      flow_.Keep(sheet.width * scale + 30);
      flow_.Heading(absl::StrCat(LabelsText(alike), ": ", ItemTitle(sheet.item), ", ",
                                 Millimetres(sheet.length), " × ", Millimetres(sheet.width), ", ",
                                 Millimetres(sheet.thickness), " thick"),
                    false);
      MORTISE_RETURN_IF_ERROR(WriteSheet(sheet, scale, alike.labels.size() > 1));
    }
    return absl::OkStatus();
  }

  absl::Status WriteSheet(const SheetLayout& sheet, double scale, bool is_alike) {
    const double left = flow_.left(), top = flow_.y() + 0.5, low = top + sheet.width * scale;
    DrawRectangle(left, top, left + sheet.length * scale, low, kStockFill);
    std::vector<PdfRow> rows;
    for (const SheetPlacement& placement : sheet.placements) {
      Eigen::Vector2d lower = placement.outline.front(), upper = lower;
      std::vector<Eigen::Vector2d> points;
      for (const Eigen::Vector2d& point : placement.outline) {
        lower = lower.cwiseMin(point);
        upper = upper.cwiseMax(point);
        points.emplace_back(left + point.x() * scale, low - point.y() * scale);
      }
      flow_.document().Polygon(points, ColorOf(placement.part), kStockBorder);
      const std::string part = is_alike ? WithoutCopy(placement.part) : placement.part;
      WriteInside(left + lower.x() * scale, left + upper.x() * scale,
                  low - (lower.y() + upper.y()) / 2 * scale + 1, part);
      rows.push_back({{part, absl::StrCat(Millimetres(lower.x()), ", ", Millimetres(lower.y())),
                       absl::StrCat(Millimetres(upper.x() - lower.x()), " × ",
                                    Millimetres(upper.y() - lower.y()))}});
    }
    flow_.Space(sheet.width * scale + 2);
    return flow_.Table({"Part", "At", "Size"}, rows);
  }

  absl::Status WriteBill() {
    if (plan_.bill.lines.empty()) return absl::OkStatus();
    flow_.BeginPage();
    flow_.Heading("Bill of materials", true);
    std::vector<PdfRow> rows;
    const auto price = [](const Money& money) {
      return money.currency.empty() ? std::string("not known")
                                    : absl::StrCat(AmountText(money), " ", money.currency);
    };
    for (const BillLine& line : plan_.bill.lines) {
      rows.push_back({{absl::StrCat(line.quantity, " ×"), line.title, line.dimensions,
                       absl::StrCat(line.supplier, line.supplier_number.empty() ? "" : " ",
                                    line.supplier_number),
                       price(line.price)}});
    }
    for (const Money& total : plan_.bill.totals) {
      rows.push_back({{"", UnpricedLines(plan_.bill) == 0 ? "Total" : "Total of what has a price",
                       "", "", price(total)}});
    }
    return flow_.Table({"", "Item", "Size to order", "Supplier", "Price"}, rows);
  }

  const FabricationPlan& plan_;
  const Items& items_;
  PdfFlow flow_;
  std::map<std::string, int> colors_;
};

}  // namespace

absl::StatusOr<std::string> CutListPdf(const FabricationPlan& plan, const Items& items,
                                       const std::string& title) {
  MORTISE_ASSIGN_OR_RETURN(PdfFlow flow, PdfFlow::Begin(absl::StrCat(title, ": cut list")));
  return CutListWriter(plan, items, std::move(flow)).Write(title);
}

}  // namespace mortise::fabplanner
