#include "common/parametric/meeting_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace mortise::parametric {
namespace {

constexpr double kParallel = 1e-9;  // cosine of an angle

// Where a place of the drawn part goes along an axis.
double Image(const BoundingBox& drawn, const StretchedPart& part, int axis, double at) {
  const double fraction = (at - drawn.center()[axis]) / drawn.size()[axis];
  return part.box.center()[axis] + part.stretch.PlaceOf(axis, fraction);
}

// The levels of a part's stretch as drawn.
void AddLevels(const BoundingBox& drawn, const StretchedPart& part, int axis,
               std::vector<double>& places) {
  for (const mesh::LevelPlace& level : part.stretch.levels[static_cast<std::size_t>(axis)]) {
    places.push_back(drawn.center()[axis] + level.fraction * drawn.size()[axis]);
  }
}

}  // namespace

MeetingRegion::MeetingRegion(const BoundingBox& a, const mesh::DrawnShape* shape_a,
                             const BoundingBox& b, const mesh::DrawnShape* shape_b,
                             double tolerance)
    : drawn_a_(a), drawn_b_(b), tolerance_(tolerance) {
  const Eigen::Vector3d from = a.minimum.cwiseMax(b.minimum), to = a.maximum.cwiseMin(b.maximum);
  if ((to - from).minCoeff() < -tolerance) return;
  region_ = {from.cwiseMin(to), from.cwiseMax(to)};
  reaches_a_ = ReachesOf(a, shape_a);
  reaches_b_ = ReachesOf(b, shape_b);
}

MeetingRegion::Reaches MeetingRegion::ReachesOf(const BoundingBox& box,
                                                const mesh::DrawnShape* shape) const {
  Reaches reaches;
  if (shape == nullptr) {
    for (int axis = 0; axis < 3; ++axis) {
      reaches[static_cast<std::size_t>(axis)] = {box.minimum[axis], box.maximum[axis]};
    }
    return reaches;
  }
  const Eigen::Matrix3Xd vertices =
      (box.size().asDiagonal() * shape->fractions).colwise() + box.center();
  std::array<bool, 3> is_straight = {true, true, true};
  for (Eigen::Index t = 0; t < shape->triangles.cols(); ++t) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = vertices.col(shape->triangles(k, t));
    const Eigen::Vector3d normal =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).normalized();
    const Eigen::Array3d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
    const Eigen::Array<bool, 3, 1> is_near = low <= region_->maximum.array() + tolerance_ &&
                                             high >= region_->minimum.array() - tolerance_;
    for (int axis = 0; axis < 3; ++axis) {
      const auto index = static_cast<std::size_t>(axis);
      // Beside the region, or along the axis: no end of anything.
      if (!is_near[(axis + 1) % 3] || !is_near[(axis + 2) % 3]) continue;
      if (std::abs(normal[axis]) <= kParallel || !is_straight[index]) continue;
      // Two flat ends, and nothing else.
      is_straight[index] = high[axis] - low[axis] <= kParallel;
      std::optional<Reach>& reach = reaches[index];
      if (!reach) reach = Reach{low[axis], low[axis]};
      const bool is_end = std::abs(low[axis] - reach->from) <= kParallel ||
                          std::abs(low[axis] - reach->to) <= kParallel;
      is_straight[index] &= is_end || reach->from == reach->to;
      reach = Reach{std::min(reach->from, low[axis]), std::max(reach->to, low[axis])};
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!is_straight[axis]) reaches[axis].reset();
  }
  return reaches;
}

bool MeetingRegion::IsOneMap(const StretchedPart& a, const StretchedPart& b, int axis,
                             double same) const {
  std::vector<double> places = {region_->minimum[axis], region_->maximum[axis]};
  AddLevels(drawn_a_, a, axis, places);
  AddLevels(drawn_b_, b, axis, places);
  return std::all_of(places.begin(), places.end(), [&](double at) {
    if (at < region_->minimum[axis] || at > region_->maximum[axis]) return true;
    return std::abs(Image(drawn_a_, a, axis, at) - Image(drawn_b_, b, axis, at)) <= same;
  });
}

bool MeetingRegion::KeepsOrder(const StretchedPart& a, const StretchedPart& b, int axis,
                               double same) const {
  const auto index = static_cast<std::size_t>(axis);
  const std::optional<Reach>& of_a = reaches_a_[index];
  const std::optional<Reach>& of_b = reaches_b_[index];
  if (!of_a || !of_b) return false;
  for (const double end_a : {of_a->from, of_a->to}) {
    for (const double end_b : {of_b->from, of_b->to}) {
      const double drawn = end_a - end_b;
      const double now = Image(drawn_a_, a, axis, end_a) - Image(drawn_b_, b, axis, end_b);
      // At the ends of what is feasible they meet, which is neither apart nor in each other.
      const bool is_kept = std::abs(drawn) <= tolerance_
                               ? std::abs(now - drawn) <= same
                               : std::copysign(1, drawn) * now >= -same;
      if (!is_kept) return false;
    }
  }
  return true;
}

bool MeetingRegion::StandsAsDrawn(const StretchedPart& a, const StretchedPart& b,
                                  double same) const {
  if (!region_) return false;
  bool is_straight = false;  // along one axis
  for (int axis = 0; axis < 3; ++axis) {
    if (IsOneMap(a, b, axis, same)) continue;
    if (is_straight || !KeepsOrder(a, b, axis, same)) return false;
    is_straight = true;
  }
  return true;
}

}  // namespace mortise::parametric
