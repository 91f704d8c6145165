#include "services/fabplanner/joining/part_solid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "services/fabplanner/documents/part_mesh.h"

namespace mortise::fabplanner {
namespace {

constexpr double kTouch = 1e-4;  // m, within which faces touch
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Lines are moved by this much, m: through a triangle's edge they would meet both its sides or
// none.
constexpr double kAside = 1.7e-7;

// The axis-parallel lines are along `axis`, and cross its plane (u, v).
int PlaneAxis(int axis, int index) { return (axis + 1 + index) % 3; }

// Where a line at (u, v) meets a triangle, by height; NaN where it does not.
class Crossing {
 public:
  Crossing(const Eigen::Matrix3Xd& vertices, const Eigen::Vector3i& triangle, int axis) {
    for (int k = 0; k < 3; ++k) {
      const auto vertex = vertices.col(triangle[k]);
      u_[k] = vertex[PlaneAxis(axis, 0)];
      v_[k] = vertex[PlaneAxis(axis, 1)];
      height_[k] = vertex[axis];
    }
    area_ = (u_[1] - u_[0]) * (v_[2] - v_[0]) - (u_[2] - u_[0]) * (v_[1] - v_[0]);
  }
  double At(double u, double v) const {
    if (area_ == 0) return std::numeric_limits<double>::quiet_NaN();
    double height = 0;
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      const double weight = ((u_[a] - u) * (v_[b] - v) - (u_[b] - u) * (v_[a] - v)) / area_;
      if (!(weight >= 0)) return std::numeric_limits<double>::quiet_NaN();
      height += weight * height_[k];
    }
    return height;
  }
  double LowestU() const { return std::min({u_[0], u_[1], u_[2]}); }
  double HighestU() const { return std::max({u_[0], u_[1], u_[2]}); }

 private:
  std::array<double, 3> u_, v_, height_;
  double area_ = 0;
};

// Whether the triangle reaches into the box: what of it the box's planes leave is not empty.
bool ReachesBox(std::vector<Eigen::Vector3d> polygon, const Eigen::AlignedBox3d& box) {
  for (int plane = 0; plane < 6 && !polygon.empty(); ++plane) {
    const int axis = plane % 3;
    const double sign = plane < 3 ? 1 : -1;
    const double border = plane < 3 ? box.max()[axis] : -box.min()[axis];
    std::vector<Eigen::Vector3d> kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      const Eigen::Vector3d& a = polygon[i];
      const Eigen::Vector3d& b = polygon[(i + 1) % polygon.size()];
      const double from = border - sign * a[axis], to = border - sign * b[axis];
      if (from >= 0) kept.push_back(a);
      if ((from < 0) != (to < 0)) kept.push_back(a + (b - a) * (from / (from - to)));
    }
    polygon = std::move(kept);
  }
  return !polygon.empty();
}

// How far two boxes overlap along an axis, m; negative for a gap.
double Overlap(const Eigen::AlignedBox3d& a, const Eigen::AlignedBox3d& b, int axis) {
  return std::min(a.max()[axis], b.max()[axis]) - std::max(a.min()[axis], b.min()[axis]);
}

Eigen::AlignedBox3d Grown(const Eigen::AlignedBox3d& box, double by) {
  return {box.min() - Eigen::Vector3d::Constant(by), box.max() + Eigen::Vector3d::Constant(by)};
}

}  // namespace

// The lowest and highest point of a part on each line of a grid across an axis.
class PartSolid::Heights {
 public:
  Heights(const PartSolid& part, const Eigen::AlignedBox3d& region, int axis)
      : region_(region),
        axis_(axis),
        low_(kRays * kRays, kInfinity),
        high_(kRays * kRays, -kInfinity) {
    if (part.is_box()) {
      std::fill(low_.begin(), low_.end(), part.box_.min()[axis]);
      std::fill(high_.begin(), high_.end(), part.box_.max()[axis]);
      return;
    }
    const int u_axis = PlaneAxis(axis, 0), v_axis = PlaneAxis(axis, 1);
    for (Eigen::Index t = 0; t < part.triangles_.cols(); ++t) {
      const Crossing triangle(part.vertices_, part.triangles_.col(t), axis);
      for (int i = 0; i < kRays; ++i) {
        const double u = Place(u_axis, i) + kAside;
        if (u < triangle.LowestU() || u > triangle.HighestU()) continue;
        for (int j = 0; j < kRays; ++j) {
          const double height = triangle.At(u, Place(v_axis, j) + kAside);
          if (std::isnan(height)) continue;
          const std::size_t ray = static_cast<std::size_t>(i * kRays + j);
          low_[ray] = std::min(low_[ray], height);
          high_[ray] = std::max(high_[ray], height);
        }
      }
    }
  }
  // Both infinite where the line misses the part.
  double low(std::size_t ray) const { return low_[ray]; }
  double high(std::size_t ray) const { return high_[ray]; }
  std::size_t count() const { return low_.size(); }
  // A point of the line, beside which it runs.
  Eigen::Vector3d PointOf(std::size_t ray) const {
    Eigen::Vector3d point = region_.center();
    point[PlaneAxis(axis_, 0)] = Place(PlaneAxis(axis_, 0), static_cast<int>(ray) / kRays);
    point[PlaneAxis(axis_, 1)] = Place(PlaneAxis(axis_, 1), static_cast<int>(ray) % kRays);
    return point;
  }

 private:
  double Place(int plane_axis, int i) const {
    return region_.min()[plane_axis] + region_.sizes()[plane_axis] * (i + 0.5) / kRays;
  }

