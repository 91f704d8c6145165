#include "common/assembly/trial/meeting_region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

namespace mortise::parametric {
namespace {

constexpr double kParallel = 1e-9;  // cosine of an angle; m, of places that are one
constexpr std::size_t kMaxSteps = 16;

Eigen::Matrix3Xd VerticesIn(const BoundingBox& box, const mesh::DrawnShape& shape) {
  return (box.size().asDiagonal() * shape.fractions).colwise() + box.center();
}

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
  core_ = *region_;
  ShrinkTo(a, shape_a);
  ShrinkTo(b, shape_b);
  if ((core_.maximum - core_.minimum).minCoeff() < 0) core_ = *region_;
  reaches_a_ = ReachesOf(a, shape_a);
  reaches_b_ = ReachesOf(b, shape_b);
}

void MeetingRegion::ShrinkTo(const BoundingBox& box, const mesh::DrawnShape* shape) {
  if (shape == nullptr) return;
  const Eigen::Matrix3Xd vertices = VerticesIn(box, *shape);
  Eigen::AlignedBox3d within;
  const Eigen::Vector3d near = Eigen::Vector3d::Constant(tolerance_);
  const Eigen::AlignedBox3d around(region_->minimum - near, region_->maximum + near);
  for (Eigen::Index t = 0; t < shape->triangles.cols(); ++t) {
    Eigen::AlignedBox3d triangle;
    for (int k = 0; k < 3; ++k) triangle.extend(vertices.col(shape->triangles(k, t)));
    if (!triangle.intersects(around)) continue;
    for (const Eigen::Vector3d& end : {triangle.min(), triangle.max()}) {
      within.extend(end.cwiseMax(region_->minimum).cwiseMin(region_->maximum));
    }
  }
  if (within.isEmpty()) return;
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(box.minimum[axis] - region_->minimum[axis]) <= tolerance_) {
      core_.minimum[axis] = std::max(core_.minimum[axis], within.min()[axis]);
    }
    if (std::abs(box.maximum[axis] - region_->maximum[axis]) <= tolerance_) {
      core_.maximum[axis] = std::min(core_.maximum[axis], within.max()[axis]);
    }
  }
}

MeetingRegion::Reaches MeetingRegion::ReachesOf(const BoundingBox& box,
                                                const mesh::DrawnShape* shape) const {
  Reaches reaches;
  if (shape == nullptr) {
    for (int axis = 0; axis < 3; ++axis) {
      const double from = box.minimum[axis], to = box.maximum[axis];
      reaches[static_cast<std::size_t>(axis)] = {from, to, {{from, from}, {to, to}}};
    }
    return reaches;
  }
  // Of what does not run along each axis, from where to where it reaches along it: of something
  // straight, its steps.
  std::array<std::set<std::pair<double, double>>, 3> ends;
  const Eigen::Matrix3Xd vertices = VerticesIn(box, *shape);
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
      if (!reach) reach = Reach{low[axis], high[axis], {}};
      reach->from = std::min(reach->from, low[axis]);
      reach->to = std::max(reach->to, high[axis]);
      if (std::abs(normal[axis]) <= kParallel) continue;
      ends[static_cast<std::size_t>(axis)].insert({low[axis], high[axis]});
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (reaches[axis]) reaches[axis]->steps = Merged(ends[axis]);
  }
  return reaches;
}

bool MeetingRegion::Step::IsFlat() const { return high - low <= kParallel; }

std::vector<MeetingRegion::Step> MeetingRegion::Merged(
    const std::set<std::pair<double, double>>& ends) {
  std::vector<Step> steps;
  for (const auto& [low, high] : ends) {
    if (!steps.empty() && low - steps.back().high <= kParallel) {
      steps.back().high = std::max(steps.back().high, high);
    } else {
      steps.push_back({low, high});
    }
  }
  if (steps.size() > kMaxSteps) steps.clear();
  return steps;
}

