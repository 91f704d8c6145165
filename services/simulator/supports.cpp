#include "services/simulator/supports.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

// Sets of nodes that elements connect.
class ConnectedNodes {
 public:
  explicit ConnectedNodes(const mesh::TetrahedralMesh& mesh) : parent_(mesh.nodes.cols()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
      for (Eigen::Index k = 1; k < mesh.tetrahedra.rows(); ++k) {
        parent_[Root(mesh.tetrahedra(k, e))] = Root(mesh.tetrahedra(0, e));
      }
    }
  }

  int Root(int node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }

 private:
  std::vector<int> parent_;
};

using RigidMode = Eigen::Matrix<double, 6, 1>;  // translation, rotation about the centre

// One set of connected nodes.
struct Component {
  std::set<int> parts;
  std::vector<int> nodes;
};

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

// The rigid motion that the supports leave to the component, if there is one.
bool FindFreeMode(const Component& component, const mesh::TetrahedralMesh& mesh,
                  const Constraints& constraints, RigidMode& mode) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  Eigen::AlignedBox3d box;
  for (const int v : component.nodes) {
    centre += mesh.nodes.col(v) / component.nodes.size();
    box.extend(mesh.nodes.col(v));
  }
  // Rotations are scaled so that they move the component's ends as far as translations do.
  const double size = std::max(0.5 * box.diagonal().norm(), 1e-300);
  Eigen::Matrix<double, 6, 6> gram = Eigen::Matrix<double, 6, 6>::Zero();
  for (const int v : component.nodes) {
    const Eigen::Vector3d arm = (mesh.nodes.col(v) - centre) / size;
    for (int k = 0; k < 3; ++k) {
      if (!constraints.fixed(k, v)) continue;
      RigidMode row;
      row << Eigen::Vector3d::Unit(k), arm.cross(Eigen::Vector3d::Unit(k));
      gram += row * row.transpose();
    }
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(gram);
  mode = eigen.eigenvectors().col(0);
  const double largest = eigen.eigenvalues()[5];
  return largest == 0 || eigen.eigenvalues()[0] < 1e-10 * largest;
}

}  // namespace

absl::StatusOr<Constraints> CollectConstraints(const mesh::TetrahedralMesh& mesh,
                                               const AnalysisCase& analysis) {
  Constraints constraints;
  constraints.fixed = Eigen::Array3Xi::Zero(3, mesh.nodes.cols());
  constraints.displacement = Eigen::Matrix3Xd::Zero(3, mesh.nodes.cols());
  for (std::size_t i = 0; i < analysis.supports.size(); ++i) {
    const Support& support = analysis.supports[i];
    for (const int t : TrianglesOn(mesh, support.face, false)) {
      for (Eigen::Index k = 0; k < mesh.face_triangles.rows(); ++k) {
        const int node = mesh.face_triangles(k, t);
        for (int axis = 0; axis < 3; ++axis) {
          if (!support.fixed[axis]) continue;
          double& value = constraints.displacement(axis, node);
          if (constraints.fixed(axis, node) && value != support.displacement[axis]) {
            return InvalidField(absl::StrCat("supports[", i, "].displacement"),
                                "contradicts another support on a shared edge");
          }
          constraints.fixed(axis, node) = 1;
          value = support.displacement[axis];
        }
      }
    }
  }
  return constraints;
}

absl::Status CheckRigidMotion(const mesh::TetrahedralMesh& mesh, const Constraints& constraints) {
  ConnectedNodes connected(mesh);
  std::vector<int> index(mesh.nodes.cols(), -1);
  std::vector<Component> components;
  for (int v = 0; v < mesh.nodes.cols(); ++v) {
    int& component = index[connected.Root(v)];
    if (component < 0) {
      component = static_cast<int>(components.size());
      components.emplace_back();
    }
    components[component].nodes.push_back(v);
  }
  for (Eigen::Index e = 0; e < mesh.tetrahedra.cols(); ++e) {
    components[index[connected.Root(mesh.tetrahedra(0, e))]].parts.insert(mesh.part[e]);
  }
  for (const Component& component : components) {
    RigidMode mode;
    if (!FindFreeMode(component, mesh, constraints, mode)) continue;
    if (component.parts.empty()) {
      return InvalidField("nodes",
                          absl::StrCat("node ", component.nodes[0], " belongs to no element"));
    }
    std::vector<std::string> names;
    for (const int part : component.parts) {
      if (names.size() < 4) names.push_back(absl::StrCat("'", mesh.part_names[part], "'"));
    }
    const std::size_t more = component.parts.size() - names.size();
    const std::string subject =
        absl::StrCat(component.parts.size() > 1 ? "parts " : "part ", absl::StrJoin(names, ", "),
                     more > 0 ? absl::StrCat(" and ", more, " more") : "",
                     component.parts.size() > 1 ? " are" : " is");
    return PreconditionFailed("RIGID_MOTION",
                              absl::StrCat(subject, " free to ", MotionText(mode),
                                           ": not held by supports or bonded parts"),
                              "supports");
  }
  return absl::OkStatus();
}

}  // namespace mortise::simulator