  const Eigen::AlignedBox3d region_;
  const int axis_;
  std::vector<double> low_, high_;
};

PartSolid::PartSolid(const Part& part) : box_(BoundsOf(part)) {
  if (IsBox(part) || part.connecting) return;
  render::Shape shape = PartShape(part, Eigen::Vector3d::Zero());
  vertices_ = std::move(shape.vertices);
  triangles_ = std::move(shape.triangles);
}

std::vector<Stretch> PartSolid::Along(int axis, const Eigen::Vector3d& point) const {
  const int u_axis = PlaneAxis(axis, 0), v_axis = PlaneAxis(axis, 1);
  for (int plane_axis : {u_axis, v_axis}) {
    if (point[plane_axis] <= box_.min()[plane_axis] ||
        point[plane_axis] >= box_.max()[plane_axis]) {
      return {};
    }
  }
  if (is_box()) return {{box_.min()[axis], box_.max()[axis]}};
  std::vector<double> heights;
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    const Crossing triangle(vertices_, triangles_.col(t), axis);
    const double height = triangle.At(point[u_axis] + kAside, point[v_axis] + 0.6 * kAside);
    if (!std::isnan(height)) heights.push_back(height);
  }
  std::sort(heights.begin(), heights.end());
  std::vector<Stretch> inside;
  for (std::size_t i = 0; i + 1 < heights.size(); i += 2) {
    if (heights[i + 1] > heights[i]) inside.push_back({heights[i], heights[i + 1]});
  }
  return inside;
}

bool PartSolid::ReachesInto(const Eigen::AlignedBox3d& box) const {
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    std::vector<Eigen::Vector3d> corners;
    Eigen::AlignedBox3d bounds;
    for (int k = 0; k < 3; ++k) {
      corners.emplace_back(vertices_.col(triangles_(k, t)));
      bounds.extend(corners.back());
    }
    if (bounds.intersects(box) && ReachesBox(std::move(corners), box)) return true;
  }
  for (const Stretch& stretch : Along(2, box.center())) {
    if (stretch.from <= box.center().z() && box.center().z() <= stretch.to) return true;
  }
  return false;
}

bool PartSolid::Touches(const PartSolid& other) const {
  int wide = 0;  // axes along which they share more than an edge
  for (int axis = 0; axis < 3; ++axis) {
    const double overlap = Overlap(box_, other.box_, axis);
    if (overlap < -kTouch) return false;
    wide += overlap > kTouch ? 1 : 0;
  }
  if (wide < 2) return false;
  if (is_box() && other.is_box()) return true;
  const PartSolid& shaped = is_box() ? other : *this;
  const PartSolid& second = is_box() ? *this : other;
  if (second.is_box()) return shaped.ReachesInto(Grown(second.box_, kTouch));
  // Triangles of the one against the boxes of the other's.
  const Eigen::AlignedBox3d common =
      Grown(shaped.box_, kTouch).intersection(Grown(second.box_, kTouch));
  for (Eigen::Index t = 0; t < second.triangles_.cols(); ++t) {
    Eigen::AlignedBox3d bounds;
    for (int k = 0; k < 3; ++k) bounds.extend(second.vertices_.col(second.triangles_(k, t)));
    bounds = Grown(bounds, kTouch);
    if (bounds.intersects(common) && shaped.ReachesInto(bounds)) return true;
  }
  return false;
}

bool PartSolid::Overlaps(const PartSolid& other) const {
  Eigen::AlignedBox3d common = box_.intersection(other.box_);
  for (int axis = 0; axis < 3; ++axis) {
    if (Overlap(box_, other.box_, axis) <= kFit) return false;
  }
  if (is_box() && other.is_box()) return true;
  const Heights own(*this, common, 2), others(other, common, 2);
  for (std::size_t ray = 0; ray < own.count(); ++ray) {
    const double shared =
        std::min(own.high(ray), others.high(ray)) - std::max(own.low(ray), others.low(ray));
    // From its lowest to its highest point a part may have gaps.
    if (shared > kFit && SharedAlong(other, own.PointOf(ray)) > kFit) return true;
  }
  return false;
}

double PartSolid::SharedAlong(const PartSolid& other, const Eigen::Vector3d& point) const {
  double longest = 0;
  for (const Stretch& own : Along(2, point)) {
    for (const Stretch& others : other.Along(2, point)) {
      longest = std::max(longest, std::min(own.to, others.to) - std::max(own.from, others.from));
    }
  }
  return longest;
}

bool PartSolid::IsBlockedBy(const PartSolid& other, int axis, int sign) const {
  Eigen::AlignedBox3d common = box_.intersection(other.box_);
  for (int plane_axis : {PlaneAxis(axis, 0), PlaneAxis(axis, 1)}) {
    if (Overlap(box_, other.box_, plane_axis) <= kFit) return false;
  }
  const bool beyond = sign > 0 ? other.box_.max()[axis] > box_.min()[axis] + kFit
                               : other.box_.min()[axis] < box_.max()[axis] - kFit;
  if (!beyond) return false;
  if (is_box() && other.is_box()) return true;
  const Heights own(*this, common, axis), others(other, common, axis);
  for (std::size_t ray = 0; ray < own.count(); ++ray) {
    if (own.low(ray) > own.high(ray) || others.low(ray) > others.high(ray)) continue;
    if (sign > 0 ? others.high(ray) > own.low(ray) + kFit
                 : others.low(ray) < own.high(ray) - kFit) {
      return true;
    }
  }
  return false;
}

}  // namespace mortise::fabplanner
