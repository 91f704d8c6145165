#include "services/retrieval/cover/interpolated_cover.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "services/retrieval/cover/cover_error.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/cover/radial_interpolant.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kFirstPoints = 96;
constexpr std::size_t kMostPoints = 1536;  // of a structure
constexpr int kBatch = 64;
constexpr int kMostBatchesALevel = 64;
constexpr double kMostFailures = 0.02;
constexpr double kErrorPart = 0.2;  // of δ: of left-out errors
constexpr double kErrorQuantile = 0.95;
constexpr double kLeftOutPart = 0.05;  // of δ: beyond the principal components
constexpr std::size_t kComponentPoints = 400;
constexpr double kSmallest = 1e-6;  // of the largest component: smaller ones are rounding
constexpr double kRarePart = 0.05;  // of the samples, that may have structures without interpolant
constexpr double kRounding = 1e-9;
constexpr long kMostInterpolated = 400'000;  // evaluations of what interpolates
constexpr double kSurely = 3;                // standard deviations

struct KnownPoint {
  VectorXd parameters;
  VectorXd value;
};

// Points of a manifold that are known, by structure, and how many there are of each.
class KnownPoints {
 public:
  KnownPoints(const Manifold& manifold, const CoverOptions& options, VectorXd extents)
      : manifold_(manifold),
        options_(options),
        extents_(std::move(extents)),
        evaluator_(manifold, options.threads) {}

  // Draws samples until each structure that has been seen has `count` points, or many samples have
  // been drawn.
  absl::Status DrawUpTo(std::size_t count) {
    for (int batch = 0; batch < kMostBatchesALevel; ++batch) {
      if (options_.stop.stop_requested()) return absl::CancelledError("the cover was cancelled");
      MORTISE_RETURN_IF_ERROR(DrawBatch(count));
      const bool has_enough = std::all_of(points_.begin(), points_.end(), [&](const auto& each) {
        return each.second.size() >= count;
      });
      if (has_enough || TooManyFail() || evaluator_.evaluations() >= options_.most_evaluations) {
        break;
      }
    }
    return absl::OkStatus();
  }

  // Whether surely more fail than may.
  bool TooManyFail() const {
    const double expected = kMostFailures * static_cast<double>(evaluator_.evaluations());
    return static_cast<double>(evaluator_.failures()) > expected + kSurely * std::sqrt(expected);
  }

  // The part of samples that have a structure.
  double PartOf(int structure) const {
    const auto found = seen_.find(structure);
    return found == seen_.end() ? 0 : static_cast<double>(found->second) / samples_;
  }

  // About unit extent along each parameter.
  VectorXd Scaled(const VectorXd& q) const {
    return (q - middle_)
        .cwiseQuotient((extents_.array() > 0).select(extents_, VectorXd::Ones(extents_.size())));
  }

  const std::map<int, std::vector<KnownPoint>>& points() const { return points_; }
  const ParallelEvaluator& evaluator() const { return evaluator_; }

 private:
  absl::Status DrawBatch(std::size_t count) {
    MORTISE_ASSIGN_OR_RETURN(std::vector<VectorXd> drawn,
                             manifold_.Sample(kBatch, options_.seed + ++batches_));
    if (middle_.size() == 0) {
      middle_ = VectorXd::Zero(extents_.size());
      for (const VectorXd& q : drawn) middle_ += q / static_cast<double>(drawn.size());
    }
    std::vector<VectorXd> wanted;
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      if (i % 2 == 1) drawn[i] = ToBoundary(drawn[i]);
      const int structure = manifold_.Structure(drawn[i]);
      ++samples_;
      ++seen_[structure];
      if (points_[structure].size() < count) wanted.push_back(std::move(drawn[i]));
    }
    const auto values = evaluator_.Evaluate(wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (!values[i].ok()) continue;
      points_[manifold_.Structure(wanted[i])].push_back({wanted[i], *values[i]});
    }
    return absl::OkStatus();
  }

  VectorXd ToBoundary(const VectorXd& q) const {
    const VectorXd ray = q - middle_;
    const double room = RoomAlong(manifold_.constraints(), middle_, ray);
    return std::isfinite(room) && room > 0 ? VectorXd(middle_ + (1 - kRounding) * room * ray) : q;
  }

  const Manifold& manifold_;
  const CoverOptions& options_;
  VectorXd extents_, middle_;
  ParallelEvaluator evaluator_;
  std::uint64_t batches_ = 0;
  double samples_ = 0;
  std::map<int, long> seen_;
  std::map<int, std::vector<KnownPoint>> points_;
};

