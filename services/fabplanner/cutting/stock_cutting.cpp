#include "services/fabplanner/cutting/stock_cutting.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "services/fabplanner/cutting/cutting_stock.h"
#include "services/fabplanner/cutting/plank_ripping.h"
#include "services/fabplanner/cutting/sheet_layout.h"
#include "services/fabplanner/plan/dimension_text.h"

namespace mortise::fabplanner {
namespace {

// Parts that come from the same stock: one item, one width and thickness in micrometres (the width
// of a sheet, or of a plank that is ripped, is not fixed by its parts and stays 0).
using StockKey = std::tuple<std::string, int64_t, int64_t>;

// A part that is crosscut, and how its ends are cut.
struct Crosscut {
  const Part* part = nullptr;
  CutEnds ends;
};

constexpr double kMinCost = 1e-4;  // of a piece that costs nothing

int64_t Micrometres(double metres) { return std::llround(metres * 1e6); }

// The sizes an item is sold in, without repetitions: its own if there are no others.
std::vector<StockSize> StockOf(const Item& item) {
  std::vector<StockSize> stock;
  for (const StockSize& size : item.stock) {
    const auto same = [&](const StockSize& other) {
      return Micrometres(other.length) == Micrometres(size.length) &&
             Micrometres(other.width) == Micrometres(size.width);
    };
    if (std::none_of(stock.begin(), stock.end(), same)) stock.push_back(size);
  }
  if (stock.empty()) stock.push_back({item.size.x(), item.size.y(), std::nullopt});
  return stock;
}

// The errors of layouts name the part; people also want to know of what.
absl::Status OfItem(const absl::Status& status, const Item& item) {
  if (status.ok() || status.code() != absl::StatusCode::kFailedPrecondition) return status;
  const ErrorDetail detail = DetailOf(status);
  return PreconditionFailed(detail.reason,
                            absl::StrCat(std::string(status.message()), " (", item.name, ")"),
                            detail.field);
}

// What a piece of a size costs, and whether that is known. A size that the item lists has the price
// it is listed with; that of the item's own dimensions may leave it to the item.
struct PiecePrice {
  std::optional<double> price;  // the item's price says it if there is none
  bool is_known = true;
};

PiecePrice PriceOf(const Item& item, const StockSize& size) {
  if (item.stock.empty() || item.price_per_volume) return {};
  if (size.price) return {size.price, true};
  const bool is_own = Micrometres(size.length) == Micrometres(item.size.x()) &&
                      (size.width == 0 || Micrometres(size.width) == Micrometres(item.size.y()));
  return {std::nullopt, is_own};
}

// What sizes cost, for choosing between them; nothing unless it is known of all.
std::optional<std::vector<double>> CostsOf(const Item& item, const std::vector<StockSize>& sizes) {
  if (item.price_per_volume) return std::nullopt;
  std::vector<double> costs;
  for (const StockSize& size : sizes) {
    const PiecePrice price = PriceOf(item, size);
    if (!price.is_known || item.price.currency.empty()) return std::nullopt;
    // What costs nothing is dearer than nothing, so that no more of it is taken than is needed.
    costs.push_back(std::max(price.price.value_or(item.price.amount), kMinCost));
  }
  return costs;
}

Purchase PurchaseOf(const Item& item, const StockSize& size, const Eigen::Vector3d& pieces,
                    int quantity) {
  const PiecePrice price = PriceOf(item, size);
  return {item.name, pieces, quantity, price.price, !price.is_known};
}

std::string StripsText(double width, int strips) {
  return absl::StrCat(strips, strips == 1 ? " strip " : " strips ", Millimetres(width), " mm wide");
}

// Rips planks into the strips of a plan's boards from `first` on that are of one stock size; says
// so to the plan and the boards, and returns how many planks that takes.
int RipStrips(const Item& item, const std::vector<std::size_t>& boards, FabricationPlan* plan) {
  std::vector<double> widths;
  for (const std::size_t board : boards) widths.push_back(plan->boards[board].width);
  const std::vector<RippedPlank> planks = RipPlanks(widths, item.size.y(), plan->rules.kerf);
  // Planks that are ripped to the same widths are told of together.
  std::map<std::set<double>, std::pair<int, std::map<double, int>>> alike;
  for (const RippedPlank& plank : planks) {
    std::set<double> distinct;
    const std::string label = absl::StrCat("plank-", ++plan->planks);
    for (std::size_t i = 0; i < plank.strips.size(); ++i) {
      BoardLayout& board = plan->boards[boards[static_cast<std::size_t>(plank.strips[i])]];
      board.plank = label;
      board.plank_position = plank.positions[i];
      distinct.insert(board.width);
    }
    auto& [count, strips] = alike[distinct];
    ++count;
    for (const int strip : plank.strips) ++strips[widths[static_cast<std::size_t>(strip)]];
  }
  for (const auto& [distinct, told] : alike) {
    const auto& [count, strips] = told;
    std::vector<std::string> texts;
    for (const auto& [width, number] : strips) texts.push_back(StripsText(width, number));
    plan->handwork.push_back(absl::StrCat("rip ", count, count == 1 ? " board" : " boards", " of ",
                                          item.title.empty() ? item.name : item.title, " to ",
                                          absl::StrJoin(texts, " and "),
                                          ", before they are crosscut"));
  }
  return static_cast<int>(planks.size());
}

// Crosscuts parts of one section from boards, or strips, of all lengths the item is sold in, and
// adds to `of_size` which boards are of which.
absl::Status CrosscutSection(const std::vector<Crosscut>& parts, const Item& item,
                             const std::vector<StockSize>& sizes, FabricationPlan* plan,
                             std::map<int, std::vector<std::size_t>>* of_size) {
  const Eigen::Vector3d& section = parts.front().part->size;
  std::vector<CrosscutPart> crosscuts;
  for (int copy = 1; copy <= plan->quantity; ++copy) {
    for (const auto& [part, ends] : parts) {
      crosscuts.push_back({PartLabel(part->name, copy, plan->quantity), part->size.x(), ends});
    }
  }
  const std::optional<std::vector<double>> costs = CostsOf(item, sizes);
  std::vector<StockLength> lengths;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    lengths.push_back({sizes[i].length, costs ? (*costs)[i] : 0});
  }
  const absl::StatusOr<CuttingStock> cut = CutStock(
      crosscuts, lengths,
      {.kerf = plan->rules.kerf, .trim = plan->rules.board_trim, .section = section.tail<2>()});
  MORTISE_RETURN_IF_ERROR(OfItem(cut.status(), item));
  plan->boards_proven_optimal = plan->boards_proven_optimal && cut->optimal;
  for (const CutBoard& board : cut->boards) {
    (*of_size)[board.stock].push_back(plan->boards.size());
    BoardLayout& layout = plan->boards.emplace_back();
    layout.label = absl::StrCat("board-", plan->boards.size());
    layout.item = item.name;
    layout.width = section.y();
    layout.thickness = section.z();
    layout.stock_length = lengths[board.stock].length;
    layout.offcut = board.offcut;
    for (std::size_t i = 0; i < board.parts.size(); ++i) {
      const CrosscutPart& part = crosscuts[board.parts[i]];
      layout.segments.push_back({part.label, board.starts[i], part.length, board.ends[i]});
    }
  }
  plan->chop_saw_parts += static_cast<int>(crosscuts.size());
  return absl::OkStatus();
}

// Parts of one thickness, and of one width unless planks are ripped to it.
absl::Status CutBoards(const std::vector<Crosscut>& parts, const Item& item, FabricationPlan* plan,
                       std::vector<Purchase>* purchases) {
  std::map<int64_t, std::vector<Crosscut>> by_width;
  for (const Crosscut& crosscut : parts) {
    by_width[Micrometres(crosscut.part->size.y())].push_back(crosscut);
  }
  const std::vector<StockSize> sizes = StockOf(item);
  std::map<int, std::vector<std::size_t>> whole, strips;  // boards of each stock size
  for (const auto& [width, alike] : by_width) {
    const bool is_ripped = item.ripped && width < Micrometres(item.size.y());
    MORTISE_RETURN_IF_ERROR(
        CrosscutSection(alike, item, sizes, plan, is_ripped ? &strips : &whole));
  }
  std::map<int, int> pieces;  // to buy of each stock size
  for (const auto& [stock, boards] : whole) pieces[stock] += static_cast<int>(boards.size());
  for (const auto& [stock, boards] : strips) pieces[stock] += RipStrips(item, boards, plan);
  const Eigen::Vector3d& section = parts.front().part->size;
  const double width = item.ripped ? item.size.y() : section.y();
  for (const auto& [stock, count] : pieces) {
    purchases->push_back(
        PurchaseOf(item, sizes[stock], {sizes[stock].length, width, section.z()}, count));
  }
  return absl::OkStatus();
}

// A layout on sheets of one size.
struct SheetChoice {
  StockSize size;
  std::vector<FilledSheet> sheets;
  double cost = 0;
};

// The layout on sheets of one size that costs least: by price where every size has one, else by
// area.
absl::StatusOr<SheetChoice> CheapestSheets(const std::vector<SheetOutline>& outlines,
                                           const Item& item, const std::vector<StockSize>& sizes,
                                           const SheetLayoutOptions& options) {
  const std::optional<std::vector<double>> costs = CostsOf(item, sizes);
  std::optional<SheetChoice> best;
  absl::Status failure;
  double largest = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    const StockSize& size = sizes[i];
    const double area = size.length * size.width;
    absl::StatusOr<std::vector<FilledSheet>> sheets =
        LayOutSheets(outlines, {size.length, size.width}, options);
    if (!sheets.ok()) {
      // Where there are several sizes, the largest has the message that helps.
      if (area > largest) failure = sheets.status();
      largest = std::max(largest, area);
      continue;
    }
    const double cost = (costs ? (*costs)[i] : area) * static_cast<double>(sheets->size());
    if (!best || cost < best->cost - 1e-9) best = SheetChoice{size, *std::move(sheets), cost};
  }
  if (!best) return failure;
  return *std::move(best);
}

