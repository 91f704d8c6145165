// Ground as heights over a plane: a grid as rasters and surveys have it, or triangles as scans do.
// What is known of it between the points that are given: heights, slopes, and the extremes under a
// rectangle, each with its derivatives.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <variant>

#include "absl/status/statusor.h"

namespace mortise::terrain {

// Heights on a grid. Between them they follow the four corners of a cell (bilinear).
struct HeightGrid {
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  // m, x of the first column, y of the first row
  Eigen::Vector2d spacing = Eigen::Vector2d::Ones();  // m, > 0
  // Columns along x × rows along y, m; at least 2 × 2. Not a number where nothing is known.
  Eigen::MatrixXd heights;
};

// Heights as flat triangles, which lie beside each other as seen from above.
struct HeightTriangles {
  Eigen::Matrix3Xd vertices;   // m
  Eigen::Matrix3Xi triangles;  // vertices of each, in either direction
};

// What a height field is made of.
using GivenHeights = std::variant<HeightGrid, HeightTriangles>;

// A value at a place, with its derivatives by x and y.
struct PlaceValue {
  double value = 0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
};

// A rectangle along the axes, m.
struct Rectangle {
  double from_x = 0;
  double to_x = 0;  // >= from_x
  double from_y = 0;
  double to_y = 0;  // >= from_y
};

// A value of a rectangle, with its derivatives by from_x, to_x, from_y and to_y.
struct RectangleValue {
  double value = 0;
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
};

// Immutable; thread safe. At edges of cells and triangles derivatives are those of one side.
class HeightField {
 public:
  // The most heights of a grid, or vertices, that one may have; of triangles, twice as many.
  static constexpr std::size_t kMaxHeights = 100'000;

  // The farthest from the origin that it may lie, and the highest or lowest, m.
  static constexpr double kMaxFromOrigin = 1e8;

  // How far outside of the border, and from one triangle to the next, a place counts as inside, m.
  static constexpr double kBorder = 1e-9;

  // INVALID_ARGUMENT naming everything that is wrong, with the field as messages have it
  // ("heights", "heights[7]", "x", "x_spacing", "vertices[2]", "triangles[4]"; elements in the
  // order of mortise/v1/template.proto): too few or too many, spacings below a micrometre, numbers
  // that are not finite or beyond kMaxFromOrigin (of a grid heights may be unknown, though some
  // cell must be known at its four corners), triangles without an area, of vertices that are not
  // there, or that lie over each other as seen from above.
  static absl::StatusOr<std::shared_ptr<const HeightField>> Create(HeightGrid grid);
  static absl::StatusOr<std::shared_ptr<const HeightField>> Create(HeightTriangles triangles);

  virtual ~HeightField() = default;

  // Returns the height at a place, m. OUT_OF_RANGE saying where the field is known, or that it has
  // a hole there, as what follows its name: "has a hole at x = 1 m, y = 2 m".
  virtual absl::StatusOr<PlaceValue> HeightAt(double x, double y) const = 0;

  // Returns the steepest rise at a place, m of height a m of way, at least 0; fails as HeightAt.
  virtual absl::StatusOr<PlaceValue> SlopeAt(double x, double y) const = 0;

  // Returns the lowest and the highest height under a rectangle, which may be a line or a point, m.
  // INVALID_ARGUMENT where it ends before it begins; else fails as HeightAt, also where only a
  // piece of it is not known. Takes time with the cells or triangles under it.
  absl::StatusOr<RectangleValue> LowestUnder(const Rectangle& rectangle) const;
  absl::StatusOr<RectangleValue> HighestUnder(const Rectangle& rectangle) const;

  // Returns what it was created of.
  virtual GivenHeights Given() const = 0;

  // Returns an estimate of the memory that it takes, bytes.
  virtual std::size_t MemoryUse() const = 0;

 private:
  // The extreme of sign times the height.
  virtual absl::StatusOr<RectangleValue> LargestUnder(const Rectangle& rectangle,
                                                      double sign) const = 0;
};

}  // namespace mortise::terrain
