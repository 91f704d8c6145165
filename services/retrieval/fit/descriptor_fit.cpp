#include "services/retrieval/fit/descriptor_fit.h"

#include <limits>
#include <memory>
#include <utility>

#include "common/base/errors.h"
#include "services/retrieval/cover/constrained_step.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kSteps = 3;
constexpr int kHalvings = 3;
constexpr double kTrust = 0.3;  // of each range, in one step

// From the nearest of the query's vectors to this one.
VectorXd WayTo(const std::vector<VectorXd>& query, const VectorXd& value) {
  VectorXd nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const VectorXd& each : query) {
    const double distance = (each - value).norm();
    if (distance >= least) continue;
    least = distance;
    nearest = each - value;
  }
  return nearest;
}

LinearConstraints Near(const FitFamily& family, const VectorXd& q) {
  const VectorXd reach = kTrust * (family.surfaces.upper - family.surfaces.lower);
  LinearConstraints near = ConstraintsOf(family);
  const LinearConstraints box = BoxConstraints(q - reach, q + reach);
  near.bounds.head(box.bounds.size()) = near.bounds.head(box.bounds.size()).cwiseMin(box.bounds);
  return near;
}

}  // namespace

absl::StatusOr<VectorXd> NearerByDescriptor(const Descriptor& descriptor,
                                            const std::vector<VectorXd>& query,
                                            const FitFamily& family, FamilyMember member,
                                            int threads) {
  if (member.meshed_anew) return member.q;
  const VectorXd ranges = family.surfaces.upper - family.surfaces.lower;
  const Eigen::Matrix3Xi triangles = member.surface.triangles;
  MORTISE_ASSIGN_OR_RETURN(const std::unique_ptr<BoundDescriptor> bound,
                           descriptor.Bind(member.surface));
  for (int step = 0; step < kSteps; ++step) {
    MORTISE_ASSIGN_OR_RETURN(const DescriptorDerivatives here,
                             bound->Differentiate(member.surface.vertices, member.velocities));
    const VectorXd way = WayTo(query, here.value);
    MORTISE_ASSIGN_OR_RETURN(VectorXd change, ConstrainedStep(Near(family, member.q), member.q,
                                                              here.jacobian, ranges, way));
    bool nearer = false;
    for (int halving = 0; halving <= kHalvings && !nearer; ++halving, change /= 2) {
      const VectorXd next =
          (member.q + change).cwiseMax(family.surfaces.lower).cwiseMin(family.surfaces.upper);
      const absl::StatusOr<mesh::SurfaceMesh> surface = family.surfaces.surface(next);
      if (!surface.ok()) continue;
      if (surface->triangles.cols() != triangles.cols() || surface->triangles != triangles) {
        return member.q;
      }
      const absl::StatusOr<VectorXd> value = bound->Describe(surface->vertices);
      if (!value.ok() || WayTo(query, *value).norm() >= way.norm()) continue;
      MORTISE_ASSIGN_OR_RETURN(member, MoveMember(family, member, next, threads));
      nearer = true;
    }
    if (!nearer) break;
  }
  return member.q;
}

}  // namespace mortise::retrieval