// An affine subspace that vectors lie in, nearly.
struct Subspace {
  VectorXd middle;  // N
  MatrixXd basis;   // N × r, orthonormal

  VectorXd Project(const VectorXd& x) const { return basis.transpose() * (x - middle); }
  double Missed(const VectorXd& x) const { return (x - middle - basis * Project(x)).norm(); }
};

// Of the leading principal components of some points, as many as leave out no more than `most` of
// one in a hundred of all of them; nothing if there are not enough.
std::optional<Subspace> LeadingComponents(const KnownPoints& known, double most) {
  std::vector<const VectorXd*> all;
  for (const auto& [structure, points] : known.points()) {
    for (const KnownPoint& point : points) all.push_back(&point.value);
  }
  if (all.empty()) return std::nullopt;
  const std::size_t count = std::min(all.size(), kComponentPoints);
  MatrixXd some(all.front()->size(), static_cast<Index>(count));
  for (std::size_t i = 0; i < count; ++i) {
    some.col(static_cast<Index>(i)) = *all[i * all.size() / count];
  }
  Subspace space{some.rowwise().mean(), {}};
  some.colwise() -= space.middle;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(some.transpose() * some);
  const VectorXd sizes = solver.eigenvalues().cwiseMax(0).cwiseSqrt();  // ascending
  const Index most_rank = (sizes.array() > kSmallest * sizes.maxCoeff()).count();
  std::vector<double> missed;
  for (Index next = 1, rank = 0; rank < most_rank; next *= 2) {
    rank = std::min(next, most_rank);
    const VectorXd leading = sizes.tail(rank);
    space.basis =
        some * solver.eigenvectors().rightCols(rank) * leading.cwiseInverse().asDiagonal();
    missed.clear();
    for (const VectorXd* const value : all) missed.push_back(space.Missed(*value));
    std::sort(missed.begin(), missed.end());
    if (Quantile(missed, 0.99) <= most) return space;
  }
  return std::nullopt;
}

// The interpolant of each structure that has a good one.
using Interpolants = std::map<int, RadialInterpolant>;

Interpolants Interpolate(const KnownPoints& known, const Subspace& space, double most) {
  Interpolants interpolants;
  for (const auto& [structure, points] : known.points()) {
    if (points.empty()) continue;
    MatrixXd nodes(points.front().parameters.size(), static_cast<Index>(points.size()));
    MatrixXd values(space.basis.cols(), nodes.cols());
    for (std::size_t i = 0; i < points.size(); ++i) {
      nodes.col(static_cast<Index>(i)) = known.Scaled(points[i].parameters);
      values.col(static_cast<Index>(i)) = space.Project(points[i].value);
    }
    auto interpolant = RadialInterpolant::Fit(std::move(nodes), values);
    if (!interpolant.ok()) continue;
    const VectorXd& left_out = interpolant->left_out_errors();
    std::vector<double> errors(left_out.begin(), left_out.end());
    std::sort(errors.begin(), errors.end());
    if (Quantile(errors, kErrorQuantile) <= most) {
      interpolants.emplace(structure, *std::move(interpolant));
    }
  }
  return interpolants;
}

double PartWithout(const KnownPoints& known, const Interpolants& interpolants) {
  double part = 0;
  for (const auto& [structure, points] : known.points()) {
    if (!interpolants.contains(structure)) part += known.PartOf(structure);
  }
  return part;
}

// The interpolated manifold, in principal components.
class InterpolatedManifold : public Manifold {
 public:
  InterpolatedManifold(const Manifold& base, const KnownPoints& known, Subspace space,
                       Interpolants interpolants)
      : base_(base),
        known_(known),
        space_(std::move(space)),
        interpolants_(std::move(interpolants)) {}

  Index parameters() const override { return base_.parameters(); }
  Index dimension() const override { return space_.basis.cols(); }
  const LinearConstraints& constraints() const override { return base_.constraints(); }
  absl::StatusOr<std::vector<VectorXd>> Sample(int count, std::uint64_t seed) const override {
    return base_.Sample(count, seed);
  }
  absl::StatusOr<VectorXd> Evaluate(const VectorXd& q) const override {
    const auto found = interpolants_.find(base_.Structure(q));
    if (found != interpolants_.end()) return found->second.At(known_.Scaled(q));
    ++others_;
    MORTISE_ASSIGN_OR_RETURN(const VectorXd value, base_.Evaluate(q));
    return space_.Project(value);
  }
  int Structure(const VectorXd& q) const override { return base_.Structure(q); }
  double noise() const override { return kRounding; }

