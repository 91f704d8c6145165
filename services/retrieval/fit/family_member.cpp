#include "services/retrieval/fit/family_member.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "common/assembly/polyhedra/polyhedron.h"
#include "common/base/errors.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/fit/mesh_points.h"
#include "services/retrieval/fit/oriented_points.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using mesh::SurfaceMesh;

constexpr double kShortStep = 1e-3;     // of a parameter's range
constexpr double kLongStep = 2e-2;      // where the triangles differ
constexpr double kWish = 0.1;           // of a range, towards what is feasible
constexpr double kStale = 0.05;         // of a surface's motion: more is another velocity
constexpr double kStaleOfSolids = 0.3;  // the same where members are meshed anew
constexpr double kRounding = 1e-9;      // of the diagonal
constexpr double kNormalLength = 0.05;  // of the diagonal
constexpr Index kFacePoints = 3000;
constexpr double kWithin = 1e-9;  // of a range

bool HaveSameTriangles(const SurfaceMesh& a, const SurfaceMesh& b) {
  return a.vertices.cols() == b.vertices.cols() && a.triangles.cols() == b.triangles.cols() &&
         a.triangles == b.triangles;
}

double DiagonalOf(const SurfaceMesh& surface) {
  return (surface.vertices.rowwise().maxCoeff() - surface.vertices.rowwise().minCoeff()).norm();
}

// Finds the place of one surface on another that is much like it.
class FaceFinder {
 public:
  explicit FaceFinder(const SurfaceMesh& surface)
      : surface_(surface),
        points_(SampleSurface(surface, kFacePoints)),
        tree_(points_.PlacesOn(surface), points_.NormalsOn(surface),
              kNormalLength * DiagonalOf(surface)) {}

  // The nearest triangle that faces this way.
  int TriangleNear(const Vector3d& place, const Vector3d& normal) const {
    return points_.triangles[tree_.Find(place, normal).index];
  }

  // How far it is along the normal to the plane of that triangle.
  double OffsetFrom(const Vector3d& place, const Vector3d& normal) const {
    const Eigen::Vector3i corners = surface_.triangles.col(TriangleNear(place, normal));
    const Vector3d a = surface_.vertices.col(corners[0]);
    const Vector3d across = (surface_.vertices.col(corners[1]) - a)
                                .cross(surface_.vertices.col(corners[2]) - a)
                                .normalized();
    const double cosine = across.dot(normal);
    return std::abs(cosine) < 0.3 ? 0 : across.dot(a - place) / cosine;
  }

 private:
  const SurfaceMesh& surface_;
  const MeshPoints points_;
  const OrientedPoints tree_;
};

// Displacements of vertices that move each triangle's plane along its normal by as much as it is
// off another surface; of several, the smallest.
Matrix3Xd NormalMotion(const SurfaceMesh& from, const SurfaceMesh& to) {
  const FaceFinder faces(to);
  std::vector<Eigen::Matrix3d> squares(static_cast<std::size_t>(from.vertices.cols()),
                                       Eigen::Matrix3d::Zero());
  Matrix3Xd sums = Matrix3Xd::Zero(3, from.vertices.cols());
  for (const auto& corners : from.triangles.colwise()) {
    const Vector3d a = from.vertices.col(corners[0]);
    Vector3d normal = (from.vertices.col(corners[1]) - a).cross(from.vertices.col(corners[2]) - a);
    if (!(normal.norm() > 0)) continue;
    normal.normalize();
    const Vector3d middle = from.vertices(Eigen::all, corners).rowwise().mean();
    const double offset = faces.OffsetFrom(middle, normal);
    for (const int corner : corners) {
      squares[static_cast<std::size_t>(corner)] += normal * normal.transpose();
      sums.col(corner) += offset * normal;
    }
  }
  for (Index v = 0; v < sums.cols(); ++v) {
    Eigen::Matrix3d& square = squares[static_cast<std::size_t>(v)];
    square.diagonal().array() += 1e-3 * square.trace() + 1e-12;
    sums.col(v) = square.ldlt().solve(sums.col(v)).eval();
  }
  return sums;
}

