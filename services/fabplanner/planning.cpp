#include "services/fabplanner/planning.h"

#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/assembly_sequence.h"
#include "services/fabplanner/bill_of_materials.h"
#include "services/fabplanner/cutting_stock.h"
#include "services/fabplanner/joinery.h"
#include "services/fabplanner/sheet_layout.h"

namespace mortise::fabplanner {
namespace {

constexpr double kLargestRule = 1.0;  // m

// Parts that come from the same stock: one item, one width and thickness in micrometres (the width
// of a sheet is not fixed by its parts and stays 0).
using StockKey = std::tuple<std::string, int64_t, int64_t>;
using PartsByStock = std::map<StockKey, std::vector<const Part*>>;

int64_t Micrometres(double metres) { return std::llround(metres * 1e6); }

absl::Status CheckParts(const Design& design, const Items& items) {
  if (design.parts.empty()) return InvalidField("parts", "the design has no parts");
  for (const Part& part : design.parts) {
    if (!items.contains(part.item)) {
      return InvalidField(absl::StrCat("part ", part.name), absl::StrCat("no item ", part.item));
    }
    bool finite = part.size.allFinite() && std::isfinite(part.from) && std::isfinite(part.to);
    for (const Eigen::Vector2d& point : part.outline) finite = finite && point.allFinite();
    if (!finite || part.size.minCoeff() <= 0 || part.outline.size() < 3 || part.to <= part.from) {
      return InvalidField(absl::StrCat("part ", part.name), "has no usable size and outline");
    }
  }
  return absl::OkStatus();
}

absl::Status PlanBoards(const PartsByStock& stock, const Items& items, FabricationPlan* plan,
                        std::vector<Purchase>* purchases) {
  for (const auto& [key, parts] : stock) {
    const Item& item = items.at(std::get<0>(key));
    const Eigen::Vector3d size(item.size.x(), parts.front()->size.y(), parts.front()->size.z());
    std::vector<CrosscutPart> crosscuts;
    for (int copy = 1; copy <= plan->quantity; ++copy) {
      for (const Part* part : parts) {
        crosscuts.push_back({PartLabel(part->name, copy, plan->quantity), part->size.x()});
      }
    }
    MORTISE_ASSIGN_OR_RETURN(const CuttingStock cut,
                             CutStock(crosscuts, {{item.size.x()}},
                                      {.kerf = plan->rules.kerf, .trim = plan->rules.board_trim}));
    plan->boards_proven_optimal = plan->boards_proven_optimal && cut.optimal;
    for (const CutBoard& board : cut.boards) {
      BoardLayout& layout = plan->boards.emplace_back();
      layout.label = absl::StrCat("board-", plan->boards.size());
      layout.item = item.name;
      layout.width = size.y();
      layout.thickness = size.z();
      layout.stock_length = size.x();
      layout.offcut = board.offcut;
      for (std::size_t i = 0; i < board.parts.size(); ++i) {
        const CrosscutPart& part = crosscuts[board.parts[i]];
        layout.segments.push_back({part.label, board.starts[i], part.length});
      }
    }
    plan->chop_saw_parts += static_cast<int>(crosscuts.size());
    purchases->push_back({item.name, size, static_cast<int>(cut.boards.size())});
  }
  return absl::OkStatus();
}

absl::Status PlanSheets(const PartsByStock& stock, const Items& items, FabricationPlan* plan,
                        std::vector<Purchase>* purchases) {
  for (const auto& [key, parts] : stock) {
    const Item& item = items.at(std::get<0>(key));
    const Eigen::Vector3d size(item.size.x(), item.size.y(), parts.front()->size.z());
    std::vector<SheetOutline> outlines;
    for (int copy = 1; copy <= plan->quantity; ++copy) {
      for (const Part* part : parts) {
        outlines.push_back(
            {PartLabel(part->name, copy, plan->quantity), SheetOutlineOf(*part), false});
      }
    }
    MORTISE_ASSIGN_OR_RETURN(
        const std::vector<FilledSheet> sheets,
        LayOutSheets(outlines, {size.x(), size.y()},
                     {.trim = plan->rules.sheet_trim, .spacing = plan->rules.sheet_spacing}));
    for (const FilledSheet& sheet : sheets) {
      SheetLayout& layout = plan->sheets.emplace_back();
      layout.label = absl::StrCat("sheet-", plan->sheets.size());
      layout.item = item.name;
      layout.length = size.x();
      layout.width = size.y();
      layout.thickness = size.z();
      for (const PlacedOutline& placed : sheet.placements) {
        layout.placements.push_back({outlines[placed.part].label, placed.outline});
      }
    }
    plan->jigsaw_parts += static_cast<int>(outlines.size());
    purchases->push_back({item.name, size, static_cast<int>(sheets.size())});
  }
  return absl::OkStatus();
}

}  // namespace

std::string PartLabel(const std::string& name, int copy, int quantity) {
  return quantity == 1 ? name : absl::StrCat(name, ".", copy);
}

absl::Status CheckRules(const WorkshopRules& rules) {
  const auto check = [](const char* field, double value) {
    if (std::isfinite(value) && value >= 0 && value <= kLargestRule) return absl::OkStatus();
    return InvalidField(field, "must be a length of 0 to 1 m");
  };
  MORTISE_RETURN_IF_ERROR(check("rules.kerf", rules.kerf));
  MORTISE_RETURN_IF_ERROR(check("rules.board_trim", rules.board_trim));
  MORTISE_RETURN_IF_ERROR(check("rules.sheet_trim", rules.sheet_trim));
  MORTISE_RETURN_IF_ERROR(check("rules.sheet_spacing", rules.sheet_spacing));
  if (rules.board_trim > 0 && rules.board_trim < rules.kerf) {
    return InvalidField("rules.board_trim", "must be at least the kerf: the blade takes that much");
  }
  if (rules.sheet_spacing < rules.kerf) {
    return InvalidField("rules.sheet_spacing",
                        "must be at least the kerf, or neighbouring cuts meet");
  }
  return absl::OkStatus();
}

absl::StatusOr<FabricationPlan> MakePlan(const Design& design, const Items& items, int quantity,
                                         const WorkshopRules& rules) {
  MORTISE_RETURN_IF_ERROR(CheckRules(rules));
  if (quantity < 1 || quantity > 1000) return InvalidField("quantity", "must be 1 to 1000");
  if (static_cast<int64_t>(design.parts.size()) * quantity > kMostParts) {
    return TooLarge(absl::StrCat(design.parts.size(), " parts times ", quantity),
                    absl::StrCat(kMostParts, " parts in a plan"));
  }
  MORTISE_RETURN_IF_ERROR(CheckParts(design, items));

  FabricationPlan plan;
  plan.quantity = quantity;
  plan.rules = rules;
  std::vector<Purchase> purchases;
  PartsByStock boards, sheets;
  for (const Part& part : design.parts) {
    switch (part.process) {
      case CutProcess::kChopSaw:
        boards[{part.item, Micrometres(part.size.y()), Micrometres(part.size.z())}].push_back(
            &part);
        break;
      case CutProcess::kJigsaw:
        sheets[{part.item, 0, Micrometres(part.size.z())}].push_back(&part);
        break;
      case CutProcess::kNone:
        purchases.push_back({part.item, part.size, quantity});
        break;
    }
  }
  MORTISE_RETURN_IF_ERROR(PlanBoards(boards, items, &plan, &purchases));
  MORTISE_RETURN_IF_ERROR(PlanSheets(sheets, items, &plan, &purchases));
  MORTISE_ASSIGN_OR_RETURN(plan.holes, HolesFor(design));
  MORTISE_ASSIGN_OR_RETURN(plan.steps, AssemblySteps(design, items));
  for (const auto& [item, count] : CountPegs(design)) {
    if (!items.contains(item)) return InvalidField("connectors", absl::StrCat("no item ", item));
    purchases.push_back({item, items.at(item).size, count * quantity});
    plan.pegs += count * quantity;
  }
  MORTISE_ASSIGN_OR_RETURN(plan.bill, MakeBill(purchases, items));
  return plan;
}

}  // namespace mortise::fabplanner
