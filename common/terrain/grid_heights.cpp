// Heights on a grid: bilinear in each cell.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/terrain/height_field.h"
#include "common/terrain/place_faults.h"

namespace mortise::terrain {
namespace {

constexpr double kLeastSpacing = 1e-6;        // m
constexpr std::size_t kMostHeightsTold = 20;  // that are no heights

// A side of what is cut from a cell, and which of a rectangle's four numbers it is; none of a side
// of the cell.
struct Side {
  double at = 0;  // m
  int number = -1;
};

// The cells that an interval along an axis lies in.
struct CellRange {
  int first = 0;
  int last = 0;
  bool any = false;  // whether it is a point on the border of them, so that any of them will do

  int count() const { return any ? 1 : last - first + 1; }
  std::pair<int, int> Alternatives(int index) const {
    return any ? std::pair(first, last) : std::pair(first + index, first + index);
  }
};

class GridHeights final : public HeightField {
 public:
  explicit GridHeights(HeightGrid grid) : grid_(std::move(grid)) {}

  absl::StatusOr<PlaceValue> HeightAt(double x, double y) const override {
    MORTISE_ASSIGN_OR_RETURN(const Cell cell, CellAt(x, y));
    return HeightIn(cell, x, y);
  }

  absl::StatusOr<PlaceValue> SlopeAt(double x, double y) const override {
    MORTISE_ASSIGN_OR_RETURN(const Cell cell, CellAt(x, y));
    const PlaceValue height = HeightIn(cell, x, y);
    const double slope = height.gradient.norm();
    if (slope == 0) return PlaceValue{};
    // Along x the rise along y changes by the twist of the cell, and the reverse.
    const double twist =
        (Corner(cell, 0, 0) + Corner(cell, 1, 1) - Corner(cell, 1, 0) - Corner(cell, 0, 1)) /
        (grid_.spacing.x() * grid_.spacing.y());
    return PlaceValue{slope, height.gradient.reverse() * (twist / slope)};
  }

  GivenHeights Given() const override { return grid_; }

  std::size_t MemoryUse() const override {
    return static_cast<std::size_t>(grid_.heights.size()) * sizeof(double);
  }

 private:
  struct Cell {
    int column = 0;
    int row = 0;
  };

  int columns() const { return static_cast<int>(grid_.heights.rows()); }
  int rows() const { return static_cast<int>(grid_.heights.cols()); }

  double ColumnAt(int column) const { return grid_.origin.x() + column * grid_.spacing.x(); }
  double RowAt(int row) const { return grid_.origin.y() + row * grid_.spacing.y(); }

  Rectangle Known() const {
    return {grid_.origin.x(), ColumnAt(columns() - 1), grid_.origin.y(), RowAt(rows() - 1)};
  }

  double Corner(const Cell& cell, int right, int back) const {
    return grid_.heights(cell.column + right, cell.row + back);
  }

  bool IsKnown(const Cell& cell) const {
    return std::isfinite(Corner(cell, 0, 0) + Corner(cell, 1, 0) + Corner(cell, 0, 1) +
                         Corner(cell, 1, 1));
  }

  // Nothing where the interval leaves the grid.
  static std::optional<CellRange> CellsOf(double from, double to, double origin, double spacing,
                                          int lines) {
    const double slack = kBorder / spacing;
    const double begin = (from - origin) / spacing;
    const double end = (to - origin) / spacing;
    const int last_cell = lines - 2;
    if (!(begin >= -slack && end <= lines - 1 + slack)) return std::nullopt;
    const auto cell_of = [last_cell](double position) {
      return std::clamp(static_cast<int>(std::floor(position)), 0, last_cell);
    };
    if (end - begin <= 2 * slack)
      return CellRange{cell_of(begin - slack), cell_of(end + slack), true};
    const int first = cell_of(begin + slack);
    return CellRange{first, std::max(first, cell_of(std::ceil(end - slack) - 1)), false};
  }

