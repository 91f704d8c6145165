#include "common/mesh/shapes/mean_value_coordinates.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/mesh/halfedge_mesh.h"
#include "common/mesh/surface_check.h"

namespace mortise::mesh {
namespace {

using Eigen::Vector3d;

constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
constexpr double kOnSurface = 1e-13;  // of the size of the cage or triangle: counts as touching

// A cage with what does not depend on the point.
class Cage {
 public:
  explicit Cage(const SurfaceMesh& mesh) : mesh_(mesh), sides_(3, mesh.triangles.cols()) {
    center_ = mesh.vertices.rowwise().mean();
    size_ = (mesh.vertices.colwise() - center_).colwise().norm().maxCoeff();
    CollectEdges();
    PrepareNormals();
    PrepareCorrection();
  }

  // The coordinates of `x`.
  Eigen::VectorXd At(const Vector3d& x) const {
    Eigen::VectorXd coordinates = Eigen::VectorXd::Zero(mesh_.vertices.cols());
    const Eigen::Matrix3Xd offsets = mesh_.vertices.colwise() - x;
    Eigen::Index nearest;
    if (offsets.colwise().norm().minCoeff(&nearest) <= kOnSurface * size_) {
      coordinates(nearest) = 1;
      return coordinates;
    }
    if (!TouchesTriangle(offsets, coordinates)) AddWeights(offsets, coordinates);
    Correct(x, coordinates);
    return coordinates;
  }

 private:
  // An edge as seen from a point: the angle, and the normal of its plane with the point for the
  // direction from the lower to the higher vertex: its length, and the unit vector.
  struct Arc {
    double angle;
    double length;
    Vector3d normal;  // 0 where the point lies on the edge's line
  };

  void CollectEdges() {
    const CutSurface surface(mesh_.vertices, mesh_.triangles);
    const HalfedgeMesh& mesh = surface.mesh();
    // What is closed is cut nowhere along an edge.
    for (const SurfaceEdge& edge : surface.edges()) edges_.emplace_back(edge.low, edge.high);
    for (const OpenMesh::FaceHandle face : mesh.all_faces()) {
      OpenMesh::HalfedgeHandle halfedge = mesh.halfedge_handle(face);
      for (const int opposite : {2, 0, 1}) {
        sides_(opposite, face.idx()) = mesh.edge_handle(halfedge).idx();
        halfedge = mesh.next_halfedge_handle(halfedge);
      }
    }
  }

  void PrepareNormals() {
    normals_.resize(3, mesh_.triangles.cols());
    for (Eigen::Index t = 0; t < mesh_.triangles.cols(); ++t) {
      const Vector3d a = mesh_.vertices.col(mesh_.triangles(0, t)),
                     b = mesh_.vertices.col(mesh_.triangles(1, t)),
                     c = mesh_.vertices.col(mesh_.triangles(2, t));
      normals_.col(t) = (b - a).cross(c - a);
    }
  }

  // With rows A of ones and of the vertices, the least change of coordinates c that makes A c = b
  // is Aᵀ (A Aᵀ)⁻¹ (b - A c).
  void PrepareCorrection() {
    constraints_.resize(4, mesh_.vertices.cols());
    constraints_.row(0).setOnes();
    constraints_.bottomRows<3>() = (mesh_.vertices.colwise() - center_) / size_;
    const Eigen::Matrix4d gram = constraints_ * constraints_.transpose();
    correction_ = gram.ldlt().solve(constraints_).transpose();
  }

  void Correct(const Vector3d& x, Eigen::VectorXd& coordinates) const {
    Eigen::Vector4d wanted;
    wanted << 1, (x - center_) / size_;
    coordinates += correction_ * (wanted - constraints_ * coordinates);
  }

  // Whether the point lies on a triangle; its barycentric coordinates are then set.
  bool TouchesTriangle(const Eigen::Matrix3Xd& offsets, Eigen::VectorXd& coordinates) const {
    for (Eigen::Index t = 0; t < mesh_.triangles.cols(); ++t) {
      const Eigen::Vector3i corners = mesh_.triangles.col(t);
      const Vector3d normal = normals_.col(t), a = offsets.col(corners(0));
      const double square = normal.squaredNorm();
      if (std::abs(normal.dot(a)) > kOnSurface * std::sqrt(square) * size_) continue;
      const Vector3d b = offsets.col(corners(1)), c = offsets.col(corners(2));
      const Vector3d shares =
          Vector3d(normal.dot(b.cross(c)), normal.dot(c.cross(a)), normal.dot(a.cross(b))) / square;
      if (shares.minCoeff() < -kOnSurface) continue;
      for (int k = 0; k < 3; ++k) coordinates(corners(k)) = shares(k);
      return true;
    }
    return false;
  }

