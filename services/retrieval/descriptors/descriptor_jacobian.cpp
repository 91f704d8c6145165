#include "services/retrieval/descriptors/descriptor_jacobian.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::retrieval {
namespace {

constexpr double kStepOfRange = 1e-3;

absl::Status CheckInBox(const SurfaceFamily& family, const Eigen::VectorXd& q) {
  if (q.size() != family.lower.size() || q.size() != family.upper.size()) {
    return InvalidField(
        "q", absl::StrCat("has ", q.size(), " parameters, the family has ", family.lower.size()));
  }
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    if (!(q[k] >= family.lower[k] && q[k] <= family.upper[k])) {
      return InvalidField(absl::StrCat("q[", k, "]"), "lies outside of the parameter's range");
    }
  }
  return absl::OkStatus();
}

// The vertices at q + step e_k, if the triangles are those of `middle`.
absl::StatusOr<Eigen::Matrix3Xd> VerticesBeside(const SurfaceFamily& family,
                                                const mesh::SurfaceMesh& middle, Eigen::VectorXd q,
                                                Eigen::Index k, double step) {
  q[k] += step;
  MORTISE_ASSIGN_OR_RETURN(mesh::SurfaceMesh beside, family.surface(q));
  if (beside.vertices.cols() != middle.vertices.cols() ||
      beside.triangles.cols() != middle.triangles.cols() || beside.triangles != middle.triangles) {
    return PreconditionFailed(
        "TRIANGLES_CHANGE", "the surface has other triangles a little farther along the parameter",
        absl::StrCat("q[", k, "]"));
  }
  return std::move(beside.vertices);
}

// Differences at `middle` = family.surface(q).
absl::StatusOr<std::vector<Eigen::Matrix3Xd>> DifferenceVelocities(const SurfaceFamily& family,
                                                                   const mesh::SurfaceMesh& middle,
                                                                   const Eigen::VectorXd& q) {
  std::vector<Eigen::Matrix3Xd> velocities;
  for (Eigen::Index k = 0; k < q.size(); ++k) {
    const double step = kStepOfRange * (family.upper[k] - family.lower[k]);
    const auto beside = [&](double by) { return VerticesBeside(family, middle, q, k, by); };
    const bool room_below = q[k] - step >= family.lower[k];
    const bool room_above = q[k] + step <= family.upper[k];
    if (room_below && room_above) {
      MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd above, beside(step));
      MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd below, beside(-step));
      velocities.emplace_back((above - below) / (2 * step));
    } else {
      const double inwards = room_above ? step : -step;
      MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd near, beside(inwards));
      MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3Xd far, beside(2 * inwards));
      velocities.emplace_back((4 * near - far - 3 * middle.vertices) / (2 * inwards));
    }
  }
  return velocities;
}

absl::StatusOr<std::vector<Eigen::Matrix3Xd>> VelocitiesAt(const SurfaceFamily& family,
                                                           const mesh::SurfaceMesh& middle,
                                                           const Eigen::VectorXd& q) {
  if (family.velocities) return family.velocities(q);
  return DifferenceVelocities(family, middle, q);
}

}  // namespace

absl::StatusOr<std::vector<Eigen::Matrix3Xd>> VertexVelocities(const SurfaceFamily& family,
                                                               const Eigen::VectorXd& q) {
  MORTISE_RETURN_IF_ERROR(CheckInBox(family, q));
  MORTISE_ASSIGN_OR_RETURN(const mesh::SurfaceMesh middle, family.surface(q));
  return VelocitiesAt(family, middle, q);
}

absl::StatusOr<DescriptorDerivatives> DescriptorJacobian(const BoundDescriptor& bound,
                                                         const SurfaceFamily& family,
                                                         const Eigen::VectorXd& q) {
  MORTISE_RETURN_IF_ERROR(CheckInBox(family, q));
  MORTISE_ASSIGN_OR_RETURN(const mesh::SurfaceMesh middle, family.surface(q));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Eigen::Matrix3Xd> velocities,
                           VelocitiesAt(family, middle, q));
  return bound.Differentiate(middle.vertices, velocities);
}

}  // namespace mortise::retrieval
