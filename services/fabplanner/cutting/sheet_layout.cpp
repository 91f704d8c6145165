#include "services/fabplanner/cutting/sheet_layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/compared_numbers.h"
#include "common/base/errors.h"
#include "services/fabplanner/cutting/rectangle_packing.h"

namespace mortise::fabplanner {
namespace {

constexpr double kTolerance = 1e-9;          // m
constexpr double kMaxLength = 1e3;           // m
constexpr std::size_t kManyOutlines = 2000;  // past this, one order and one measure suffice

struct Bounds {
  Eigen::Vector2d lower, upper;
  Eigen::Vector2d Size() const { return upper - lower; }
};

Bounds BoundsOf(const std::vector<Eigen::Vector2d>& outline) {
  Bounds bounds{outline.front(), outline.front()};
  for (const Eigen::Vector2d& point : outline) {
    bounds.lower = bounds.lower.cwiseMin(point);
    bounds.upper = bounds.upper.cwiseMax(point);
  }
  return bounds;
}

bool IsLength(double value) { return std::isfinite(value) && value >= 0 && value <= kMaxLength; }

absl::Status CheckOutline(const SheetOutline& outline, const Eigen::Vector2d& usable,
                          const SheetStock& stock, std::size_t index) {
  const std::string field = absl::StrCat("outlines[", index, "]");
  if (outline.outline.size() < 3) return InvalidField(field, "needs at least 3 points");
  for (const Eigen::Vector2d& point : outline.outline) {
    if (!point.allFinite()) return InvalidField(field, "has a coordinate that is not finite");
  }
  const Eigen::Vector2d size = BoundsOf(outline.outline).Size();
  if (size.minCoeff() <= 0) return InvalidField(field, "has no area");
  const auto fits = [&](double length, double width) {
    return length <= usable.x() + kTolerance && width <= usable.y() + kTolerance;
  };
  if (fits(size.x(), size.y()) || (outline.may_turn && fits(size.y(), size.x()))) {
    return absl::OkStatus();
  }
  const std::vector<std::string> lengths =
      ComparedMillimetres({size.x(), size.y(), stock.length, stock.width, usable.x(), usable.y()});
  return PreconditionFailed(
      "PART_TOO_LARGE",
      absl::StrCat(
          "part ", outline.label, " is ", lengths[0], " × ", lengths[1], " mm, but the sheet is ",
          lengths[2], " × ", lengths[3], " mm, of which ", lengths[4], " × ", lengths[5],
          " mm remain after trimming",
          outline.may_turn ? "" : " (it may not be turned: the grain runs along its length)"),
      outline.label);
}

// The far end of what a bin holds: the rest of the sheet stays in one piece.
double UsedLength(const std::vector<PlacedRectangle>& bin,
                  const std::vector<RectangleSize>& sizes) {
  double used = 0;
  for (const PlacedRectangle& placed : bin) {
    const RectangleSize& size = sizes[placed.index];
    used = std::max(used, placed.x + (placed.turned ? size.height : size.width));
  }
  return used;
}

// What the rectangles are without turning any; nothing if one must be turned, or none may.
std::vector<RectangleSize> Unturned(const std::vector<RectangleSize>& sizes,
                                    const Eigen::Vector2d& bin_size) {
  std::vector<RectangleSize> unturned = sizes;
  bool may_turn = false;
  for (RectangleSize& size : unturned) {
    const bool fits = size.width <= bin_size.x() + kTolerance &&  //
                      size.height <= bin_size.y() + kTolerance;
    if (!fits) return {};
    may_turn = may_turn || std::exchange(size.may_turn, false);
  }
  return may_turn ? unturned : std::vector<RectangleSize>();
}

// Where rectangles may be turned the heuristic, which sees one at a time, may do worse for it: all
// is tried without turning as well.
PackedRectangles BestPacking(const std::vector<RectangleSize>& sizes,
                             const Eigen::Vector2d& bin_size) {
  std::vector<PackingOrder> orders = {PackingOrder::kArea};
  std::vector<FitMeasure> measures = {FitMeasure::kBottomLeft};
  if (sizes.size() <= kManyOutlines) {
    orders = {PackingOrder::kArea, PackingOrder::kLongSide, PackingOrder::kWidth,
              PackingOrder::kHeight};
    measures = {FitMeasure::kBottomLeft, FitMeasure::kShortSide, FitMeasure::kArea};
  }
  PackedRectangles best;
  std::pair<std::size_t, double> best_score{std::numeric_limits<std::size_t>::max(), 0};
  const std::vector<RectangleSize> unturned = Unturned(sizes, bin_size);
  for (const std::vector<RectangleSize>* const tried : {&sizes, &unturned}) {
    if (tried->empty()) continue;
    for (std::size_t k = 0; k < orders.size() * measures.size(); ++k) {
      PackedRectangles bins =
          PackRectangles(*tried, bin_size.x(), bin_size.y(), orders[k / measures.size()],
                         measures[k % measures.size()]);
      const std::pair<std::size_t, double> score{bins.size(), UsedLength(bins.back(), sizes)};
      if (score < best_score) {
        best_score = score;
        best = std::move(bins);
      }
    }
  }
  return best;
}

PlacedOutline PlaceOutline(const SheetOutline& outline, const PlacedRectangle& placed,
                           double trim) {
  PlacedOutline result;
  result.part = placed.index;
  result.turned = placed.turned;
  const Bounds bounds = BoundsOf(outline.outline);
  for (const Eigen::Vector2d& point : outline.outline) {
    Eigen::Vector2d local = point - bounds.lower;
    if (placed.turned) local = {bounds.Size().y() - local.y(), local.x()};
    result.outline.push_back(local + Eigen::Vector2d(placed.x + trim, placed.y + trim));
  }
  return result;
}

}  // namespace

absl::StatusOr<std::vector<FilledSheet>> LayOutSheets(const std::vector<SheetOutline>& outlines,
                                                      const SheetStock& stock,
                                                      const SheetLayoutOptions& options) {
  if (!IsLength(options.trim)) return InvalidField("trim", "must be a length of 0 to 1000 m");
  if (!IsLength(options.spacing)) return InvalidField("spacing", "must be a length of 0 to 1000 m");
  if (!IsLength(stock.length) || !IsLength(stock.width)) {
    return InvalidField("stock", "must have a length and a width of 0 to 1000 m");
  }
  if (outlines.empty()) return std::vector<FilledSheet>();
  const Eigen::Vector2d usable(std::max(0.0, stock.length - 2 * options.trim),
                               std::max(0.0, stock.width - 2 * options.trim));
  std::vector<RectangleSize> sizes;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    MORTISE_RETURN_IF_ERROR(CheckOutline(outlines[i], usable, stock, i));
    const Eigen::Vector2d size = BoundsOf(outlines[i].outline).Size();
    sizes.push_back({size.x() + options.spacing, size.y() + options.spacing, outlines[i].may_turn});
  }

  std::vector<FilledSheet> sheets;
  for (std::vector<PlacedRectangle>& bin :
       BestPacking(sizes, usable + Eigen::Vector2d::Constant(options.spacing))) {
    std::sort(bin.begin(), bin.end(), [](const PlacedRectangle& a, const PlacedRectangle& b) {
      return std::make_pair(a.x, a.y) < std::make_pair(b.x, b.y);
    });
    FilledSheet& sheet = sheets.emplace_back();
    for (const PlacedRectangle& placed : bin) {
      sheet.placements.push_back(PlaceOutline(outlines[placed.index], placed, options.trim));
    }
  }
  return sheets;
}

}  // namespace mortise::fabplanner
