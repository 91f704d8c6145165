#include "services/retrieval/cover/interpolated_cover.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
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
constexpr std::size_t kMaxPoints = 1536;  // of a structure
constexpr long kMaxKnown = 4096;          // of all structures together
constexpr int kBatch = 64;
constexpr int kMaxBatchesALevel = 64;
constexpr double kMaxFailures = 0.02;
constexpr double kErrorPart = 0.2;      // of δ: of left-out errors, that are aimed at
constexpr double kMaxErrorPart = 0.5;   // of δ, that are taken where more points bring little
constexpr double kBringsLittle = 0.75;  // of the error that there was with half as many points
constexpr double kErrorQuantile = 0.95;
constexpr double kSmoothings[] = {0, 1e-3, 1e-2, 1e-1};  // of interpolants
constexpr Index kMaxSmoothed = 800;    // points: with more, each try takes longer than it is worth
constexpr double kLeftOutPart = 0.05;  // of δ: beyond the principal components
constexpr std::size_t kComponentPoints = 400;
constexpr double kSmallest = 1e-6;  // of the largest component: smaller ones are rounding
constexpr double kRarePart = 0.05;  // of the samples, that may have structures without interpolant
constexpr double kRounding = 1e-9;
constexpr double kTooNear = 0.1;            // of the distance of so many points in a row
constexpr long kMaxInterpolated = 400'000;  // evaluations of what interpolates
constexpr double kSurely = 3;               // standard deviations