  // How many points of the manifold itself were evaluated, as they are not interpolated.
  long others() const { return others_; }

  Primitive Lifted(Primitive primitive) const {
    primitive.center = space_.middle + space_.basis * primitive.center;
    primitive.axes = space_.basis * primitive.axes;
    return primitive;
  }

 private:
  const Manifold& base_;
  const KnownPoints& known_;
  Subspace space_;
  Interpolants interpolants_;
  mutable std::atomic<long> others_ = 0;
};

// Adds what the points that are known took to the counts of a cover.
void CountKnown(const KnownPoints& known, Cover* cover) {
  cover->evaluations += known.evaluator().evaluations();
  cover->failures += known.evaluator().failures();
  if (cover->failure_messages.empty()) cover->failure_messages = known.evaluator().messages();
}

absl::StatusOr<Cover> CoverInterpolated(const InterpolatedManifold& manifold,
                                        const KnownPoints& known, double part_without,
                                        CoverOptions options) {
  const long left = std::max(1L, options.most_evaluations - known.evaluator().evaluations());
  options.delta *= 1 - kErrorPart - kLeftOutPart;
  options.most_evaluations = kMostInterpolated;
  if (part_without > 0) {
    const double most = static_cast<double>(left) / part_without;
    options.most_evaluations = std::min(kMostInterpolated, std::lround(most));
  }
  MORTISE_ASSIGN_OR_RETURN(Cover cover, CoverManifold(manifold, options));
  for (Primitive& primitive : cover.primitives) primitive = manifold.Lifted(std::move(primitive));
  cover.evaluations = manifold.others();
  CountKnown(known, &cover);
  return cover;
}

// Leaves out primitives whose own designs cannot be made, as what interpolates knows nothing of
// that.
void DropWhatFails(const Manifold& manifold, int threads, Cover* cover) {
  std::vector<VectorXd> centers;
  for (const Primitive& primitive : cover->primitives) centers.push_back(primitive.parameters);
  ParallelEvaluator evaluator(manifold, threads);
  const auto values = evaluator.Evaluate(centers);
  std::vector<Primitive> kept;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (values[i].ok()) kept.push_back(std::move(cover->primitives[i]));
  }
  cover->primitives = std::move(kept);
  cover->cost = 0;
  for (const Primitive& primitive : cover->primitives) cover->cost += Cost(primitive);
  cover->evaluations += evaluator.evaluations();
  cover->failures += evaluator.failures();
}

// Covers the manifold itself with what is left of the evaluations.
absl::StatusOr<Cover> CoverDirectly(const Manifold& manifold, const KnownPoints& known,
                                    CoverOptions options) {
  options.most_evaluations =
      std::max(1L, options.most_evaluations - known.evaluator().evaluations());
  MORTISE_ASSIGN_OR_RETURN(Cover cover, CoverManifold(manifold, options));
  CountKnown(known, &cover);
  return cover;
}

}  // namespace

absl::StatusOr<Cover> CoverByInterpolation(const Manifold& manifold, const CoverOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(VectorXd extents, ExtentsOf(manifold.constraints()));
  if (!(options.delta > 0) || extents.size() == 0 || extents.maxCoeff() == 0) {
    return CoverManifold(manifold, options);
  }
  KnownPoints known(manifold, options, std::move(extents));
  const auto most = static_cast<std::size_t>(std::min<long>(kMostPoints, options.most_evaluations));
  for (std::size_t count = kFirstPoints; count <= most; count *= 2) {
    MORTISE_RETURN_IF_ERROR(known.DrawUpTo(count));
    if (known.TooManyFail() || known.evaluator().evaluations() > options.most_evaluations) break;
    const auto space = LeadingComponents(known, kLeftOutPart * options.delta);
    if (!space) continue;
    Interpolants interpolants = Interpolate(known, *space, kErrorPart * options.delta);
    const double part_without = PartWithout(known, interpolants);
    if (part_without > kRarePart) continue;
    const InterpolatedManifold interpolated(manifold, known, *space, std::move(interpolants));
    MORTISE_ASSIGN_OR_RETURN(Cover cover,
                             CoverInterpolated(interpolated, known, part_without, options));
    if (known.evaluator().failures() > 0) DropWhatFails(manifold, options.threads, &cover);
    return cover;
  }
  return CoverDirectly(manifold, known, options);
}

}  // namespace mortise::retrieval