// The changes of parameters that a difference is taken along: along each axis, or where that is not
// feasible, along what is nearest to it.
absl::StatusOr<MatrixXd> DirectionsAt(const FitFamily& family, const VectorXd& q) {
  const VectorXd ranges = family.surfaces.upper - family.surfaces.lower;
  const Index count = q.size();
  MatrixXd directions = MatrixXd::Zero(count, count);
  for (Index k = 0; k < count; ++k) {
    const bool up = q[k] + kWish * ranges[k] <= family.surfaces.upper[k];
    directions(k, k) = up ? ranges[k] : -ranges[k];
  }
  if (family.cuts.bounds.size() == 0) return directions;
  MatrixXd candidates(count, 2 * count);
  for (Index k = 0; k < 2 * count; ++k) {
    VectorXd wish = q;
    wish[k / 2] += (k % 2 == 0 ? kWish : -kWish) * ranges[k / 2];
    MORTISE_ASSIGN_OR_RETURN(const VectorXd near, NearestFeasible(family, wish));
    candidates.col(k) = (near - q).cwiseQuotient(ranges) / kWish;
  }
  const Eigen::ColPivHouseholderQR<MatrixXd> factor(candidates);
  const auto& order = factor.colsPermutation().indices();
  for (Index k = 0; k < count; ++k) {
    directions.col(k) = ranges.cwiseProduct(candidates.col(order[k]));
  }
  return directions;
}

struct Motion {
  Matrix3Xd velocity;        // of the vertices
  bool meshed_anew = false;  // whether the surface beside had other triangles
};

// How the surface moves along a direction; nothing where that cannot be made. Where members are
// known to be meshed anew, only one is made.
absl::StatusOr<Motion> MotionAlong(const FitFamily& family, const FamilyMember& member,
                                   const VectorXd& direction, bool meshed_anew) {
  const VectorXd ranges = family.surfaces.upper - family.surfaces.lower;
  const auto beside = [&](double step) -> absl::StatusOr<SurfaceMesh> {
    const VectorXd q = member.q + step * direction;
    const VectorXd kept = q.cwiseMax(family.surfaces.lower).cwiseMin(family.surfaces.upper);
    // A shorter step than is divided by would tell of too slow a motion.
    if (((q - kept).array().abs() > kWithin * ranges.array()).any()) {
      return absl::OutOfRangeError("the design beside it is beyond the ranges of its parameters");
    }
    return family.surfaces.surface(kept);
  };
  absl::Status failed;
  for (const double sign : {1.0, -1.0}) {
    if (!meshed_anew) {
      const absl::StatusOr<SurfaceMesh> near = beside(sign * kShortStep);
      failed.Update(near.status());
      if (!near.ok()) continue;
      if (HaveSameTriangles(*near, member.surface)) {
        return Motion{(near->vertices - member.surface.vertices) / (sign * kShortStep), false};
      }
    }
    const absl::StatusOr<SurfaceMesh> far = beside(sign * kLongStep);
    failed.Update(far.status());
    if (!far.ok()) continue;
    if (HaveSameTriangles(*far, member.surface)) {
      return Motion{(far->vertices - member.surface.vertices) / (sign * kLongStep), false};
    }
    return Motion{NormalMotion(member.surface, *far) / (sign * kLongStep), true};
  }
  return failed;
}

