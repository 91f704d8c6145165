#include "services/interpolator/shapes/element_grid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace mortise::interpolator {
namespace {

constexpr double kRounding = 1e-9;  // of an element's height
constexpr double kMostCells = 4;    // for each element

// Returns the barycentric coordinates of a point, which are not finite in a flat element.
Eigen::Vector4d BarycentricOf(const Eigen::Matrix<double, 3, 4>& corners,
                              const Eigen::Vector3d& point) {
  const Eigen::Vector3d a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0),
                        c = corners.col(3) - corners.col(0), p = point - corners.col(0);
  const double volume = a.cross(b).dot(c);
  const double of_1 = p.cross(b).dot(c) / volume, of_2 = a.cross(p).dot(c) / volume,
               of_3 = a.cross(b).dot(p) / volume;
  return {1 - of_1 - of_2 - of_3, of_1, of_2, of_3};
}

}  // namespace

ElementGrid::ElementGrid(const Eigen::Matrix3Xd& nodes, const Eigen::Matrix4Xi& tetrahedra)
    : nodes_(nodes), tetrahedra_(tetrahedra) {
  if (tetrahedra.cols() == 0) return;
  lowest_ = nodes.rowwise().minCoeff();
  highest_ = nodes.rowwise().maxCoeff();
  // Boxes of elements have several times their volume, which is why a cell is a box's size.
  double boxes = 0;
  for (Eigen::Index e = 0; e < tetrahedra.cols(); ++e) {
    const Eigen::Matrix<double, 3, 4> corners = nodes(Eigen::all, tetrahedra.col(e));
    boxes += (corners.rowwise().maxCoeff() - corners.rowwise().minCoeff()).mean();
  }
  const Eigen::Vector3d size = highest_ - lowest_;
  const auto elements = static_cast<double>(tetrahedra.cols());
  cell_ = boxes > 0 ? boxes / elements : 1;
  const auto across = [&] { return ((size / cell_).array().floor() + 1).eval(); };
  while (across().prod() > std::max(kMostCells * elements, 1.0)) cell_ *= 1.25;
  cells_ = across().cast<int>();
  const auto count = static_cast<std::size_t>(across().prod());
  begin_.assign(count + 1, 0);
  for (int e = 0; e < static_cast<int>(tetrahedra.cols()); ++e) {
    VisitCells(e, [this](std::size_t cell) { ++begin_[cell + 1]; });
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  elements_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (int e = 0; e < static_cast<int>(tetrahedra.cols()); ++e) {
    VisitCells(e, [&](std::size_t cell) { elements_[next[cell]++] = e; });
  }
}

Eigen::Vector3i ElementGrid::CellOf(const Eigen::Vector3d& point) const {
  const Eigen::Array3d steps = ((point - lowest_) / cell_).array().floor();
  return steps.max(0.0).min((cells_.array() - 1).cast<double>()).cast<int>();
}

std::size_t ElementGrid::NumberOf(const Eigen::Vector3i& cell) const {
  const Eigen::Matrix<std::size_t, 3, 1> at = cell.cast<std::size_t>();
  const Eigen::Matrix<std::size_t, 3, 1> of = cells_.cast<std::size_t>();
  return (at[2] * of[1] + at[1]) * of[0] + at[0];
}

template <typename Visit>
void ElementGrid::VisitCells(int element, const Visit& visit) const {
  const Eigen::Matrix<double, 3, 4> corners = nodes_(Eigen::all, tetrahedra_.col(element));
  const Eigen::Vector3d margin = Eigen::Vector3d::Constant(kRounding * cell_);
  const Eigen::Vector3i first = CellOf(corners.rowwise().minCoeff() - margin);
  const Eigen::Vector3i last = CellOf(corners.rowwise().maxCoeff() + margin);
  for (int z = first[2]; z <= last[2]; ++z) {
    for (int y = first[1]; y <= last[1]; ++y) {
      for (int x = first[0]; x <= last[0]; ++x) visit(NumberOf({x, y, z}));
    }
  }
}

ElementPlace ElementGrid::Find(const Eigen::Vector3d& point) const {
  ElementPlace place;
  const double margin = kRounding * cell_;
  const bool is_in_box = (point.array() >= lowest_.array() - margin).all() &&
                         (point.array() <= highest_.array() + margin).all();
  if (begin_.empty() || !is_in_box) return place;
  const std::size_t cell = NumberOf(CellOf(point));
  double deepest = -kRounding;
  for (std::size_t i = begin_[cell]; i < begin_[cell + 1]; ++i) {
    const Eigen::Matrix<double, 3, 4> corners = nodes_(Eigen::all, tetrahedra_.col(elements_[i]));
    const Eigen::Vector4d barycentric = BarycentricOf(corners, point);
    const double depth = barycentric.minCoeff();
    if (!std::isfinite(depth) || !barycentric.allFinite() || depth <= deepest) continue;
    deepest = depth;
    place = {elements_[i], barycentric};
  }
  if (place.element < 0) return place;
  place.barycentric = place.barycentric.cwiseMax(0.0);
  place.barycentric /= place.barycentric.sum();
  return place;
}

}  // namespace mortise::interpolator
