#include "services/simulator/supports.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "services/simulator/components.h"
#include "services/simulator/shape_functions.h"

namespace mortise::simulator {
namespace {

using RigidMode = Eigen::Matrix<double, 6, 1>;  // translation, rotation about the centre

std::string AxisText(const Eigen::Vector3d& direction) {
  static constexpr const char* kNames[] = {"x", "y", "z"};
  for (int k = 0; k < 3; ++k) {
    if (std::abs(direction[k]) > 0.99) return kNames[k];
  }
  return absl::StrFormat("(%.2g, %.2g, %.2g)", direction.x(), direction.y(), direction.z());
}

std::string MotionText(const RigidMode& mode) {
  const Eigen::Vector3d shift = mode.head<3>(), turn = mode.tail<3>();
  if (turn.norm() > 0.3 * shift.norm()) return "rotate about " + AxisText(turn.normalized());
  return "move along " + AxisText(shift.normalized());
}

// The motions of a component that the supports leave, in units of its size.
struct FreeModes {
  Eigen::Vector3d centre;
  double size = 1;  // m: a rotation of 1 moves the component's ends by this
  Eigen::Matrix<double, 6, Eigen::Dynamic> modes;  // orthonormal columns, the freest first
};

FreeModes FindFreeModes(const Component& component, const mesh::TetrahedralMesh& mesh,
                        const Constraints& constraints) {
  FreeModes free;
  free.centre.setZero();
  Eigen::AlignedBox3d box;
  for (const int v : component.nodes) {
    free.centre += mesh.nodes.col(v) / component.nodes.size();
    box.extend(mesh.nodes.col(v));
  }
  // Rotations are scaled so that they move the component's ends as far as translations do.
  free.size = std::max(0.5 * box.diagonal().norm(), 1e-300);
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  for (const int v : component.nodes) {
    if ((constraints.fixed.col(v) == 0).all()) continue;
    const Eigen::Vector3d arm = (mesh.nodes.col(v) - free.centre) / free.size;
    const int frame = constraints.frames.empty() ? -1 : constraints.frames.index[v];
    for (int k = 0; k < 3; ++k) {
      if (!constraints.fixed(k, v)) continue;
      Eigen::Vector3d direction = Eigen::Vector3d::Unit(k);
      if (frame >= 0) direction = constraints.frames.axes[frame].col(k);
      RigidMode row;
      row << direction, arm.cross(direction);
      gram += row * row.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(gram);
  const double largest = eigen.eigenvalues()[5];
  int count = 0;
  while (count < 6 && (largest == 0 || eigen.eigenvalues()[count] < 1e-10 * largest)) ++count;
  free.modes = eigen.eigenvectors().leftCols(count);
  return free;
}

// Whether one of its parts has other pieces, to which nothing connects it.
bool IsPiece(const Component& component, const std::vector<Component>& components) {
  return std::any_of(components.begin(), components.end(), [&](const Component& other) {
    return &other != &component &&
           std::any_of(component.parts.begin(), component.parts.end(),
                       [&](int part) { return other.parts.count(part) != 0; });
  });
}

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

absl::Status CheckRigidMotion(const mesh::TetrahedralMesh& mesh, const Constraints& constraints) {
  const std::vector<Component> components = FindComponents(mesh);
  for (const Component& component : components) {
    const FreeModes free = FindFreeModes(component, mesh, constraints);
    if (free.modes.cols() == 0) continue;
    if (component.parts.empty()) {
      return InvalidField("nodes",
                          absl::StrCat("node ", component.nodes[0], " belongs to no element"));
    }
    return PreconditionFailed(
        "RIGID_MOTION",
        absl::StrCat(IsPiece(component, components)
                         ? absl::StrCat("the piece ", PlaceText(component, mesh), " of ")
                         : "",
                     PartsText(component, mesh), " free to ", MotionText(free.modes.col(0)),
                     ": not held by supports or bonded parts"),
        "supports");
  }
  return absl::OkStatus();
}

std::vector<Eigen::Matrix3Xd> RigidMotions(const mesh::TetrahedralMesh& mesh,
                                           const Constraints& constraints) {
  std::vector<Eigen::Matrix3Xd> motions;
  for (const Component& component : FindComponents(mesh)) {
    const FreeModes free = FindFreeModes(component, mesh, constraints);
    for (Eigen::Index m = 0; m < free.modes.cols(); ++m) {
      const Eigen::Vector3d shift = free.modes.col(m).head<3>(), turn = free.modes.col(m).tail<3>();
      Eigen::Matrix3Xd motion = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
      for (const int v : component.nodes) {
        motion.col(v) =
            shift + turn.cross(Eigen::Vector3d(mesh.nodes.col(v) - free.centre)) / free.size;
      }
      motions.push_back(std::move(motion));
    }
  }
  return motions;
}

}  // namespace mortise::simulator
