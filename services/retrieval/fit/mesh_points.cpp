#include "services/retrieval/fit/mesh_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "services/retrieval/descriptors/surface_samples.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::Vector3d;

constexpr double kMinArea = 2e-5;  // of the whole area: what smaller triangles have no point of
constexpr double kOutside = 0.25;  // of a barycentric coordinate
constexpr std::uint64_t kSeed = 3;

Vector3d AreaOf(const mesh::SurfaceMesh& surface, Index triangle) {
  return AreaVector(surface.vertices, surface.triangles.col(triangle));
}

}  // namespace

Matrix3Xd MeshPoints::PlacesOn(const mesh::SurfaceMesh& surface) const {
  Matrix3Xd places(3, size());
  for (Index i = 0; i < size(); ++i) {
    const Eigen::Vector3i corners = surface.triangles.col(triangles[i]);
    places.col(i) = surface.vertices(Eigen::all, corners) * barycentric.col(i);
  }
  return places;
}

Matrix3Xd MeshPoints::NormalsOn(const mesh::SurfaceMesh& surface) const {
  Matrix3Xd normals(3, size());
  for (Index i = 0; i < size(); ++i) normals.col(i) = AreaOf(surface, triangles[i]).normalized();
  return normals;
}

MeshPoints SampleSurface(const mesh::SurfaceMesh& surface, Index count) {
  const SurfaceSamples samples(surface.vertices, surface.triangles, count, kSeed);
  std::vector<bool> has_point(static_cast<std::size_t>(surface.triangles.cols()), false);
  std::vector<int> triangles;
  double whole = 0;
  for (Index t = 0; t < surface.triangles.cols(); ++t) whole += AreaOf(surface, t).norm();
  for (Index i = 0; i < samples.size(); ++i) {
    triangles.push_back(samples.TriangleOf(i));
    has_point[static_cast<std::size_t>(triangles.back())] = true;
  }
  for (int t = 0; t < surface.triangles.cols(); ++t) {
    if (has_point[static_cast<std::size_t>(t)]) continue;
    if (AreaOf(surface, t).norm() >= kMinArea * whole) triangles.push_back(t);
  }
  MeshPoints points;
  points.triangles = Eigen::Map<Eigen::VectorXi>(triangles.data(), Index(triangles.size()));
  points.barycentric.setConstant(3, points.size(), 1.0 / 3);
  for (Index i = 0; i < samples.size(); ++i) points.barycentric.col(i) = samples.BarycentricOf(i);
  return points;
}

Vector3d BarycentricOf(const Eigen::Matrix3d& corners, const Vector3d& place) {
  const Vector3d u = corners.col(1) - corners.col(0), v = corners.col(2) - corners.col(0);
  const Vector3d w = place - corners.col(0);
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v);
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 0)) return Vector3d::Constant(1.0 / 3);
  const double b = (vv * w.dot(u) - uv * w.dot(v)) / determinant;
  const double c = (uu * w.dot(v) - uv * w.dot(u)) / determinant;
  const Vector3d kept = Vector3d(1 - b - c, b, c).cwiseMax(-kOutside).cwiseMin(1 + kOutside);
  return kept / kept.sum();
}

}  // namespace mortise::retrieval
