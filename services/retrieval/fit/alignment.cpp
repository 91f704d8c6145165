#include "services/retrieval/fit/alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/errors.h"
#include "services/retrieval/cover/constrained_step.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::Matrix3Xd;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kNormalLength = 0.1;  // of the diagonal
constexpr double kBesides = 3;         // reaches that a point may lie beside its triangle

// An affine map along the axes.
struct Stretch {
  Vector3d factors = Vector3d::Ones();
  Vector3d offset = Vector3d::Zero();

  Vector3d operator()(const Vector3d& place) const { return factors.cwiseProduct(place) + offset; }
  Vector3d Back(const Vector3d& place) const { return (place - offset).cwiseQuotient(factors); }
};

Stretch StretchInto(const Eigen::AlignedBox3d& from, const Eigen::AlignedBox3d& to) {
  constexpr double kMost = 8;
  Stretch stretch;
  const double flat = 1e-6 * to.diagonal().norm();
  for (int axis = 0; axis < 3; ++axis) {
    const double factor =
        (to.sizes()[axis] + flat) / (from.sizes()[axis] + 1e-6 * from.diagonal().norm());
    stretch.factors[axis] = std::clamp(factor, 1 / kMost, kMost);
  }
  stretch.offset = to.center() - stretch.factors.cwiseProduct(from.center());
  return stretch;
}

// Sums of least squares.
class NormalEquations {
 public:
  explicit NormalEquations(Index unknowns)
      : square_(MatrixXd::Zero(unknowns, unknowns)), right_(VectorXd::Zero(unknowns)) {}

  void Add(double weight, const VectorXd& row, double residual) {
    square_.selfadjointView<Eigen::Lower>().rankUpdate(row, weight);
    right_ -= weight * residual * row;
  }

  const MatrixXd& square() const { return square_; }  // the lower half
  const VectorXd& right() const { return right_; }

 private:
  MatrixXd square_;
  VectorXd right_;
};

// The unknowns: parameters, the turn, the translation, and the logarithm of the scale if it is
// free.
class Linearization {
 public:
  Linearization(const FamilyMember& member, const Placement& placement, bool scale_is_free)
      : member_(member),
        surface_(member.At(placement.q)),
        rotation_(placement.pose.Rotation()),
        pose_(placement.pose),
        scale_is_free_(scale_is_free),
        count_(placement.q.size()),
        row_(count_ + (scale_is_free ? 5 : 4)) {}

  const mesh::SurfaceMesh& surface() const { return surface_; }
  Index unknowns() const { return row_.size(); }

  // The offset along the normal of a query's point from where it belongs on a triangle, as a sum's
  // part.
  void Add(const Vector3d& query_place, const Eigen::Vector3i& corners, const Vector3d& barycentric,
           const Vector3d& normal, double weight, double reach, NormalEquations* sums) {
    const Vector3d turned = pose_.scale * (rotation_ * query_place);
    const Vector3d foot = surface_.vertices(Eigen::all, corners) * barycentric;
    double residual = normal.dot(turned + pose_.translation - foot);
    for (Index k = 0; k < count_; ++k) {
      const Matrix3Xd& velocity = member_.velocities[static_cast<std::size_t>(k)];
      row_[k] = -normal.dot(velocity(Eigen::all, corners) * barycentric);
    }
    row_[count_] = normal.y() * turned.x() - normal.x() * turned.y();
    row_.segment<3>(count_ + 1) = normal;
    if (scale_is_free_) {
      // Offsets count in the query's unit, or else the smallest design would be the nearest.
      row_[count_ + 4] = normal.dot(turned) - residual;
      row_ /= pose_.scale;
      residual /= pose_.scale;
      reach /= pose_.scale;
    }
    const double square = reach * reach / (reach * reach + residual * residual);
    sums->Add(weight * square * square, row_, residual);
  }

 private:
  const FamilyMember& member_;
  const mesh::SurfaceMesh surface_;
  const Eigen::Matrix3d rotation_;
  const UprightPose pose_;
  const bool scale_is_free_;
  const Index count_;
  VectorXd row_;
};

// The parameters' constraints as those of all unknowns.
LinearConstraints OfAllUnknowns(const LinearConstraints& constraints, Index unknowns) {
  LinearConstraints all{MatrixXd::Zero(constraints.normals.rows(), unknowns), constraints.bounds};
  all.normals.leftCols(constraints.normals.cols()) = constraints.normals;
  return all;
}

