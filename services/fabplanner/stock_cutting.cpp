#include "services/fabplanner/stock_cutting.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/cutting_stock.h"
#include "services/fabplanner/dimension_text.h"
#include "services/fabplanner/sheet_layout.h"

namespace mortise::fabplanner {
namespace {

// Parts that come from the same stock: one item, one width and thickness in micrometres (the width
// of a sheet is not fixed by its parts and stays 0).
using StockKey = std::tuple<std::string, int64_t, int64_t>;
using PartsByStock = std::map<StockKey, std::vector<const Part*>>;

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
  if (stock.empty()) stock.push_back({item.size.x(), item.size.y(), 0});
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

// The price of a piece of a size that the item lists; 0 where the item's own holds.
double PiecePrice(const Item& item, const StockSize& size) {
  if (item.stock.empty() || item.price_per_volume) return 0;
  if (size.price > 0) return size.price;
  const double width = size.width > 0 ? size.width / item.size.y() : 1;
  return item.price.amount * width * size.length / item.size.x();
}

// Boards that were ripped into strips: bought whole.
int WholeBoards(const Item& item, double width, int strips, double kerf,
                std::vector<std::string>* handwork) {
  if (!item.ripped || width > item.size.y() - 1e-6) return strips;
  const int each =
      std::max(1, static_cast<int>(std::floor((item.size.y() + kerf) / (width + kerf) + 1e-9)));
  const int whole = (strips + each - 1) / each;
  handwork->push_back(absl::StrCat("rip ", whole, whole == 1 ? " board" : " boards", " of ",
                                   item.title.empty() ? item.name : item.title, " to ", strips,
                                   strips == 1 ? " strip " : " strips ", Millimetres(width),
                                   " mm wide, before they are crosscut"));
  return whole;
}

absl::Status CutBoards(const std::vector<const Part*>& parts, const Item& item,
                       FabricationPlan* plan, std::vector<Purchase>* purchases) {
  const Eigen::Vector3d& section = parts.front()->size;
  std::vector<CrosscutPart> crosscuts;
  for (int copy = 1; copy <= plan->quantity; ++copy) {
    for (const Part* part : parts) {
      crosscuts.push_back({PartLabel(part->name, copy, plan->quantity), part->size.x()});
    }
  }
  const std::vector<StockSize> sizes = StockOf(item);
  const bool priced =
      std::all_of(sizes.begin(), sizes.end(), [](const StockSize& size) { return size.price > 0; });
  std::vector<StockLength> lengths;
  for (const StockSize& size : sizes) lengths.push_back({size.length, priced ? size.price : 0});
  const absl::StatusOr<CuttingStock> cut =
      CutStock(crosscuts, lengths, {.kerf = plan->rules.kerf, .trim = plan->rules.board_trim});
  MORTISE_RETURN_IF_ERROR(OfItem(cut.status(), item));
  plan->boards_proven_optimal = plan->boards_proven_optimal && cut->optimal;
  std::map<int, int> pieces;  // of each stock size
  for (const CutBoard& board : cut->boards) {
    ++pieces[board.stock];
    BoardLayout& layout = plan->boards.emplace_back();
    layout.label = absl::StrCat("board-", plan->boards.size());
    layout.item = item.name;
    layout.width = section.y();
    layout.thickness = section.z();
    layout.stock_length = lengths[board.stock].length;
    layout.offcut = board.offcut;
    for (std::size_t i = 0; i < board.parts.size(); ++i) {
      const CrosscutPart& part = crosscuts[board.parts[i]];
      layout.segments.push_back({part.label, board.starts[i], part.length});
    }
  }
  plan->chop_saw_parts += static_cast<int>(crosscuts.size());
  for (const auto& [stock, count] : pieces) {
    const int whole = WholeBoards(item, section.y(), count, plan->rules.kerf, &plan->handwork);
    const double width = item.ripped ? item.size.y() : section.y();
    purchases->push_back({item.name,
                          {sizes[stock].length, width, section.z()},
                          whole,
                          PiecePrice(item, sizes[stock])});
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
                                           const std::vector<StockSize>& sizes,
                                           const SheetLayoutOptions& options) {
  const bool priced =
      std::all_of(sizes.begin(), sizes.end(), [](const StockSize& size) { return size.price > 0; });
  std::optional<SheetChoice> best;
  absl::Status failure;
  double largest = 0;
  for (const StockSize& size : sizes) {
    const double area = size.length * size.width;
    absl::StatusOr<std::vector<FilledSheet>> sheets =
        LayOutSheets(outlines, {size.length, size.width}, options);
    if (!sheets.ok()) {
      // Of several sizes the largest has the message that helps.
      if (area > largest) failure = sheets.status();
      largest = std::max(largest, area);
      continue;
    }
    const double cost = (priced ? size.price : area) * static_cast<double>(sheets->size());
    if (!best || cost < best->cost - 1e-9) best = SheetChoice{size, *std::move(sheets), cost};
  }
  if (!best) return failure;
  return *std::move(best);
}

// The sheet as it is, or a smaller one that holds the same outlines.
SheetChoice SmallestFor(const FilledSheet& filled, const StockSize& size,
                        const std::vector<SheetOutline>& outlines,
                        const std::vector<StockSize>& sizes, const SheetLayoutOptions& options) {
  std::vector<SheetOutline> own;
  for (const PlacedOutline& placed : filled.placements) own.push_back(outlines[placed.part]);
  absl::StatusOr<SheetChoice> again = CheapestSheets(own, sizes, options);
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
          {PartLabel(part->name, copy, plan->quantity), SheetOutlineOf(*part), false});
    }
  }
  const std::vector<StockSize> sizes = StockOf(item);
  const SheetLayoutOptions options = {.trim = plan->rules.sheet_trim,
                                      .spacing = plan->rules.sheet_spacing};
  const absl::StatusOr<SheetChoice> chosen = CheapestSheets(outlines, sizes, options);
  MORTISE_RETURN_IF_ERROR(OfItem(chosen.status(), item));
  const double thickness = parts.front()->size.z();
  for (const FilledSheet& filled : chosen->sheets) {
    const SheetChoice sheet = SmallestFor(filled, chosen->size, outlines, sizes, options);
    SheetLayout& layout = plan->sheets.emplace_back();
    layout.label = absl::StrCat("sheet-", plan->sheets.size());
    layout.item = item.name;
    layout.length = sheet.size.length;
    layout.width = sheet.size.width;
    layout.thickness = thickness;
    for (const PlacedOutline& placed : sheet.sheets.front().placements) {
      layout.placements.push_back({outlines[placed.part].label, placed.outline});
    }
    purchases->push_back(
        {item.name, {layout.length, layout.width, thickness}, 1, PiecePrice(item, sheet.size)});
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
  PartsByStock boards, sheets;
  for (std::size_t i = 0; i < design.parts.size(); ++i) {
    const Part& part = design.parts[i];
    const Making making = plan->parts[i].making;
    if (making == Making::kCrosscut) {
      boards[{part.item, Micrometres(part.size.y()), Micrometres(part.size.z())}].push_back(&part);
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
