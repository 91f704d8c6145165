#include "services/fabplanner/plan_csv.h"

#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "services/fabplanner/dimension_text.h"

namespace mortise::fabplanner {
namespace {

std::string Field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  return absl::StrCat("\"", absl::StrReplaceAll(text, {{"\"", "\"\""}}), "\"");
}

void AppendRow(const std::vector<std::string>& fields, std::string* csv) {
  for (std::size_t i = 0; i < fields.size(); ++i) {
    absl::StrAppend(csv, i == 0 ? "" : ",", Field(fields[i]));
  }
  csv->append("\r\n");
}

std::string Amount(const Money& money, int digits) {
  return money.currency.empty() ? "" : absl::StrFormat("%.*f", digits, money.amount);
}

}  // namespace

std::string CutListCsv(const FabricationPlan& plan) {
  std::string csv;
  AppendRow({"stock", "item", "process", "part", "start_u_mm", "start_v_mm", "length_mm",
             "width_mm", "thickness_mm"},
            &csv);
  for (const BoardLayout& board : plan.boards) {
    for (const BoardSegment& segment : board.segments) {
      AppendRow(
          {board.label, board.item, "crosscut", segment.part, Millimetres(segment.start), "0",
           Millimetres(segment.length), Millimetres(board.width), Millimetres(board.thickness)},
          &csv);
    }
  }
  for (const SheetLayout& sheet : plan.sheets) {
    for (const SheetPlacement& placement : sheet.placements) {
      Eigen::Vector2d lower = placement.outline.front(), upper = lower;
      for (const Eigen::Vector2d& point : placement.outline) {
        lower = lower.cwiseMin(point);
        upper = upper.cwiseMax(point);
      }
      AppendRow({sheet.label, sheet.item, "outline", placement.part, Millimetres(lower.x()),
                 Millimetres(lower.y()), Millimetres(upper.x() - lower.x()),
                 Millimetres(upper.y() - lower.y()), Millimetres(sheet.thickness)},
                &csv);
    }
  }
  return csv;
}

std::string BillCsv(const FabricationPlan& plan) {
  std::string csv;
  AppendRow({"item", "title", "quantity", "size_to_order", "supplier", "supplier_number",
             "supplier_url", "unit_price", "price", "currency"},
            &csv);
  for (const BillLine& line : plan.bill.lines) {
    AppendRow({line.item, line.title, absl::StrCat(line.quantity), line.dimensions, line.supplier,
               line.supplier_number, line.supplier_url, Amount(line.unit_price, 4),
               Amount(line.price, 2), line.price.currency},
              &csv);
  }
  AppendRow(
      {"total", "", "", "", "", "", "", "", Amount(plan.bill.total, 2), plan.bill.total.currency},
      &csv);
  return csv;
}

}  // namespace mortise::fabplanner