absl::Status AddVelocities(const FitFamily& family, int threads, FamilyMember* member) {
  if (family.surfaces.velocities) {
    MORTISE_ASSIGN_OR_RETURN(member->velocities, family.surfaces.velocities(member->q));
    return absl::OkStatus();
  }
  MORTISE_ASSIGN_OR_RETURN(const MatrixXd directions, DirectionsAt(family, member->q));
  const Index count = directions.cols();
  std::vector<absl::StatusOr<Motion>> motions(static_cast<std::size_t>(count));
  const auto look = [&](Index k) {
    motions[static_cast<std::size_t>(k)] =
        MotionAlong(family, *member, directions.col(k), member->meshed_anew);
  };
  // The first tells how the others are best looked at.
  look(0);
  MORTISE_RETURN_IF_ERROR(motions[0].status());
  member->meshed_anew = member->meshed_anew || motions[0]->meshed_anew;
  ParallelFor(static_cast<int>(count) - 1, threads, [&](int k) { look(k + 1); });
  for (const auto& motion : motions) MORTISE_RETURN_IF_ERROR(motion.status());
  const Eigen::CompleteOrthogonalDecomposition<MatrixXd> factor(directions);
  const MatrixXd inverse = factor.pseudoInverse();
  member->velocities.assign(motions.size(), Matrix3Xd::Zero(3, member->surface.vertices.cols()));
  for (Index k = 0; k < count; ++k) {
    for (Index along = 0; along < count; ++along) {
      if (inverse(along, k) == 0) continue;
      member->velocities[static_cast<std::size_t>(k)] +=
          inverse(along, k) * motions[static_cast<std::size_t>(along)]->velocity;
    }
  }
  return absl::OkStatus();
}

// The velocities of a surface on another, much like it, by where its vertices are on that.
std::vector<Matrix3Xd> Transported(const FamilyMember& from, const SurfaceMesh& predicted,
                                   const SurfaceMesh& surface) {
  const FaceFinder faces(predicted);
  std::vector<Matrix3Xd> velocities(from.velocities.size(),
                                    Matrix3Xd::Zero(3, surface.vertices.cols()));
  std::vector<bool> is_done(static_cast<std::size_t>(surface.vertices.cols()), false);
  for (const auto& corners : surface.triangles.colwise()) {
    const Vector3d a = surface.vertices.col(corners[0]);
    const Vector3d normal = (surface.vertices.col(corners[1]) - a)
                                .cross(surface.vertices.col(corners[2]) - a)
                                .normalized();
    for (const int corner : corners) {
      if (is_done[static_cast<std::size_t>(corner)]) continue;
      is_done[static_cast<std::size_t>(corner)] = true;
      const Vector3d place = surface.vertices.col(corner);
      const Eigen::Vector3i on = predicted.triangles.col(faces.TriangleNear(place, normal));
      const Vector3d where = BarycentricOf(predicted.vertices(Eigen::all, on), place);
      for (std::size_t k = 0; k < velocities.size(); ++k) {
        velocities[k].col(corner) = from.velocities[k](Eigen::all, on) * where;
      }
    }
  }
  return velocities;
}

// How far the faces of one surface are off another along their normals: root mean square over area.
double NormalDifference(const SurfaceMesh& of, const SurfaceMesh& other) {
  const FaceFinder faces(other);
  const MeshPoints points = SampleSurface(of, kFacePoints / 3);
  const Matrix3Xd places = points.PlacesOn(of), normals = points.NormalsOn(of);
  double sum = 0;
  for (Index i = 0; i < places.cols(); ++i) {
    const double offset = faces.OffsetFrom(places.col(i), normals.col(i));
    sum += offset * offset;
  }
  return std::sqrt(sum / static_cast<double>(std::max<Index>(1, places.cols())));
}