  std::optional<CellRange> ColumnsOf(double from, double to) const {
    return CellsOf(from, to, grid_.origin.x(), grid_.spacing.x(), columns());
  }
  std::optional<CellRange> RowsOf(double from, double to) const {
    return CellsOf(from, to, grid_.origin.y(), grid_.spacing.y(), rows());
  }

  // One of the cells that is known.
  std::optional<Cell> FindKnown(const std::pair<int, int>& in_columns,
                                const std::pair<int, int>& in_rows) const {
    for (int row = in_rows.first; row <= in_rows.second; ++row) {
      for (int column = in_columns.first; column <= in_columns.second; ++column) {
        if (IsKnown({column, row})) return Cell{column, row};
      }
    }
    return std::nullopt;
  }

  absl::StatusOr<Cell> CellAt(double x, double y) const {
    const std::optional<CellRange> in_columns = ColumnsOf(x, x);
    const std::optional<CellRange> in_rows = RowsOf(y, y);
    if (!in_columns || !in_rows) return NotKnownAt(Known(), x, y);
    const std::optional<Cell> cell =
        FindKnown(in_columns->Alternatives(0), in_rows->Alternatives(0));
    if (!cell) return HoleAt(x, y);
    return *cell;
  }

  PlaceValue HeightIn(const Cell& cell, double x, double y) const {
    const double right = std::clamp((x - ColumnAt(cell.column)) / grid_.spacing.x(), 0.0, 1.0);
    const double back = std::clamp((y - RowAt(cell.row)) / grid_.spacing.y(), 0.0, 1.0);
    const double front_rise = Corner(cell, 1, 0) - Corner(cell, 0, 0);
    const double back_rise = Corner(cell, 1, 1) - Corner(cell, 0, 1);
    const double front = Corner(cell, 0, 0) + right * front_rise;
    const double behind = Corner(cell, 0, 1) + right * back_rise;
    PlaceValue height;
    height.value = (1 - back) * front + back * behind;
    height.gradient.x() = ((1 - back) * front_rise + back * back_rise) / grid_.spacing.x();
    height.gradient.y() = (behind - front) / grid_.spacing.y();
    return height;
  }

  // The sides of what an interval cuts from the cell between two lines.
  static std::array<Side, 2> CutOut(double from, double to, double line, double next_line,
                                    int number) {
    return {from >= line - kBorder ? Side{from, number} : Side{line, -1},
            to <= next_line + kBorder ? Side{to, number + 1} : Side{next_line, -1}};
  }

  // Along lines of x and y heights of a cell are linear, so that they are extreme at the corners of
  // what is cut from it.
  void Raise(const Cell& cell, const Rectangle& rectangle, double sign,
             RectangleValue& largest) const {
    const std::array<Side, 2> across = CutOut(rectangle.from_x, rectangle.to_x,
                                              ColumnAt(cell.column), ColumnAt(cell.column + 1), 0);
    const std::array<Side, 2> along =
        CutOut(rectangle.from_y, rectangle.to_y, RowAt(cell.row), RowAt(cell.row + 1), 2);
    for (const Side& x : across) {
      for (const Side& y : along) {
        const PlaceValue height = HeightIn(cell, x.at, y.at);
        if (sign * height.value <= largest.value) continue;
        largest = {sign * height.value, Eigen::Vector4d::Zero()};
        if (x.number >= 0) largest.gradient(x.number) = sign * height.gradient.x();
        if (y.number >= 0) largest.gradient(y.number) = sign * height.gradient.y();
      }
    }
  }

  absl::StatusOr<RectangleValue> LargestUnder(const Rectangle& rectangle,
                                              double sign) const override {
    const std::optional<CellRange> in_columns = ColumnsOf(rectangle.from_x, rectangle.to_x);
    const std::optional<CellRange> in_rows = RowsOf(rectangle.from_y, rectangle.to_y);
    if (!in_columns || !in_rows) return NotKnownUnder(Known(), rectangle);
    RectangleValue largest{-std::numeric_limits<double>::infinity()};
    for (int row = 0; row < in_rows->count(); ++row) {
      for (int column = 0; column < in_columns->count(); ++column) {
        const std::pair<int, int> beside = in_columns->Alternatives(column);
        const std::pair<int, int> behind = in_rows->Alternatives(row);
        const std::optional<Cell> cell = FindKnown(beside, behind);
        if (!cell) return HoleUnder(rectangle, {beside.first, behind.first});
        Raise(*cell, rectangle, sign, largest);
      }
    }
    return largest;
  }