// The damped sum of squares at its least, and what changes that.
class DampedSum {
 public:
  DampedSum(const NormalEquations& sums, const VectorXd& extents, double damping)
      : extents_(extents), right_(sums.right()) {
    MatrixXd square = sums.square().selfadjointView<Eigen::Lower>();
    const double largest = square.diagonal().cwiseProduct(extents.cwiseAbs2()).maxCoeff();
    is_empty_ = !(largest > 0);
    if (is_empty_) return;
    square.diagonal() += std::max(damping, 1e-10) * largest * extents.cwiseAbs2().cwiseInverse();
    factor_.compute(square);
  }

  // The change that makes it least within the constraints.
  absl::StatusOr<VectorXd> Change(const LinearConstraints& constraints, const VectorXd& at) const {
    if (is_empty_) return VectorXd(VectorXd::Zero(at.size()));
    const MatrixXd root = factor_.matrixU();
    const VectorXd move = factor_.matrixL().solve(right_);
    return ConstrainedStep(constraints, at, root, extents_, move);
  }

  // Standard deviations of the unknowns for each unit of that of a single offset.
  VectorXd Deviations() const {
    if (is_empty_) return VectorXd::Zero(right_.size());
    const auto count = right_.size();
    return factor_.solve(MatrixXd::Identity(count, count)).diagonal().cwiseMax(0).cwiseSqrt();
  }

 private:
  const VectorXd extents_;
  const VectorXd right_;
  bool is_empty_ = false;
  Eigen::LLT<MatrixXd> factor_;
};

// The design as it is at a placement, and the query beside it.
struct Scene {
  Scene(const QueryPoints& query, const mesh::SurfaceMesh& of, const UprightPose& pose_in,
        const AlignmentOptions& options, const AlignmentStep& step)
      : surface(of),
        pose(pose_in),
        samples(SampleSurface(of, options.design_points)),
        places(samples.PlacesOn(of)),
        normals(samples.NormalsOn(of)),
        seen(pose.ToDesign(query.places)),
        smoothed(pose.ToDesign(query.smoothed)),
        facing(pose.Rotation() * query.normals),
        alike(step.alike),
        beside(step.stretched ? std::numeric_limits<double>::infinity() : kBesides * step.reach) {
    if (step.stretched) stretch = StretchInto(BoxAround(smoothed), BoxAround(places));
  }

  const mesh::SurfaceMesh& surface;
  const UprightPose pose;
  const MeshPoints samples;         // of the design
  const Matrix3Xd places, normals;  // theirs
  const Matrix3Xd seen, smoothed;   // of the query, in the design's frame
  const Matrix3Xd facing;           // normals of the query there
  const double alike;               // cosine
  const double beside;              // m, that two may lie beside each other
  Stretch stretch;                  // of the query for finding what belongs together
};

bool FaceAlike(const Vector3d& a, const Vector3d& b, bool sided, double alike) {
  const double cosine = a.dot(b);
  return (sided ? cosine : std::abs(cosine)) >= alike;
}

// From each point of the query to the triangle of the design where it belongs.
void AddFromQuery(const QueryPoints& query, const Scene& scene, double reach, Linearization* linear,
                  NormalEquations* sums) {
  const OrientedPoints design(scene.places, scene.normals,
                              kNormalLength * scene.pose.scale * query.diagonal);
  const double weight = 1 / static_cast<double>(query.size());
  for (Index i = 0; i < query.size(); ++i) {
    const Vector3d place = scene.stretch(scene.smoothed.col(i)), normal = scene.facing.col(i);
    const bool sided = query.sided[static_cast<std::size_t>(i)];
    const Index found =
        (sided ? design.Find(place, normal) : design.FindEitherWay(place, normal)).index;
    if (!FaceAlike(normal, scene.normals.col(found), sided, scene.alike)) continue;
    const Eigen::Vector3i corners = scene.surface.triangles.col(scene.samples.triangles[found]);
    const Eigen::Matrix3d triangle = scene.surface.vertices(Eigen::all, corners);
    const Vector3d where = BarycentricOf(triangle, scene.seen.col(i));
    if ((triangle * where - scene.seen.col(i)).norm() > scene.beside) continue;
    linear->Add(query.places.col(i), corners, where, scene.normals.col(found), weight, reach, sums);
  }
}