  std::vector<Arc> ArcsOf(const Eigen::Matrix3Xd& offsets) const {
    std::vector<Arc> arcs;
    arcs.reserve(edges_.size());
    for (const auto& [low, high] : edges_) {
      const Vector3d normal = offsets.col(low).cross(offsets.col(high));
      const double sine = normal.norm(), cosine = offsets.col(low).dot(offsets.col(high));
      // A cross product below its own rounding has no direction.
      const bool in_line = sine <= kRounding * offsets.col(low).norm() * offsets.col(high).norm();
      arcs.push_back({std::atan2(sine, cosine), sine,
                      in_line ? Vector3d(Vector3d::Zero()) : Vector3d(normal / sine)});
    }
    return arcs;
  }

  void AddWeights(const Eigen::Matrix3Xd& offsets, Eigen::VectorXd& coordinates) const {
    const std::vector<Arc> arcs = ArcsOf(offsets);
    for (Eigen::Index t = 0; t < mesh_.triangles.cols(); ++t) {
      const double volume = normals_.col(t).dot(offsets.col(mesh_.triangles(0, t)));
      if (volume == 0) continue;
      // Side k is opposite to corner k and runs from corner k + 1 to corner k + 2.
      double angles = 0;
      Vector3d normals[3];
      Vector3d mean = Vector3d::Zero();
      for (int k = 0; k < 3; ++k) {
        const Arc& arc = arcs[static_cast<std::size_t>(sides_(k, t))];
        const bool forward = mesh_.triangles((k + 1) % 3, t) < mesh_.triangles((k + 2) % 3, t);
        normals[k] = forward ? arc.normal : Vector3d(-arc.normal);
        mean += 0.5 * arc.angle * normals[k];
        angles += arc.angle;
      }
      for (int k = 0; k < 3; ++k) {
        // Of the weight n_k · m / (n_k · (p_k - x)), written so that the triangle's weights share
        // what rounding does to the denominator: near the triangle, where they outweigh all
        // others, it does not matter then.
        const double share = normals[k].dot(mean);
        if (std::abs(share) <= kRounding * angles) continue;
        const Arc& arc = arcs[static_cast<std::size_t>(sides_(k, t))];
        coordinates(mesh_.triangles(k, t)) += share * arc.length / volume;
      }
    }
    coordinates /= coordinates.sum();
  }

  const SurfaceMesh& mesh_;
  std::vector<std::pair<int, int>> edges_;
  Eigen::Matrix3Xi sides_;    // 3 × T, indices of edges
  Eigen::Matrix3Xd normals_;  // 3 × T, m², of twice the triangle's area
  Vector3d center_;
  double size_ = 0;               // m, largest distance of a vertex from the centre
  Eigen::Matrix4Xd constraints_;  // 4 × C
  Eigen::MatrixX4d correction_;   // C × 4
};

absl::Status CheckCage(const SurfaceMesh& cage) {
  const auto faults = CheckSurface(cage, 1);
  if (!faults.empty()) return InvalidField("cage", faults[0].message);
  const auto crossings = FindIntersections(cage.vertices, cage.triangles);
  if (!crossings.empty()) {
    return InvalidField("cage", absl::StrCat("triangles ", crossings[0].first, " and ",
                                             crossings[0].second, " cross each other"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Eigen::MatrixXd> MeanValueCoordinates(const SurfaceMesh& cage,
                                                     const Eigen::Matrix3Xd& points) {
  MORTISE_RETURN_IF_ERROR(CheckCage(cage));
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (!points.col(k).allFinite()) {
      return InvalidField(absl::StrCat("points[", k, "]"), "is not finite");
    }
  }
  const Cage prepared(cage);
  Eigen::MatrixXd coordinates(cage.vertices.cols(), points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    coordinates.col(k) = prepared.At(points.col(k));
  }
  return coordinates;
}

}  // namespace mortise::mesh
