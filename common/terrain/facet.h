// Triangles seen from above, and what rectangles cut from them. Private to this folder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <vector>

#include "common/terrain/height_field.h"

namespace mortise::terrain {

// A triangle, counter-clockwise seen from above, and the plane that it is part of.
struct Facet {
  std::array<Eigen::Vector2d, 3> corners;
  double height = 0;  // m, at the first corner
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();

  double HeightAt(const Eigen::Vector2d& place) const {
    return height + gradient.dot(place - corners[0]);
  }
};

// Returns the triangle of this number; one without an area has no finite gradient.
Facet FacetOf(const HeightTriangles& triangles, Eigen::Index number);

double DoubleArea(const Facet& facet);  // m²

// How far `place` lies on the inner side of the edge from corner i, and of that edge where it does
// so least, m.
double Inside(const Facet& facet, std::size_t i, const Eigen::Vector2d& place);
double LeastInside(const Facet& facet, const Eigen::Vector2d& place);

// A corner of what a rectangle cuts from a facet, with its derivatives by from_x, to_x, from_y and
// to_y.
struct CutCorner {
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  Eigen::Matrix<double, 2, 4> derivatives = Eigen::Matrix<double, 2, 4>::Zero();
};

using Cut = std::vector<CutCorner>;

double AreaOf(const Cut& cut);  // m²

// Cuts one facet after the other, and keeps the room that this takes.
class FacetCutter {
 public:
  // Returns the piece of a facet that lies in a rectangle, counter-clockwise; valid until the next.
  const Cut& Of(const Facet& facet, const Rectangle& rectangle);

 private:
  Cut cut_, room_;
};

}  // namespace mortise::terrain
