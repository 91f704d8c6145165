#include "common/fem/elements/mesh_velocity.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fem/elements/material.h"
#include "common/fem/elements/stiffness.h"
#include "common/fem/linear/sparse_cholesky.h"
#include "common/mesh/corner_mesh.h"

namespace mortise::simulator {
namespace {

constexpr double kAgreement = 1e-6;  // of the largest velocity

// What the faces prescribe at the corners.
struct Prescribed {
  Eigen::Array3Xi is_fixed;                  // 3 × corners
  std::vector<Eigen::Matrix3Xd> velocities;  // for each parameter, 3 × corners
};

class Prescription {
 public:
  Prescription(const mesh::CornerMesh& corners, int parameters) : corners_(corners) {
    const Eigen::Index count = corners.mesh.nodes.cols();
    prescribed_.is_fixed = Eigen::Array3Xi::Zero(3, count);
    prescribed_.velocities.assign(static_cast<std::size_t>(parameters),
                                  Eigen::Matrix3Xd::Zero(3, count));
  }

  // False if the face's motion is another than what is known of the node already.
  bool Add(const FaceMotion& motion, int node, double tolerance) {
    const int corner = corners_.corner_of[static_cast<std::size_t>(node)];
    const double length = motion.to_end.squaredNorm();
    const Eigen::Vector3d position = corners_.mesh.nodes.col(corner);
    const double share = length > 0 ? (position - motion.start).dot(motion.to_end) / length : 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!motion.prescribed[static_cast<std::size_t>(axis)]) continue;
      const bool is_known = prescribed_.is_fixed(axis, corner) != 0;
      prescribed_.is_fixed(axis, corner) = 1;
      for (std::size_t k = 0; k < prescribed_.velocities.size(); ++k) {
        const auto column = static_cast<Eigen::Index>(k);
        const double velocity = (1 - share) * motion.start_velocity(axis, column) +
                                share * motion.end_velocity(axis, column);
        double& known = prescribed_.velocities[k](axis, corner);
        if (is_known && std::abs(known - velocity) > tolerance) return false;
        known = velocity;
      }
    }
    return true;
  }

  const Prescribed& prescribed() const { return prescribed_; }

 private:
  const mesh::CornerMesh& corners_;
  Prescribed prescribed_;
};

absl::Status Prescribe(const mesh::TetrahedralMesh& mesh, const std::vector<FaceMotion>& motions,
                       Prescription& prescription) {
  double largest = 0;
  for (const FaceMotion& motion : motions) {
    if (motion.start_velocity.size() == 0) continue;
    largest = std::max({largest, motion.start_velocity.cwiseAbs().maxCoeff(),
                        motion.end_velocity.cwiseAbs().maxCoeff()});
  }
  for (Eigen::Index t = 0; t < mesh.face_triangles.cols(); ++t) {
    const mesh::AssemblyFace& face =
        mesh.faces[static_cast<std::size_t>(mesh.face_triangle_face[t])];
    for (const mesh::NamedFace& origin : face.origins) {
      const auto motion =
          std::find_if(motions.begin(), motions.end(),
                       [&origin](const FaceMotion& of) { return of.face == origin; });
      const std::string& part = mesh.part_names[static_cast<std::size_t>(origin.part)];
      const std::string name = absl::StrCat("face '", origin.name, "' of part '", part, "'");
      if (motion == motions.end()) {
        return PreconditionFailed("MESH_MOTION", absl::StrCat("nobody says how ", name, " moves"),
                                  name);
      }
      for (int k = 0; k < 3; ++k) {
        if (prescription.Add(*motion, mesh.face_triangles(k, t), kAgreement * largest)) continue;
        return PreconditionFailed(
            "MESH_MOTION",
            absl::StrCat(name, " and what it touches move apart with the parameters"), name);
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::vector<Eigen::Matrix3Xd>> NodeVelocities(const mesh::TetrahedralMesh& mesh,
                                                             const std::vector<FaceMotion>& motions,
                                                             int parameters, double memory_limit) {
  const mesh::CornerMesh corners = mesh::CornersOf(mesh);
  Prescription prescription(corners, parameters);
  MORTISE_RETURN_IF_ERROR(Prescribe(mesh, motions, prescription));
  const Prescribed& prescribed = prescription.prescribed();
  Material rubber;
  rubber.name = "mesh";
  rubber.density = 1;
  rubber.youngs_modulus = 1;
  MORTISE_ASSIGN_OR_RETURN(const BlockMatrix stiffness, AssembleStiffness(corners.mesh, {rubber}));
  std::vector<Eigen::Matrix3Xd> forces;
  for (const Eigen::Matrix3Xd& velocity : prescribed.velocities) {
    forces.push_back(
        (prescribed.is_fixed == 0).select(-stiffness.Multiply(velocity).array(), 0.0).matrix());
  }
  std::vector<Eigen::Matrix3Xd> velocities = prescribed.velocities;
  if ((prescribed.is_fixed == 0).any()) {
    CholeskyOptions options;
    options.memory_limit = memory_limit;
    MORTISE_ASSIGN_OR_RETURN(SparseCholesky factor,
                             SparseCholesky::Create(stiffness, prescribed.is_fixed, options));
    MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::Matrix3Xd> free, factor.SolveAll(forces));
    for (std::size_t k = 0; k < velocities.size(); ++k) velocities[k] += free[k];
  }
  for (Eigen::Matrix3Xd& velocity : velocities)
    velocity = mesh::AtAllNodes(mesh, corners, velocity);
  return velocities;
}

}  // namespace mortise::simulator
