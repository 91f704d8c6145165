#include "services/fabplanner/cutting/cutting_stock.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"
#include "services/fabplanner/cutting/bin_packing.h"

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

CutBoard PlaceParts(const std::vector<CrosscutPart>& parts, const PackedBin& bin,
                    double stock_length, const CuttingStockOptions& options) {
  CutBoard board;
  board.stock = bin.type;
  board.parts = bin.items;
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
