#include "common/parametric/meeting_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
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
      reaches[static_cast<std::size_t>(axis)] = {box.minimum[axis], box.maximum[axis], true};
    }
    return reaches;
  }
  // Of what does not run along each axis, from where to where it reaches along it: of something
  // straight, the two ends.
  std::array<std::set<std::pair<double, double>>, 3> flat_ends;
  const Eigen::Matrix3Xd vertices =
      (box.size().asDiagonal() * shape->fractions).colwise() + box.center();
  for (Eigen::Index t = 0; t < shape->triangles.cols(); ++t) {
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) = vertices.col(shape->triangles(k, t));
    const Eigen::Vector3d normal =
        (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).normalized();
    const Eigen::Array3d low = corners.rowwise().minCoeff(), high = corners.rowwise().maxCoeff();
    const Eigen::Array<bool, 3, 1> is_near = low <= region_->maximum.array() + tolerance_ &&
                                             high >= region_->minimum.array() - tolerance_;
    for (int axis = 0; axis < 3; ++axis) {
      if (!is_near[(axis + 1) % 3] || !is_near[(axis + 2) % 3]) continue;
      std::optional<Reach>& reach = reaches[static_cast<std::size_t>(axis)];
      if (!reach) reach = Reach{low[axis], high[axis], true};
      reach->from = std::min(reach->from, low[axis]);
      reach->to = std::max(reach->to, high[axis]);
      if (std::abs(normal[axis]) <= kParallel) continue;
      flat_ends[static_cast<std::size_t>(axis)].insert({low[axis], high[axis]});
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!reaches[axis]) continue;
    Reach& reach = *reaches[axis];
    reach.is_straight = std::all_of(
        flat_ends[axis].begin(), flat_ends[axis].end(), [&](const std::pair<double, double>& end) {
          return end.second - end.first <= kParallel &&
                 (end.first - reach.from <= kParallel || reach.to - end.second <= kParallel);
        });
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

// Of the distance of two ends. At the ends of what is feasible they meet, which is neither apart
// nor in each other.
bool MeetingRegion::IsKept(double drawn, double now, double same) const {
  return std::abs(drawn) <= tolerance_ ? std::abs(now - drawn) <= same
                                       : std::copysign(1, drawn) * now >= -same;
}

bool MeetingRegion::KeepsOrder(const StretchedPart& a, const StretchedPart& b, int axis,
                               double same) const {
  const auto index = static_cast<std::size_t>(axis);
  const std::optional<Reach>& of_a = reaches_a_[index];
  const std::optional<Reach>& of_b = reaches_b_[index];
  if (!of_a || !of_b) return false;
  for (const double end_a : {of_a->from, of_a->to}) {
    for (const double end_b : {of_b->from, of_b->to}) {
      const double now = Image(drawn_a_, a, axis, end_a) - Image(drawn_b_, b, axis, end_b);
      if (!IsKept(end_a - end_b, now, same)) return false;
    }
  }
  const bool covers_b = of_a->from <= of_b->from + tolerance_ && of_a->to >= of_b->to - tolerance_;
  const bool covers_a = of_b->from <= of_a->from + tolerance_ && of_b->to >= of_a->to - tolerance_;
  return (of_a->is_straight && of_b->is_straight) || (of_a->is_straight && covers_b) ||
         (of_b->is_straight && covers_a);
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
