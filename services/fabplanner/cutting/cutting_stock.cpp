#include "services/fabplanner/cutting/cutting_stock.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"
#include "services/fabplanner/cutting/bin_packing.h"
#include "services/fabplanner/cutting/board_chain.h"
#include "services/fabplanner/cutting/sloped_packing.h"

namespace mortise::fabplanner {
namespace {

constexpr double kUnitsPerMetre = 1e9;  // rounding stays below what matters for many parts
constexpr double kUnitsPerCost = 1e4;
constexpr double kMaxLength = 1e3;  // m; longer stock is a slip of the keyboard

int64_t ToUnits(double metres) { return std::llround(metres * kUnitsPerMetre); }

bool IsLength(double value) { return std::isfinite(value) && value >= 0 && value <= kMaxLength; }

absl::Status CheckInput(const std::vector<CrosscutPart>& parts,
                        const std::vector<StockLength>& stock, const CuttingStockOptions& options) {
  if (!IsLength(options.kerf)) return InvalidField("kerf", "must be a length of 0 to 1000 m");
  if (!IsLength(options.trim)) return InvalidField("trim", "must be a length of 0 to 1000 m");
  if (stock.empty()) return InvalidField("stock", "at least one stock length is needed");
  const bool priced = stock.front().cost > 0;
  for (std::size_t i = 0; i < stock.size(); ++i) {
    if (!IsLength(stock[i].length) || stock[i].length == 0) {
      return InvalidField(absl::StrCat("stock[", i, "].length"), "must be over 0 and up to 1000 m");
    }
    if (!std::isfinite(stock[i].cost) || stock[i].cost < 0 || stock[i].cost > 1e9 ||
        (stock[i].cost > 0) != priced) {
      return InvalidField(absl::StrCat("stock[", i, "].cost"),
                          "must be positive for every stock length, or 0 for every one");
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!IsLength(parts[i].length) || ToUnits(parts[i].length) < 1) {
      return InvalidField(absl::StrCat("parts[", i, "].length"), "must be over 0 and up to 1000 m");
    }
  }
  return absl::OkStatus();
}

absl::Status TooLong(const CrosscutPart& part, double longest, const CuttingStockOptions& options) {
  const double usable = std::max(0.0, longest - 2 * options.trim);
  const std::vector<std::string> lengths =
      ComparedMillimetres({part.length, longest, usable, options.trim});
  return PreconditionFailed(
      "PART_TOO_LONG",
      absl::StrCat("part ", part.label, " is ", lengths[0], " mm long, but the longest stock is ",
                   lengths[1], " mm, of which ", lengths[2], " mm remain after trimming ",
                   lengths[3], " mm off each end"),
      part.label);
}

// Whether any end is not square.
bool AnySloped(const std::vector<CrosscutPart>& parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [](const CrosscutPart& part) { return !AreSquare(part.ends); });
}

// Slopes only make sense on a section, and where the two ends do not cross within the part. Along
// the middle line they are its length apart but for what each reaches over it; towards a corner
// they come nearer by the difference of their slopes there.
absl::Status CheckSlopes(const std::vector<CrosscutPart>& parts, const Eigen::Vector2d& section) {
  constexpr double kSlack = 4 * kEndTolerance;  // what two ends may miss their planes by
  if (!section.allFinite() || section.minCoeff() <= 0 || section.maxCoeff() > kMaxLength) {
    return InvalidField("section", "must be over 0 and up to 1000 m, as there are sloped ends");
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const auto& [front, rear] = parts[i].ends;
    const EndSlope difference{front.across - rear.across, front.through - rear.through};
    const double needed =
        ReachOf(front, section) + ReachOf(rear, section) + ReachOf(difference, section);
    if (std::isfinite(needed) && needed <= parts[i].length + kSlack) continue;
    return InvalidField(absl::StrCat("parts[", i, "].ends"),
                        "are steeper than the part's length allows: they cross within it");
  }
  return absl::OkStatus();
}

CuttingStock CutSloped(const std::vector<CrosscutPart>& parts,
                       const std::vector<StockLength>& stock, std::vector<BinType> types,
                       double cost_unit, const CuttingStockOptions& options) {
  const int64_t kerf = ToUnits(options.kerf);
  for (BinType& type : types) type.capacity = std::max<int64_t>(type.capacity - kerf, 1);
  std::vector<SlopedPart> sloped;
  for (const CrosscutPart& part : parts) sloped.push_back({ToUnits(part.length), part.ends});
  const SlopedPacking packing =
      PackSlopedParts(sloped, types, options.section, options.kerf, options.search_steps);
  CuttingStock result;
  result.cost = static_cast<double>(packing.cost) / cost_unit;
  result.lower_bound = static_cast<double>(packing.lower_bound) / cost_unit;
  result.optimal = packing.optimal;
  for (const SlopedBoard& chained : packing.boards) {
    CutBoard& board = result.boards.emplace_back();
    board.stock = chained.type;
    for (const SlopedPlacement& placement : chained.placements) {
      const CrosscutPart& part = parts[static_cast<std::size_t>(placement.part)];
      board.parts.push_back(placement.part);
      board.starts.push_back(options.trim + static_cast<double>(placement.start) / kUnitsPerMetre);
      board.ends.push_back(Laid(part.ends, placement.way));
    }
    const double used = options.trim + static_cast<double>(chained.taken) / kUnitsPerMetre +
                        KerfAlong(board.ends.back().rear, options.kerf);
    board.offcut = std::max(0.0, stock[static_cast<std::size_t>(chained.type)].length - used);
  }
  return result;
}

CutBoard PlaceParts(const std::vector<CrosscutPart>& parts, const PackedBin& bin,
                    double stock_length, const CuttingStockOptions& options) {
  CutBoard board;
  board.stock = bin.type;
  board.parts = bin.items;
  board.ends.resize(bin.items.size());
  double position = options.trim;
  for (int part : bin.items) {
    board.starts.push_back(position);
    position += parts[part].length + options.kerf;
  }
  // Where the last cut meets the end of the board, the blade takes what little is left.
  board.offcut = std::max(0.0, stock_length - position);
  return board;
}

}  // namespace

