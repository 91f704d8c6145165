#include "common/fem/elements/supports.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fem/elements/shape_functions.h"

namespace mortise::simulator {
namespace {

// A displacement prescribed along a direction.
struct Hold {
  Eigen::Vector3d direction;
  double displacement;
  std::size_t support;
};

// Adds a normal to the one it is nearest to, or, further than 45 degrees from all, beside them.
// Which way along it does not matter.
void AddNormal(const Eigen::Vector3d& area, std::vector<Eigen::Vector3d>& normals) {
  constexpr double kSamePlane = 0.7071;
  for (Eigen::Vector3d& normal : normals) {
    const double along = normal.dot(area);
    if (std::abs(along) < kSamePlane * normal.norm() * area.norm()) continue;
    normal += along < 0 ? Eigen::Vector3d(-area) : area;
    return;
  }
  normals.push_back(area);
}

// The area-weighted normals of each node of the triangles: one of a smooth face, and where planes
// meet at an edge or in a corner one of each.
std::map<int, std::vector<Eigen::Vector3d>> NodeNormals(const mesh::TetrahedralMesh& mesh,
                                                        const std::vector<int>& triangles) {
  std::map<int, std::vector<Eigen::Vector3d>> normals;
  const int nodes = static_cast<int>(mesh.face_triangles.rows());
  for (const int t : triangles) {
    const GradientMatrix positions = TrianglePositions(mesh, t);
    for (int k = 0; k < nodes; ++k) {
      Eigen::Vector3d l = Eigen::Vector3d::Zero();
      if (k < 3) {
        l[k] = 1;
      } else {
        l[k - 3] = l[(k - 2) % 3] = 0.5;
      }
      AddNormal(TriangleAreaVector(positions, l), normals[mesh.face_triangles(k, t)]);
    }
  }
  for (auto& [node, of_node] : normals) {
    for (Eigen::Vector3d& normal : of_node) {
      normal.normalize();
      // Faces that are square to an axis up to rounding are held along the axis.
      Eigen::Index axis;
      if (normal.cwiseAbs().maxCoeff(&axis) > 1 - 1e-12) normal = Eigen::Vector3d::Unit(axis);
    }
  }
  return normals;
}

std::map<int, std::vector<Hold>> CollectHolds(const mesh::TetrahedralMesh& mesh,
                                              const std::vector<Support>& supports) {
  std::map<int, std::vector<Hold>> holds;
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const Support& support = supports[i];
    const std::vector<int> triangles = TrianglesOn(mesh, support.face, false);
    if (support.symmetric) {
      for (const auto& [node, normals] : NodeNormals(mesh, triangles)) {
        for (const Eigen::Vector3d& normal : normals) holds[node].push_back({normal, 0, i});
      }
      continue;
    }
    std::set<int> nodes;
    if (support.face.name.empty()) nodes.insert(support.nodes.begin(), support.nodes.end());
    for (const int t : triangles) {
      for (Eigen::Index k = 0; k < mesh.face_triangles.rows(); ++k) {
        nodes.insert(mesh.face_triangles(k, t));
      }
    }
    for (const int node : nodes) {
      for (int axis = 0; axis < 3; ++axis) {
        if (!support.fixed[axis]) continue;
        holds[node].push_back({Eigen::Vector3d::Unit(axis), support.displacement[axis], i});
      }
    }
  }
  return holds;
}

absl::Status Contradiction(std::size_t support) {
  return InvalidField(absl::StrCat("supports[", support, "].displacement"),
                      "contradicts another support on a shared edge");
}

bool AlongAnAxis(const Hold& hold) { return hold.direction.cwiseAbs().maxCoeff() == 1; }

// Holds along x, y and z only.
absl::Status HoldAlongAxes(int node, const std::vector<Hold>& holds, Constraints& constraints) {
  for (const Hold& hold : holds) {
    Eigen::Index axis;
    hold.direction.cwiseAbs().maxCoeff(&axis);
    double& value = constraints.displacement(axis, node);
    if (constraints.fixed(axis, node) && value != hold.displacement) {
      return Contradiction(hold.support);
    }
    constraints.fixed(axis, node) = 1;
    value = hold.displacement;
  }
  return absl::OkStatus();
}

// Gives the node a frame whose first axes span the directions that are held.
absl::Status HoldInFrame(const mesh::TetrahedralMesh& mesh, int node,
                         const std::vector<Hold>& holds, Constraints& constraints) {
  // Directions nearer to each other than this (a degree) are the same one, known roughly.
  constexpr double kSame = 0.02;
  Eigen::Matrix3d axes;
  Eigen::Vector3d values = Eigen::Vector3d::Zero();
  int rank = 0;
  for (const Hold& hold : holds) {
    Eigen::Vector3d rest = hold.direction;
    double value = hold.displacement;
    for (int k = 0; k < rank; ++k) {
      const double share = axes.col(k).dot(hold.direction);
      rest -= share * axes.col(k);
      value -= share * values[k];
    }
    if (rest.norm() < kSame) {
      const double size = std::max(std::abs(hold.displacement), values.cwiseAbs().maxCoeff());
      if (std::abs(value) > 2 * kSame * size) return Contradiction(hold.support);
      continue;
    }
    axes.col(rank) = rest.normalized();
    values[rank++] = value / rest.norm();
  }
  if (rank == 1) axes.col(1) = axes.col(0).unitOrthogonal();
  if (rank <= 2) axes.col(2) = axes.col(0).cross(axes.col(1));
  NodeFrames& frames = constraints.frames;
  if (frames.empty()) frames.index.assign(mesh.nodes.cols(), -1);
  frames.index[node] = static_cast<int>(frames.axes.size());
  frames.axes.push_back(axes);
  for (int k = 0; k < rank; ++k) {
    constraints.fixed(k, node) = 1;
    constraints.displacement(k, node) = values[k];
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Constraints> CollectConstraints(const mesh::TetrahedralMesh& mesh,
                                               const std::vector<Support>& supports) {
  Constraints constraints;
  constraints.fixed = Eigen::Array3Xi::Zero(3, mesh.nodes.cols());
  constraints.displacement = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  for (const auto& [node, holds] : CollectHolds(mesh, supports)) {
    if (std::all_of(holds.begin(), holds.end(), AlongAnAxis)) {
      MORTISE_RETURN_IF_ERROR(HoldAlongAxes(node, holds, constraints));
    } else {
      MORTISE_RETURN_IF_ERROR(HoldInFrame(mesh, node, holds, constraints));
    }
  }
  return constraints;
}

}  // namespace mortise::simulator