  // The middle of what the rectangle cuts from a cell that is not known.
  absl::Status HoleUnder(const Rectangle& rectangle, const Cell& cell) const {
    const auto middle = [](double from, double to, double line, double next_line) {
      return std::clamp((std::max(from, line) + std::min(to, next_line)) / 2, from, to);
    };
    return HoleAt(
        middle(rectangle.from_x, rectangle.to_x, ColumnAt(cell.column), ColumnAt(cell.column + 1)),
        middle(rectangle.from_y, rectangle.to_y, RowAt(cell.row), RowAt(cell.row + 1)));
  }

  const HeightGrid grid_;
};

using Findings = std::vector<FieldViolation>;

void CheckAxis(const char* axis, double origin, double spacing, Eigen::Index lines,
               Findings& findings) {
  if (!(std::abs(origin) <= HeightField::kMaxFromOrigin)) {
    findings.push_back({axis, absl::StrCat("must be within ", HeightField::kMaxFromOrigin, " m")});
  }
  const std::string field = absl::StrCat(axis, "_spacing");
  if (!(spacing >= kLeastSpacing)) {
    findings.push_back({field, absl::StrCat("must be at least ", kLeastSpacing, " m")});
  } else if (!(static_cast<double>(lines) * spacing <= HeightField::kMaxFromOrigin)) {
    findings.push_back(
        {field, absl::StrCat("makes a grid longer than ", HeightField::kMaxFromOrigin, " m")});
  }
}

// Whether some cell has a height at each of its corners.
bool HasCell(const Eigen::MatrixXd& heights) {
  for (Eigen::Index row = 0; row + 1 < heights.cols(); ++row) {
    for (Eigen::Index column = 0; column + 1 < heights.rows(); ++column) {
      if (heights.block<2, 2>(column, row).allFinite()) return true;
    }
  }
  return false;
}

void CheckHeights(const Eigen::MatrixXd& heights, Findings& findings) {
  const std::size_t before = findings.size();
  for (Eigen::Index i = 0; i < heights.size(); ++i) {
    const double height = heights.data()[i];
    if (std::isnan(height) || std::abs(height) <= HeightField::kMaxFromOrigin) continue;
    findings.push_back({absl::StrCat("heights[", i, "]"),
                        absl::StrCat("must be within ", HeightField::kMaxFromOrigin,
                                     " m, or not a number where nothing is known")});
    if (findings.size() - before == kMostHeightsTold) return;
  }
  if (findings.size() == before && !HasCell(heights)) {
    findings.push_back({"heights", "know no cell of the grid at its four corners"});
  }
}

}  // namespace

absl::StatusOr<std::shared_ptr<const HeightField>> HeightField::Create(HeightGrid grid) {
  const Eigen::Index count = grid.heights.size();
  if (grid.heights.rows() < 2 || grid.heights.cols() < 2 ||
      count > static_cast<Eigen::Index>(kMaxHeights)) {
    return InvalidField("heights",
                        absl::StrCat("are ", grid.heights.rows(), " x ", grid.heights.cols(),
                                     "; 2 x 2 to ", kMaxHeights, " in all are accepted"));
  }
  Findings findings;
  CheckAxis("x", grid.origin.x(), grid.spacing.x(), grid.heights.rows(), findings);
  CheckAxis("y", grid.origin.y(), grid.spacing.y(), grid.heights.cols(), findings);
  CheckHeights(grid.heights, findings);
  if (!findings.empty()) return InvalidFields(findings);
  return std::make_shared<const GridHeights>(std::move(grid));
}

}  // namespace mortise::terrain