absl::StatusOr<CuttingStock> CutStock(const std::vector<CrosscutPart>& parts,
                                      const std::vector<StockLength>& stock,
                                      const CuttingStockOptions& options) {
  MORTISE_RETURN_IF_ERROR(CheckInput(parts, stock, options));
  const bool priced = stock.front().cost > 0;
  const int64_t kerf = ToUnits(options.kerf);
  std::vector<BinType> types;
  int64_t largest = 0;
  double longest = 0;
  for (const StockLength& length : stock) {
    const int64_t capacity = ToUnits(length.length) - 2 * ToUnits(options.trim) + kerf;
    const int64_t cost = priced ? std::max<int64_t>(1, std::llround(length.cost * kUnitsPerCost))
                                : ToUnits(length.length);
    types.push_back({std::max<int64_t>(capacity, 1), cost});
    largest = std::max(largest, capacity);
    longest = std::max(longest, length.length);
  }
  std::vector<int64_t> sizes;
  for (const CrosscutPart& part : parts) {
    sizes.push_back(ToUnits(part.length) + kerf);
    if (sizes.back() > largest) return TooLong(part, longest, options);
  }

  const double cost_unit = priced ? kUnitsPerCost : kUnitsPerMetre;
  if (AnySloped(parts)) {
    MORTISE_RETURN_IF_ERROR(CheckSlopes(parts, options.section));
    return CutSloped(parts, stock, std::move(types), cost_unit, options);
  }
  const Packing packing = PackBins(sizes, types, options.search_steps);
  CuttingStock result;
  result.cost = static_cast<double>(packing.cost) / cost_unit;
  result.lower_bound = static_cast<double>(packing.lower_bound) / cost_unit;
  result.optimal = packing.optimal;
  for (const PackedBin& bin : packing.bins) {
    result.boards.push_back(PlaceParts(parts, bin, stock[bin.type].length, options));
  }
  return result;
}

}  // namespace mortise::fabplanner