// The velocities that hold for `surface` too; nothing where they do not.
std::optional<std::vector<Matrix3Xd>> StillHolding(const FamilyMember& from, const VectorXd& q,
                                                   const SurfaceMesh& surface) {
  const SurfaceMesh predicted = from.At(q);
  const double rounding = kRounding * DiagonalOf(surface);
  if (HaveSameTriangles(predicted, surface)) {
    const double motion = (predicted.vertices - from.surface.vertices).cwiseAbs().maxCoeff();
    const double error = (predicted.vertices - surface.vertices).cwiseAbs().maxCoeff();
    if (error > kStale * motion + rounding) return std::nullopt;
    return from.velocities;
  }
  const double motion = NormalDifference(predicted, from.surface);
  if (NormalDifference(surface, predicted) > kStaleOfSolids * motion + rounding) {
    return std::nullopt;
  }
  return Transported(from, predicted, surface);
}

}  // namespace

SurfaceMesh FamilyMember::At(const VectorXd& other) const {
  SurfaceMesh moved = surface;
  for (Index k = 0; k < q.size(); ++k) {
    if (other[k] == q[k]) continue;
    moved.vertices += (other[k] - q[k]) * velocities[static_cast<std::size_t>(k)];
  }
  return moved;
}

LinearConstraints ConstraintsOf(const FitFamily& family) {
  const LinearConstraints box = BoxConstraints(family.surfaces.lower, family.surfaces.upper);
  return family.cuts.bounds.size() == 0 ? box : BothConstraints(box, family.cuts);
}

absl::StatusOr<VectorXd> NearestFeasible(const FitFamily& family, const VectorXd& q) {
  const VectorXd kept = q.cwiseMax(family.surfaces.lower).cwiseMin(family.surfaces.upper);
  if (family.cuts.bounds.size() == 0) return kept;
  const VectorXd ranges = family.surfaces.upper - family.surfaces.lower;
  const LinearConstraints constraints = ConstraintsOf(family);
  const MatrixXd rows = constraints.normals * ranges.asDiagonal();
  // A little within, so that rounding makes nothing infeasible.
  const VectorXd bounds = constraints.bounds - constraints.normals * family.surfaces.lower -
                          kWithin * rows.rowwise().norm();
  const parametric::Polyhedron feasible{rows, bounds, MatrixXd(0, q.size()), VectorXd(0)};
  const VectorXd wish = (q - family.surfaces.lower).cwiseQuotient(ranges);
  MORTISE_ASSIGN_OR_RETURN(parametric::Projection projection,
                           parametric::ProjectOnto(feasible, wish));
  if (!projection.point) {
    // What is flat has nothing within.
    const parametric::Polyhedron flat{
        rows, constraints.bounds - constraints.normals * family.surfaces.lower,
        MatrixXd(0, q.size()), VectorXd(0)};
    MORTISE_ASSIGN_OR_RETURN(projection, parametric::ProjectOnto(flat, wish));
  }
  if (!projection.point) {
    return PreconditionFailed("NOTHING_FEASIBLE", "no parameters meet all constraints", "cuts");
  }
  return VectorXd(family.surfaces.lower + ranges.cwiseProduct(*projection.point));
}

absl::StatusOr<FamilyMember> MakeMember(const FitFamily& family, const VectorXd& q, int threads) {
  MORTISE_ASSIGN_OR_RETURN(SurfaceMesh surface, family.surfaces.surface(q));
  FamilyMember member{q, std::move(surface), {}, false};
  MORTISE_RETURN_IF_ERROR(AddVelocities(family, threads, &member));
  return member;
}

absl::StatusOr<FamilyMember> MoveMember(const FitFamily& family, const FamilyMember& from,
                                        const VectorXd& q, int threads) {
  MORTISE_ASSIGN_OR_RETURN(SurfaceMesh surface, family.surfaces.surface(q));
  FamilyMember member{q, std::move(surface), {}, from.meshed_anew};
  if (!family.surfaces.velocities) {
    std::optional<std::vector<Matrix3Xd>> velocities = StillHolding(from, q, member.surface);
    if (velocities) {
      member.velocities = *std::move(velocities);
      return member;
    }
  }
  MORTISE_RETURN_IF_ERROR(AddVelocities(family, threads, &member));
  return member;
}

}  // namespace mortise::retrieval
