#include "services/fabplanner/documents/part_mesh.h"

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "common/design/polygon.h"

namespace mortise::fabplanner {
namespace {

// Closes a ring of `count` points at two levels: vertices 0 … count-1 below, the rest above.
void AppendSides(int count, std::vector<Eigen::Vector3i>* triangles) {
  for (int i = 0; i < count; ++i) {
    const int next = (i + 1) % count;
    triangles->emplace_back(i, next, count + next);
    triangles->emplace_back(i, count + next, count + i);
  }
}

Eigen::Matrix3Xi ToMatrix(const std::vector<Eigen::Vector3i>& triangles) {
  Eigen::Matrix3Xi matrix(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    matrix.col(static_cast<Eigen::Index>(i)) = triangles[i];
  }
  return matrix;
}

}  // namespace

render::Shape PartShape(const Part& part, const Eigen::Vector3d& offset) {
  render::Shape shape;
  if (IsShaped(part)) {
    shape.vertices = part.vertices.colwise() + offset;
    shape.triangles = part.triangles;
    return shape;
  }
  const int count = static_cast<int>(part.outline.size());
  Eigen::Matrix2Xd polygon(2, count);
  shape.vertices.resize(3, 2 * count);
  for (int i = 0; i < count; ++i) {
    polygon.col(i) = part.outline[i];
    for (int level = 0; level < 2; ++level) {
      Eigen::Vector3d vertex;
      vertex[part.extrusion_axis] = level == 0 ? part.from : part.to;
      vertex[(part.extrusion_axis + 1) % 3] = part.outline[i].x();
      vertex[(part.extrusion_axis + 2) % 3] = part.outline[i].y();
      shape.vertices.col(level * count + i) = vertex + offset;
    }
  }
  if (!parametric::IsSimple(polygon, 1e-9)) return render::Shape();
  std::vector<Eigen::Vector3i> triangles;
  AppendSides(count, &triangles);
  for (const std::array<int, 3>& t : parametric::Triangulate(polygon)) {
    triangles.emplace_back(t[0], t[2], t[1]);
    triangles.emplace_back(count + t[0], count + t[1], count + t[2]);
  }
  shape.triangles = ToMatrix(triangles);
  return shape;
}

render::Shape PegShape(const Eigen::Vector3d& start, const Eigen::Vector3d& end, double diameter) {
  constexpr int kSides = 12;
  render::Shape shape;
  shape.vertices.resize(3, 2 * kSides);
  const Eigen::Vector3d axis = (end - start).normalized();
  const Eigen::Vector3d u = axis.unitOrthogonal();
  const Eigen::Vector3d v = axis.cross(u);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * std::numbers::pi * i / kSides;
    const Eigen::Vector3d radius = diameter / 2 * (std::cos(angle) * u + std::sin(angle) * v);
    shape.vertices.col(i) = start + radius;
    shape.vertices.col(kSides + i) = end + radius;
  }
  std::vector<Eigen::Vector3i> triangles;
  AppendSides(kSides, &triangles);
  for (int i = 1; i + 1 < kSides; ++i) {
    triangles.emplace_back(0, i + 1, i);
    triangles.emplace_back(kSides, kSides + i, kSides + i + 1);
  }
  shape.triangles = ToMatrix(triangles);
  shape.feature_angle = 1.0;  // the rims, not the facets
  return shape;
}

render::Shape PegShape(const Peg& peg, const Eigen::Vector3d& offset) {
  const Eigen::Vector3d face = peg.position + offset;
  return PegShape(face - peg.depth_in_part * peg.direction,
                  face + (peg.length - peg.depth_in_part) * peg.direction, peg.diameter);
}

}  // namespace mortise::fabplanner