bool MeetingRegion::IsOneMap(const StretchedPart& a, const StretchedPart& b, int axis, double from,
                             double to, double same) const {
  std::vector<double> places = {from, to};
  AddLevels(drawn_a_, a, axis, places);
  AddLevels(drawn_b_, b, axis, places);
  return std::all_of(places.begin(), places.end(), [&](double at) {
    if (at < from || at > to) return true;
    return std::abs(Image(drawn_a_, a, axis, at) - Image(drawn_b_, b, axis, at)) <= same;
  });
}

// Of the distance of two ends. At the ends of what is feasible they meet, which is neither apart
// nor in each other.
bool MeetingRegion::IsKept(double drawn, double now, double same) const {
  return std::abs(drawn) <= tolerance_ ? std::abs(now - drawn) <= same
                                       : std::copysign(1, drawn) * now >= -same;
}

bool MeetingRegion::AreKept(const StretchedPart& a, const Step& of_a, const StretchedPart& b,
                            const Step& of_b, int axis, double same) const {
  const bool are_flat = of_a.IsFlat() && of_b.IsFlat();
  const bool is_a_first = of_a.high < of_b.low - tolerance_;
  if (!are_flat && !is_a_first && of_a.low <= of_b.high + tolerance_) {
    return IsOneMap(a, b, axis, std::min(of_a.low, of_b.low), std::max(of_a.high, of_b.high), same);
  }
  const double end_a = is_a_first ? of_a.high : of_a.low;
  const double end_b = is_a_first ? of_b.low : of_b.high;
  return IsKept(end_a - end_b, Image(drawn_a_, a, axis, end_a) - Image(drawn_b_, b, axis, end_b),
                same);
}

bool MeetingRegion::KeepsOrder(const StretchedPart& a, const StretchedPart& b, int axis,
                               double same) const {
  const auto index = static_cast<std::size_t>(axis);
  const std::optional<Reach>& of_a = reaches_a_[index];
  const std::optional<Reach>& of_b = reaches_b_[index];
  if (!of_a || !of_b) return false;
  const auto are_kept = [&](const std::vector<Step>& steps_a, const std::vector<Step>& steps_b) {
    return std::all_of(steps_a.begin(), steps_a.end(), [&](const Step& step_a) {
      return std::all_of(steps_b.begin(), steps_b.end(), [&](const Step& step_b) {
        return AreKept(a, step_a, b, step_b, axis, same);
      });
    });
  };
  if (!of_a->steps.empty() && !of_b->steps.empty() && are_kept(of_a->steps, of_b->steps)) {
    return true;
  }
  const auto goes_straight_on = [](const Reach& reach) {
    return reach.steps.size() == 2 && reach.steps[0].IsFlat() && reach.steps[1].IsFlat();
  };
  const auto ends = [](const Reach& reach) {
    return std::vector<Step>{{reach.from, reach.from}, {reach.to, reach.to}};
  };
  const bool covers_b = of_a->from <= of_b->from + tolerance_ && of_a->to >= of_b->to - tolerance_;
  const bool covers_a = of_b->from <= of_a->from + tolerance_ && of_b->to >= of_a->to - tolerance_;
  return ((covers_b && goes_straight_on(*of_a)) || (covers_a && goes_straight_on(*of_b))) &&
         are_kept(ends(*of_a), ends(*of_b));
}

bool MeetingRegion::StandsAsDrawn(const StretchedPart& a, const StretchedPart& b,
                                  double same) const {
  if (!region_) return false;
  bool is_straight = false;  // along one axis
  for (int axis = 0; axis < 3; ++axis) {
    if (IsOneMap(a, b, axis, core_.minimum[axis], core_.maximum[axis], same)) continue;
    if (is_straight || !KeepsOrder(a, b, axis, same)) return false;
    is_straight = true;
  }
  return true;
}

}  // namespace mortise::parametric