// From points of the design to those of the query that belong there, with `part` of the weight.
void AddFromDesign(const QuerySearch& search, const Scene& scene, double part, Index count,
                   double reach, Linearization* linear, NormalEquations* sums) {
  const QueryPoints& query = search.points();
  const Eigen::Matrix3d back = scene.pose.Rotation().transpose();
  const double weight = part / static_cast<double>(count);
  for (Index j = 0; j < std::min(count, scene.samples.size()); ++j) {
    const Vector3d normal = scene.normals.col(j);
    if (normal.isZero()) continue;
    const Vector3d place = scene.pose.ToQuery(scene.stretch.Back(scene.places.col(j)));
    const Index found = search.Find(place, back * normal);
    const bool sided = query.sided[static_cast<std::size_t>(found)];
    if (!FaceAlike(normal, scene.facing.col(found), sided, scene.alike)) continue;
    if ((scene.smoothed.col(found) - scene.places.col(j)).norm() > scene.beside) continue;
    linear->Add(query.places.col(found), scene.surface.triangles.col(scene.samples.triangles[j]),
                scene.samples.barycentric.col(j), normal, weight, reach, sums);
  }
}

}  // namespace

QuerySearch::QuerySearch(QueryPoints points) : points_(std::move(points)) {
  const Index count = points_.size();
  for (Index i = 0; i < count; ++i) numbers_.push_back(i);
  for (Index i = 0; i < count; ++i) {
    if (!points_.sided[static_cast<std::size_t>(i)]) numbers_.push_back(i);
  }
  Matrix3Xd places = points_.smoothed(Eigen::all, numbers_);
  Matrix3Xd normals = points_.normals(Eigen::all, numbers_);
  normals.rightCols(normals.cols() - count) *= -1;
  tree_.emplace(places, normals, kNormalLength * points_.diagonal);
}

Index QuerySearch::Find(const Vector3d& place, const Vector3d& normal) const {
  return numbers_[static_cast<std::size_t>(tree_->Find(place, normal).index)];
}

VectorXd UnknownsOf(const Placement& placement) {
  VectorXd unknowns(placement.q.size() + 5);
  unknowns << placement.q, placement.pose.turn, placement.pose.translation,
      std::log(placement.pose.scale);
  return unknowns;
}

absl::StatusOr<AlignmentChange> Alignment::Step(const AlignmentStep& step,
                                                const LinearConstraints& constraints,
                                                const VectorXd& ranges,
                                                Placement* placement) const {
  const QueryPoints& query = query_.points();
  Linearization linear(member_, *placement, options_.scale_is_free);
  const Scene scene(query, linear.surface(), placement->pose, options_, step);
  NormalEquations sums(linear.unknowns());
  AddFromQuery(query, scene, step.reach, &linear, &sums);
  AddFromDesign(query_, scene, options_.part_of_design, options_.design_points, step.reach, &linear,
                &sums);

  const Index count = placement->q.size();
  VectorXd extents = VectorXd::Ones(linear.unknowns());
  extents.head(count) = ranges;
  extents.segment<3>(count + 1).setConstant(placement->pose.scale * query.diagonal);
  VectorXd at = VectorXd::Zero(linear.unknowns());
  at.head(count) = placement->q;
  const DampedSum sum(sums, extents, step.damping);
  MORTISE_ASSIGN_OR_RETURN(const VectorXd change,
                           sum.Change(OfAllUnknowns(constraints, linear.unknowns()), at));
  placement->q += change.head(count);
  placement->pose.turn += change[count];
  placement->pose.translation += change.segment<3>(count + 1);
  if (options_.scale_is_free) placement->pose.scale *= std::exp(change[count + 4]);
  // Each of N points has a weight of 1/N.
  const double of_noise = query.noise / std::sqrt(static_cast<double>(query.size()));
  AlignmentChange done{.largest = change.cwiseQuotient(extents).cwiseAbs().maxCoeff(),
                       .deviations = VectorXd::Zero(count + 5)};
  done.deviations.head(linear.unknowns()) = of_noise * sum.Deviations();
  return done;
}

}  // namespace mortise::retrieval
