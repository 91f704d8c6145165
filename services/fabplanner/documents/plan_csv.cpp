#include "services/fabplanner/documents/plan_csv.h"

#include <cmath>
#include <map>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "services/fabplanner/documents/csv_row.h"
#include "services/fabplanner/plan/bill_of_materials.h"
#include "services/fabplanner/plan/dimension_text.h"
#include "services/fabplanner/plan/money.h"

namespace mortise::fabplanner {
namespace {

// Of one piece, which may cost less than the smallest amount of money.
std::string PieceAmount(const Money& money) {
  return money.currency.empty() ? "" : absl::StrFormat("%.4f", money.amount);
}

const char* MakingText(Making making) {
  switch (making) {
    case Making::kCrosscut:
      return "crosscut";
    case Making::kOutline:
      return "outline";
    case Making::kBought:
      return "bought";
    case Making::kToDrawing:
      return "to drawing";
  }
  return "";
}

const char* HoleKindText(HoleKind kind) {
  switch (kind) {
    case HoleKind::kPeg:
      return "peg";
    case HoleKind::kPilot:
      return "pilot";
    case HoleKind::kClearance:
      return "clearance";
    case HoleKind::kTapped:
      return "tapped";
  }
  return "";
}

// "towards +x", or the components where it is along no axis; a bare "-x" is a formula to
// spreadsheets.
std::string DirectionText(const Eigen::Vector3d& direction) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(direction[axis]) > 1 - 1e-9) {
      return absl::StrCat("towards ", direction[axis] > 0 ? "+" : "-", std::string(1, "xyz"[axis]));
    }
  }
  return absl::StrFormat("%.4f %.4f %.4f", direction.x(), direction.y(), direction.z());
}

// Degrees to a tenth, with their sign.
std::string Degrees(double angle) {
  return absl::StrCat(std::round(angle * 1800 / M_PI) / 10 + 0.0);
}

}  // namespace

std::string CutListCsv(const FabricationPlan& plan) {
  std::string csv;
  AppendCsvRow(
      {"stock", "item", "process", "part", "start_u_mm", "start_v_mm", "length_mm", "width_mm",
       "thickness_mm", "front_mitre_deg", "front_bevel_deg", "rear_mitre_deg", "rear_bevel_deg"},
      &csv);
  for (const BoardLayout& board : plan.boards) {
    for (const BoardSegment& segment : board.segments) {
      AppendCsvRow(
          {board.label, board.item, "crosscut", segment.part, Millimetres(segment.start), "0",
           Millimetres(segment.length), Millimetres(board.width), Millimetres(board.thickness),
           Degrees(MitreOf(segment.ends.front)), Degrees(BevelOf(segment.ends.front)),
           Degrees(MitreOf(segment.ends.rear)), Degrees(BevelOf(segment.ends.rear))},
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
      AppendCsvRow(
          {sheet.label, sheet.item, "outline", placement.part, Millimetres(lower.x()),
           Millimetres(lower.y()), Millimetres(upper.x() - lower.x()),
           Millimetres(upper.y() - lower.y()), Millimetres(sheet.thickness), "", "", "", ""},
          &csv);
    }
  }
  return csv;
}

std::string BillCsv(const FabricationPlan& plan) {
  std::string csv;
  AppendCsvRow(
      {"item", "title", "quantity", "size_to_order", "supplier", "supplier_number", "supplier_url",
       "unit_price", "price", "currency", "material", "mass_kg", "drawings"},
      &csv);
  for (const BillLine& line : plan.bill.lines) {
    AppendCsvRow({line.item, line.title, absl::StrCat(line.quantity), line.dimensions,
                  line.supplier, line.supplier_number, line.supplier_url,
                  PieceAmount(line.unit_price), AmountText(line.price), line.price.currency,
                  line.material, line.mass > 0 ? absl::StrFormat("%.3f", line.mass) : "",
                  absl::StrJoin(line.drawings, " ")},
                 &csv);
  }
  const int unpriced = UnpricedLines(plan.bill);
  const std::string remark = unpriced == 0
                                 ? ""
                                 : absl::StrCat("incomplete: no price is known of ", unpriced,
                                                unpriced == 1 ? " line" : " lines");
  for (const Money& total : plan.bill.totals) {
    AppendCsvRow(
        {"total", remark, "", "", "", "", "", "", AmountText(total), total.currency, "", "", ""},
        &csv);
  }
  return csv;
}

std::string PartsCsv(const FabricationPlan& plan, const Design& design) {
  std::string csv;
  AppendCsvRow({"part", "title", "made_by", "item", "length_mm", "width_mm", "thickness_mm",
                "mass_kg", "handwork", "drawings", "ends"},
               &csv);
  for (std::size_t i = 0; i < plan.parts.size(); ++i) {
    const PlannedPart& planned = plan.parts[i];
    const Part& part = design.parts[i];
    AppendCsvRow({planned.part, part.title, MakingText(planned.making), part.item,
                  Millimetres(planned.size.x()), Millimetres(planned.size.y()),
                  Millimetres(planned.size.z()), absl::StrFormat("%.3f", part.mass),
                  planned.handwork, absl::StrJoin(planned.drawings, " "), EndsText(planned.ends)},
                 &csv);
  }
  return csv;
}

std::string HolesCsv(const FabricationPlan& plan, const Design& design) {
  std::map<std::string, Eigen::Vector3d> corners;
  for (const Part& part : design.parts) corners[part.name] = BoundsOf(part).min();
  std::string csv;
  AppendCsvRow({"part", "kind", "diameter_mm", "depth_mm", "through", "x_mm", "y_mm", "z_mm",
                "direction", "connector"},
               &csv);
  for (const Hole& hole : plan.holes) {
    const auto corner = corners.find(hole.part);
    const Eigen::Vector3d place =
        corner == corners.end() ? hole.position : hole.position - corner->second;
    AppendCsvRow(
        {hole.part, HoleKindText(hole.kind), Millimetres(hole.diameter), Millimetres(hole.depth),
         hole.through ? "yes" : "no", Millimetres(place.x()), Millimetres(place.y()),
         Millimetres(place.z()), DirectionText(hole.direction), hole.connector},
        &csv);
  }
  return csv;
}

}  // namespace mortise::fabplanner