// The sheet as it is, or a smaller one that holds the same outlines.
SheetChoice SmallestFor(const FilledSheet& filled, const StockSize& size,
                        const std::vector<SheetOutline>& outlines, const Item& item,
                        const std::vector<StockSize>& sizes, const SheetLayoutOptions& options) {
  std::vector<SheetOutline> own;
  for (const PlacedOutline& placed : filled.placements) own.push_back(outlines[placed.part]);
  absl::StatusOr<SheetChoice> again = CheapestSheets(own, item, sizes, options);
  if (sizes.size() < 2 || !again.ok() || again->sheets.size() != 1) return {size, {filled}, 0};
  for (PlacedOutline& placed : again->sheets.front().placements) {
    placed.part = filled.placements[placed.part].part;
  }
  return *std::move(again);
}

absl::Status CutSheets(const std::vector<const Part*>& parts, const Item& item,
                       FabricationPlan* plan, std::vector<Purchase>* purchases) {
  std::vector<SheetOutline> outlines;
  for (int copy = 1; copy <= plan->quantity; ++copy) {
    for (const Part* part : parts) {
      outlines.push_back(
          {PartLabel(part->name, copy, plan->quantity), SheetOutlineOf(*part), !item.has_grain});
    }
  }
  const std::vector<StockSize> sizes = StockOf(item);
  const SheetLayoutOptions options = {.trim = plan->rules.sheet_trim,
                                      .spacing = plan->rules.sheet_spacing};
  const absl::StatusOr<SheetChoice> chosen = CheapestSheets(outlines, item, sizes, options);
  MORTISE_RETURN_IF_ERROR(OfItem(chosen.status(), item));
  const double thickness = parts.front()->size.z();
  for (const FilledSheet& filled : chosen->sheets) {
    const SheetChoice sheet = SmallestFor(filled, chosen->size, outlines, item, sizes, options);
    SheetLayout& layout = plan->sheets.emplace_back();
    layout.label = absl::StrCat("sheet-", plan->sheets.size());
    layout.item = item.name;
    layout.length = sheet.size.length;
    layout.width = sheet.size.width;
    layout.thickness = thickness;
    for (const PlacedOutline& placed : sheet.sheets.front().placements) {
      layout.placements.push_back({outlines[placed.part].label, placed.outline});
    }
    purchases->push_back(PurchaseOf(item, sheet.size, {layout.length, layout.width, thickness}, 1));
  }
  plan->jigsaw_parts += static_cast<int>(outlines.size());
  return absl::OkStatus();
}

}  // namespace

