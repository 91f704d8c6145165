#include "services/fabplanner/planning/planning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "services/fabplanner/cutting/stock_cutting.h"
#include "services/fabplanner/documents/part_drawing.h"
#include "services/fabplanner/joining/assembly_sequence.h"
#include "services/fabplanner/joining/fastener_holes.h"
#include "services/fabplanner/joining/joinery.h"
#include "services/fabplanner/plan/bill_of_materials.h"
#include "services/fabplanner/plan/dimension_text.h"
#include "services/fabplanner/planning/part_making.h"

namespace mortise::fabplanner {
namespace {

constexpr double kMaxRule = 1.0;   // m
constexpr double kMaxAngle = 1.5;  // rad; saws end far below, and tangents stay small

// The lines of what is made to drawing: alike parts are one.
void AddLinesToDrawing(const Design& design, FabricationPlan* plan) {
  using Key = std::tuple<std::string, std::string, std::array<int64_t, 3>>;
  std::map<Key, std::size_t> lines;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    if (plan->parts[i].making != Making::kToDrawing) continue;
    const Part& part = design.parts[i];
    const Eigen::Vector3d& size = plan->parts[i].size;
    const auto micrometres = [&](int axis) -> int64_t { return std::llround(size[axis] * 1e6); };
    const std::string family = part.family.empty() ? part.name : part.family;
    const auto [entry, is_new] =
        lines.emplace(Key{family, part.material, {micrometres(0), micrometres(1), micrometres(2)}},
                      plan->bill.lines.size());
    if (is_new) {
      BillLine& line = plan->bill.lines.emplace_back();
      line.title = absl::StrCat(TitleOf(part), ", made to drawing");
      line.size = size;
      line.dimensions = SizeText(size);
      line.material = part.material;
      line.mass = part.mass;
    }
    BillLine& line = plan->bill.lines[entry->second];
    line.quantity += plan->quantity;
    line.parts.push_back(part.name);
    for (const std::string& drawing : plan->parts[i].drawings) {
      if (std::find(line.drawings.begin(), line.drawings.end(), drawing) == line.drawings.end()) {
        line.drawings.push_back(drawing);
      }
    }
  }
}

// What the plan asks of people besides putting it together.
void AddHandwork(FabricationPlan* plan) {
  for (const PlannedPart& part : plan->parts) {
    if (!part.handwork.empty()) {
      plan->handwork.push_back(absl::StrCat(part.part, ": ", part.handwork));
    }
  }
  std::vector<std::string> sloped;
  for (const BoardLayout& board : plan->boards) {
    if (HasSlopedEnds(board)) sloped.push_back(board.label);
  }
  if (!sloped.empty()) {
    plan->handwork.push_back(absl::StrCat(
        "crosscut ", absl::StrJoin(sloped, ", "),
        " at a saw that turns and tilts: the machines of work orders cut square; boards.svg and "
        "cut-list.csv have the angles"));
  }
  std::map<HoleKind, int> holes;
  for (const Hole& hole : plan->holes) ++holes[hole.kind];
  const auto drill = [&](HoleKind kind, const char* what) {
    if (holes[kind] > 0) {
      plan->handwork.push_back(absl::StrCat("drill ", holes[kind] * plan->quantity, " holes ", what,
                                            ": holes.csv says where"));
    }
  };
  drill(HoleKind::kPeg, "for pegs and pins");
  drill(HoleKind::kPilot, "for screws to cut their thread in");
  drill(HoleKind::kClearance, "that screws and bolts pass through");
  drill(HoleKind::kTapped, "and cut threads in them");
}

}  // namespace

absl::Status CheckRules(const WorkshopRules& rules) {
  std::vector<FieldViolation> violations;
  const auto check = [&](const char* field, double value) {
    const bool usable = std::isfinite(value) && value >= 0 && value <= kMaxRule;
    if (!usable) violations.push_back({field, "must be a length of 0 to 1 m"});
    return usable;
  };
  const bool has_kerf = check("rules.kerf", rules.kerf);
  // What is no length is not compared with the kerf too.
  if (check("rules.board_trim", rules.board_trim) && has_kerf && rules.board_trim > 0 &&
      rules.board_trim < rules.kerf) {
    violations.push_back(
        {"rules.board_trim", "must be at least the kerf: the blade takes that much"});
  }
  check("rules.sheet_trim", rules.sheet_trim);
  if (check("rules.sheet_spacing", rules.sheet_spacing) && has_kerf &&
      rules.sheet_spacing < rules.kerf) {
    violations.push_back(
        {"rules.sheet_spacing", "must be at least the kerf, or neighbouring cuts meet"});
  }
  check("rules.jigsaw_radius", rules.jigsaw_radius);
  const auto check_angle = [&](const char* field, double value) {
    const bool usable = std::isfinite(value) && value >= 0 && value <= kMaxAngle;
    if (!usable) violations.push_back({field, "must be an angle of 0 to 1.5 rad"});
  };
  check_angle("rules.mitre_limit", rules.mitre_limit);
  check_angle("rules.bevel_limit", rules.bevel_limit);
  return violations.empty() ? absl::OkStatus() : InvalidFields(violations);
}

absl::StatusOr<FabricationPlan> MakePlan(const Design& design, const Items& items, int quantity,
                                         const WorkshopRules& rules, const std::stop_token& stop) {
  MORTISE_RETURN_IF_ERROR(CheckRules(rules));
  if (quantity < 1 || quantity > 1000) return InvalidField("quantity", "must be 1 to 1000");
  if (static_cast<int64_t>(design.parts.size()) * quantity > kMaxParts) {
    return TooLarge(absl::StrCat(design.parts.size(), " parts times ", quantity),
                    absl::StrCat(kMaxParts, " parts in a plan"));
  }
  FabricationPlan plan;
  plan.quantity = quantity;
  plan.rules = rules;
  MORTISE_ASSIGN_OR_RETURN(plan.parts, PlanParts(design, items, rules));
  NameDrawings(design, &plan);
  std::vector<Purchase> purchases;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    if (plan.parts[i].making != Making::kBought) continue;
    purchases.push_back({design.parts[i].item, design.parts[i].size, quantity});
  }
  MORTISE_RETURN_IF_ERROR(CutParts(design, items, &plan, &purchases));
  MORTISE_ASSIGN_OR_RETURN(plan.holes, HolesFor(design));
  AddFastenerHoles(design, items, &plan);
  MORTISE_ASSIGN_OR_RETURN(plan.steps, AssemblySteps(design, items, plan.marks, stop));
  for (const auto& [item, count] : CountPegs(design)) {
    if (!items.contains(item)) return InvalidField("connectors", absl::StrCat("no item ", item));
    purchases.push_back({item, items.at(item).size, count * quantity});
    plan.pegs += count * quantity;
  }
  for (const AssemblyStep& step : plan.steps) {
    if (design.pegs.empty()) plan.pegs += step.pegs * quantity;
  }
  MORTISE_ASSIGN_OR_RETURN(plan.bill, MakeBill(purchases, items));
  AddLinesToDrawing(design, &plan);
  AddHandwork(&plan);
  return plan;
}

}  // namespace mortise::fabplanner