// How many designs are made to interpolate between.
long MostKnown(const CoverOptions& options) {
  return std::min(kMaxKnown, options.most_evaluations);
}

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

  // Draws samples until each structure that has been seen has `count` points, but for those that
  // are interpolated well enough already, or many samples have been drawn.
  absl::Status DrawUpTo(std::size_t count, const std::set<int>& settled) {
    for (int batch = 0; batch < kMaxBatchesALevel; ++batch) {
      if (options_.stop.stop_requested()) return absl::CancelledError("the cover was cancelled");
      MORTISE_RETURN_IF_ERROR(DrawBatch(count, settled));
      const bool has_enough = std::all_of(points_.begin(), points_.end(), [&](const auto& each) {
        return each.second.size() >= count || settled.contains(each.first);
      });
      if (has_enough || TooManyFail() || evaluator_.evaluations() >= MostKnown(options_)) {
        break;
      }
    }
    return absl::OkStatus();
  }

  // Whether surely more fail than may.
  bool TooManyFail() const {
    const double expected = kMaxFailures * static_cast<double>(evaluator_.evaluations());
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
  absl::Status DrawBatch(std::size_t count, const std::set<int>& settled) {
    MORTISE_ASSIGN_OR_RETURN(std::vector<VectorXd> drawn,
                             manifold_.Sample(kBatch, options_.seed + ++batches_));
    if (middle_.size() == 0) {
      middle_ = VectorXd::Zero(extents_.size());
      for (const VectorXd& q : drawn) middle_ += q / static_cast<double>(drawn.size());
    }
    std::vector<VectorXd> wanted;
    std::map<int, std::vector<VectorXd>> places;  // of what is wanted, by structure
    for (std::size_t i = 0; i < drawn.size(); ++i) {
      if (i % 2 == 1) drawn[i] = ToBoundary(drawn[i]);
      const int structure = manifold_.Structure(drawn[i]);
      ++samples_;
      ++seen_[structure];
      if (points_[structure].size() >= count || settled.contains(structure)) continue;
      if (IsKnown(drawn[i], count, structure, places[structure])) continue;
      places[structure].push_back(Scaled(drawn[i]));
      wanted.push_back(std::move(drawn[i]));
    }
    const auto values = evaluator_.Evaluate(wanted);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      if (!values[i].ok()) continue;
      points_[manifold_.Structure(wanted[i])].push_back({wanted[i], *values[i]});
    }
    return absl::OkStatus();
  }

  // Whether a point of the same structure, or of those that are wanted besides, is so near that q
  // would tell next to nothing that it does not, and what interpolates both is nearly singular. Of
  // a single parameter many are: half of all points would lie at its ends.
  bool IsKnown(const VectorXd& q, std::size_t count, int structure,
               const std::vector<VectorXd>& wanted) const {
    const double nearest = kTooNear / static_cast<double>(count);
    const VectorXd place = Scaled(q);
    const auto found = points_.find(structure);
    return std::any_of(found->second.begin(), found->second.end(),
                       [&](const KnownPoint& known) {
                         return (Scaled(known.parameters) - place).norm() < nearest;
                       }) ||
           std::any_of(wanted.begin(), wanted.end(),
                       [&](const VectorXd& each) { return (each - place).norm() < nearest; });
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

// What interpolates a structure, and what 95 of 100 errors do not exceed.
struct Attempt {
  RadialInterpolant interpolant;
  double error = 0;
};

// The interpolant with the least error, of those that meet the points and, where these are not good
// enough, of smoother ones: of designs that are meshed anew, points have noise.
std::optional<Attempt> BestOf(const MatrixXd& nodes, const MatrixXd& values, double enough) {
  std::optional<Attempt> best;
  for (const double smoothing : kSmoothings) {
    if (smoothing > 0 && nodes.cols() > kMaxSmoothed) break;
    auto interpolant = RadialInterpolant::Fit(nodes, values, smoothing);
    if (!interpolant.ok()) continue;
    const VectorXd& left_out = interpolant->left_out_errors();
    std::vector<double> errors(left_out.begin(), left_out.end());
    std::sort(errors.begin(), errors.end());
    const double error = Quantile(errors, kErrorQuantile);
    if (!best || error < best->error) best = Attempt{*std::move(interpolant), error};
    if (best->error <= enough) break;
  }
  return best;
}

// What can be interpolated of each structure.
std::map<int, Attempt> Interpolate(const KnownPoints& known, const Subspace& space, double enough) {
  std::map<int, Attempt> attempts;
  for (const auto& [structure, points] : known.points()) {
    if (points.empty()) continue;
    MatrixXd nodes(points.front().parameters.size(), static_cast<Index>(points.size()));
    MatrixXd values(space.basis.cols(), nodes.cols());
    for (std::size_t i = 0; i < points.size(); ++i) {
      nodes.col(static_cast<Index>(i)) = known.Scaled(points[i].parameters);
      values.col(static_cast<Index>(i)) = space.Project(points[i].value);
    }
    if (auto best = BestOf(nodes, values, enough)) attempts.emplace(structure, *std::move(best));
  }
  return attempts;
}

// The least error with which all but rare structures are interpolated; infinity where they are not.
double ErrorOf(const KnownPoints& known, const std::map<int, Attempt>& attempts) {
  std::vector<std::pair<double, int>> ascending;
  for (const auto& [structure, attempt] : attempts) {
    ascending.emplace_back(attempt.error, structure);
  }
  std::sort(ascending.begin(), ascending.end());
  double part = 0;
  for (const auto& [structure, points] : known.points()) part += known.PartOf(structure);
  for (const auto& [error, structure] : ascending) {
    part -= known.PartOf(structure);
    if (part <= kRarePart + kRounding) return error;
  }
  return std::numeric_limits<double>::infinity();
}

Interpolants GoodOnes(std::map<int, Attempt> attempts, double most) {
  Interpolants interpolants;
  for (auto& [structure, attempt] : attempts) {
    if (attempt.error <= most) interpolants.emplace(structure, std::move(attempt.interpolant));
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

// `error`: of the interpolants, which the cover leaves room for.
absl::StatusOr<Cover> CoverInterpolated(const InterpolatedManifold& manifold,
                                        const KnownPoints& known, double part_without, double error,
                                        CoverOptions options) {
  const long left = std::max(1L, options.most_evaluations - known.evaluator().evaluations());
  options.delta -= error + kLeftOutPart * options.delta;
  options.most_evaluations = kMaxInterpolated;
  if (part_without > 0) {
    const double most = static_cast<double>(left) / part_without;
    options.most_evaluations = std::min(kMaxInterpolated, std::lround(most));
  }
  MORTISE_ASSIGN_OR_RETURN(Cover cover, CoverManifold(manifold, options));
  for (Primitive& primitive : cover.primitives) primitive = manifold.Lifted(std::move(primitive));
  cover.evaluations = manifold.others();
  cover.interpolation_error = error;
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
  const auto most = static_cast<std::size_t>(std::min<long>(kMaxPoints, options.most_evaluations));
  double before = std::numeric_limits<double>::infinity();
  std::set<int> settled;  // structures that need no more points
  for (std::size_t count = kFirstPoints; count <= most; count *= 2) {
    MORTISE_RETURN_IF_ERROR(known.DrawUpTo(count, settled));
    if (known.TooManyFail()) break;
    const auto space = LeadingComponents(known, kLeftOutPart * options.delta);
    if (!space) continue;
    std::map<int, Attempt> attempts = Interpolate(known, *space, kErrorPart * options.delta);
    const double error = ErrorOf(known, attempts);
    const bool is_last = 2 * count > most || known.evaluator().evaluations() >= MostKnown(options);
    const bool is_enough = is_last || error > kBringsLittle * before;
    before = error;
    const double taken = std::max(error, kErrorPart * options.delta);
    if (taken > (is_enough ? kMaxErrorPart : kErrorPart) * options.delta) {
      if (is_last) break;
      for (const auto& [structure, attempt] : attempts) {
        if (attempt.error <= kErrorPart * options.delta) settled.insert(structure);
      }
      continue;
    }
    Interpolants interpolants = GoodOnes(std::move(attempts), taken);
    const double part_without = PartWithout(known, interpolants);
    const InterpolatedManifold interpolated(manifold, known, *space, std::move(interpolants));
    MORTISE_ASSIGN_OR_RETURN(Cover cover,
                             CoverInterpolated(interpolated, known, part_without, taken, options));
    if (known.evaluator().failures() > 0) DropWhatFails(manifold, options.threads, &cover);
    return cover;
  }
  return CoverDirectly(manifold, known, options);
}

}  // namespace mortise::retrieval