std::string PartLabel(const std::string& name, int copy, int quantity) {
  return quantity == 1 ? name : absl::StrCat(name, ".", copy);
}

absl::Status CutParts(const Design& design, const Items& items, FabricationPlan* plan,
                      std::vector<Purchase>* purchases) {
  std::map<StockKey, std::vector<Crosscut>> boards;
  std::map<StockKey, std::vector<const Part*>> sheets;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const Part& part = design.parts[i];
    const Making making = plan->parts[i].making;
    if (making == Making::kCrosscut) {
      const bool is_ripped = items.at(part.item).ripped;
      boards[{part.item, is_ripped ? 0 : Micrometres(part.size.y()), Micrometres(part.size.z())}]
          .push_back({&part, plan->parts[i].ends});
    } else if (making == Making::kOutline) {
      sheets[{part.item, 0, Micrometres(part.size.z())}].push_back(&part);
    }
  }
  for (const auto& [key, parts] : boards) {
    MORTISE_RETURN_IF_ERROR(CutBoards(parts, items.at(std::get<0>(key)), plan, purchases));
  }
  for (const auto& [key, parts] : sheets) {
    MORTISE_RETURN_IF_ERROR(CutSheets(parts, items.at(std::get<0>(key)), plan, purchases));
  }
  return absl::OkStatus();
}

}  // namespace mortise::fabplanner
