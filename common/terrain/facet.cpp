#include "common/terrain/facet.h"

#include <algorithm>
#include <utility>

namespace mortise::terrain {
namespace {

using Eigen::Vector2d;

double Cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// A side of a rectangle: what lies beyond `at` along the axis, in the direction of `sign`, is off.
struct CuttingSide {
  int axis = 0;
  double at = 0;  // m
  double sign = 1;
  int number = 0;  // of the rectangle's four
};

std::array<CuttingSide, 4> SidesOf(const Rectangle& rectangle) {
  return {CuttingSide{0, rectangle.from_x, -1, 0}, CuttingSide{0, rectangle.to_x, 1, 1},
          CuttingSide{1, rectangle.from_y, -1, 2}, CuttingSide{1, rectangle.to_y, 1, 3}};
}

// Where the way from a to b, which lie on either side of it, meets a side.
CutCorner Meet(const CutCorner& a, const CutCorner& b, const CuttingSide& side) {
  const double way = b.place(side.axis) - a.place(side.axis);
  const double share = (side.at - a.place(side.axis)) / way;
  const Eigen::Matrix<double, 2, 4> difference = b.derivatives - a.derivatives;
  Eigen::RowVector4d share_derivatives =
      -a.derivatives.row(side.axis) - share * difference.row(side.axis);
  share_derivatives(side.number) += 1;
  share_derivatives /= way;
  CutCorner corner;
  corner.place = a.place + share * (b.place - a.place);
  corner.derivatives = a.derivatives + share * difference + (b.place - a.place) * share_derivatives;
  corner.place(side.axis) = side.at;
  return corner;
}

// Sutherland and Hodgman, one side at a time.
void CutOff(const CuttingSide& side, Cut& cut, Cut& kept) {
  kept.clear();
  const auto beyond = [&side](const CutCorner& corner) {
    return side.sign * (corner.place(side.axis) - side.at);
  };
  for (std::size_t i = 0; i < cut.size(); ++i) {
    const CutCorner& a = cut[i];
    const CutCorner& b = cut[(i + 1) % cut.size()];
    if (beyond(a) <= 0) kept.push_back(a);
    if ((beyond(a) < 0 && beyond(b) > 0) || (beyond(a) > 0 && beyond(b) < 0)) {
      kept.push_back(Meet(a, b, side));
    }
  }
  std::swap(cut, kept);
}

}  // namespace

Facet FacetOf(const HeightTriangles& triangles, Eigen::Index number) {
  std::array<Eigen::Vector3d, 3> corners;
  for (int i = 0; i < 3; ++i) {
    corners[static_cast<std::size_t>(i)] = triangles.vertices.col(triangles.triangles(i, number));
  }
  Facet facet;
  const auto look_from_above = [&] {
    for (std::size_t i = 0; i < 3; ++i) facet.corners[i] = corners[i].head<2>();
  };
  look_from_above();
  if (DoubleArea(facet) < 0) {
    std::swap(corners[1], corners[2]);
    look_from_above();
  }
  facet.height = corners[0].z();
  const Vector2d first = facet.corners[1] - facet.corners[0];
  const Vector2d second = facet.corners[2] - facet.corners[0];
  const double first_rise = corners[1].z() - corners[0].z();
  const double second_rise = corners[2].z() - corners[0].z();
  facet.gradient = Vector2d(first_rise * second.y() - second_rise * first.y(),
                            second_rise * first.x() - first_rise * second.x()) /
                   DoubleArea(facet);
  return facet;
}

double DoubleArea(const Facet& facet) {
  return Cross(facet.corners[1] - facet.corners[0], facet.corners[2] - facet.corners[0]);
}

double Inside(const Facet& facet, std::size_t i, const Vector2d& place) {
  const Vector2d edge = facet.corners[(i + 1) % 3] - facet.corners[i];
  return Cross(edge, place - facet.corners[i]) / edge.norm();
}

double LeastInside(const Facet& facet, const Vector2d& place) {
  return std::min({Inside(facet, 0, place), Inside(facet, 1, place), Inside(facet, 2, place)});
}

double AreaOf(const Cut& cut) {
  double twice = 0;
  for (std::size_t i = 1; i + 1 < cut.size(); ++i) {
    twice += Cross(cut[i].place - cut[0].place, cut[i + 1].place - cut[0].place);
  }
  return twice / 2;
}

const Cut& FacetCutter::Of(const Facet& facet, const Rectangle& rectangle) {
  cut_.assign(3, CutCorner{});
  for (std::size_t i = 0; i < 3; ++i) cut_[i].place = facet.corners[i];
  for (const CuttingSide& side : SidesOf(rectangle)) CutOff(side, cut_, room_);
  return cut_;
}

}  // namespace mortise::terrain
