#include "services/fabplanner/plan/design.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace mortise::fabplanner {
namespace {

constexpr double kFlat = 1e-6;  // m, by which a vertex may miss the faces that it lies in

// The point of the outline at height `along` in the design's coordinates.
Eigen::Vector3d PointOf(const Part& part, const Eigen::Vector2d& point, double along) {
  Eigen::Vector3d result;
  result[part.extrusion_axis] = along;
  result[(part.extrusion_axis + 1) % 3] = point.x();
  result[(part.extrusion_axis + 2) % 3] = point.y();
  return result;
}

double SignedArea(const std::vector<Eigen::Vector2d>& outline) {
  double area = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
    area += a.x() * b.y() - a.y() * b.x();
  }
  return area / 2;
}

// Whether the triangle's plane runs along the axis.
bool RunsAlong(int axis, const Part& part, const Eigen::Vector3i& corners) {
  const Eigen::Vector3d a = part.vertices.col(corners[0]);
  const Eigen::Vector3d normal =
      (part.vertices.col(corners[1]) - a).cross(part.vertices.col(corners[2]) - a);
  return std::abs(normal[axis]) <= 1e-4 * normal.norm();
}

// The border of the upper face of triangles that stand upright on their lower face, as vertices in
// order; nothing if they do not, or if the border is not a single loop.
std::optional<std::vector<int>> UprightBorder(const Part& part, const Eigen::AlignedBox3d& box) {
  const int up = part.thickness_axis;
  std::vector<bool> upper(static_cast<std::size_t>(part.vertices.cols()));
  for (Eigen::Index i = 0; i < part.vertices.cols(); ++i) {
    const double height = part.vertices(up, i);
    upper[static_cast<std::size_t>(i)] = height > box.max()[up] - kFlat;
    if (!upper[static_cast<std::size_t>(i)] && height > box.min()[up] + kFlat) return std::nullopt;
  }
  std::map<int, int> next;  // along the border, of edges with the face at their left
  for (Eigen::Index t = 0; t < part.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = part.triangles.col(t);
    const auto is_upper = [&](int k) { return upper[static_cast<std::size_t>(corners[k % 3])]; };
    const bool side = is_upper(0) != is_upper(1) || is_upper(1) != is_upper(2);
    if (side && !RunsAlong(up, part, corners)) return std::nullopt;
    for (int k = 0; k < 3; ++k) {
      // A side's upper edge runs against that of the face above it.
      if (!is_upper(k) || !is_upper(k + 1) || is_upper(k + 2)) continue;
      if (!next.emplace(corners[(k + 1) % 3], corners[k]).second) return std::nullopt;
    }
  }
  if (next.size() < 3) return std::nullopt;
  std::vector<int> border;
  int vertex = next.begin()->first;
  do {
    border.push_back(vertex);
    const auto step = next.find(vertex);
    if (step == next.end() || border.size() > next.size()) return std::nullopt;
    vertex = step->second;
  } while (vertex != border.front());
  if (border.size() != next.size()) return std::nullopt;  // there are holes
  return border;
}

}  // namespace

bool IsBox(const Part& part) {
  constexpr double kAlmostAll = 1 - 1e-6;
  if (IsShaped(part)) return VolumeOf(part) >= kAlmostAll * BoundsOf(part).volume();
  Eigen::AlignedBox2d box;
  for (const Eigen::Vector2d& point : part.outline) box.extend(point);
  return std::abs(SignedArea(part.outline)) >= kAlmostAll * box.volume();
}

double VolumeOf(const Part& part) {
  if (!IsShaped(part)) return std::abs(SignedArea(part.outline)) * (part.to - part.from);
  double volume = 0;
  for (Eigen::Index t = 0; t < part.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = part.triangles.col(t);
    volume += part.vertices.col(corners[0])
                  .dot(part.vertices.col(corners[1]).cross(part.vertices.col(corners[2]))) /
              6;
  }
  return volume;
}

bool IsPrismAlong(const Part& part, int axis) {
  if (!IsShaped(part)) return part.extrusion_axis == axis || IsBox(part);
  const Eigen::AlignedBox3d box = BoundsOf(part);
  for (Eigen::Index t = 0; t < part.triangles.cols(); ++t) {
    const Eigen::Vector3i corners = part.triangles.col(t);
    if (RunsAlong(axis, part, corners)) continue;
    bool at_start = true, at_end = true;
    for (int corner : corners) {
      at_start = at_start && part.vertices(axis, corner) < box.min()[axis] + kFlat;
      at_end = at_end && part.vertices(axis, corner) > box.max()[axis] - kFlat;
    }
    if (!at_start && !at_end) return false;
  }
  return true;
}

bool IsUpright(const Part& part) {
  if (IsBox(part)) return true;
  if (!IsShaped(part)) return part.extrusion_axis == part.thickness_axis;
  return UprightBorder(part, BoundsOf(part)).has_value();
}

const std::string& TitleOf(const Part& part) { return part.title.empty() ? part.name : part.title; }

Eigen::AlignedBox3d BoundsOf(const Part& part) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index i = 0; i < part.vertices.cols(); ++i) box.extend(part.vertices.col(i));
  for (const Eigen::Vector2d& point : part.outline) {
    box.extend(PointOf(part, point, part.from));
    box.extend(PointOf(part, point, part.to));
  }
  return box;
}

std::vector<Eigen::Vector2d> SheetOutlineOf(const Part& part) {
  const std::vector<Eigen::Vector2d> rectangle = {
      {0, 0}, {part.size.x(), 0}, {part.size.x(), part.size.y()}, {0, part.size.y()}};
  std::vector<Eigen::Vector3d> corners;
  if (IsShaped(part)) {
    const auto border = UprightBorder(part, BoundsOf(part));
    if (!border) return rectangle;
    for (int vertex : *border) corners.emplace_back(part.vertices.col(vertex));
  } else if (part.extrusion_axis == part.thickness_axis) {
    for (const Eigen::Vector2d& point : part.outline) {
      corners.push_back(PointOf(part, point, part.to));
    }
  } else {
    return rectangle;
  }
  const Eigen::Vector3d along_length = Eigen::Vector3d::Unit(part.length_axis);
  const Eigen::Vector3d along_width =
      Eigen::Vector3d::Unit(part.thickness_axis).cross(along_length);
  std::vector<Eigen::Vector2d> outline;
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  for (const Eigen::Vector3d& corner : corners) {
    outline.emplace_back(corner.dot(along_length), corner.dot(along_width));
    lower = lower.cwiseMin(outline.back());
  }
  for (Eigen::Vector2d& point : outline) point -= lower;
  if (SignedArea(outline) < 0) std::reverse(outline.begin(), outline.end());
  return outline;
}

}  // namespace mortise::fabplanner
