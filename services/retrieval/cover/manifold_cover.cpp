// Rejection sampling of several kinds of cover at once, on the same samples.
#include "services/retrieval/cover/manifold_cover.h"

#include <algorithm>
#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/random.h"
#include "services/retrieval/cover/cover_set.h"
#include "services/retrieval/cover/differences.h"
#include "services/retrieval/cover/parallel_evaluator.h"
#include "services/retrieval/cover/tangent_fit.h"
#include "services/retrieval/cover/tangent_frame.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kBatch = 128;  // samples that are drawn and evaluated together

// A sample that could be evaluated.
struct Sample {
  VectorXd parameters;
  VectorXd value;
  int structure = 0;
  std::uint64_t seed = 0;
};

// One of the covers that race.
struct Contender {
  CoverKind kind = CoverKind::kMixed;
  CoverSet set = {};
  int rejections = 0;  // in a row
  bool running = true;
  bool covered = false;
};

absl::Status Check(const CoverOptions& options) {
  if (!(options.delta > 0)) return InvalidField("delta", "must be more than 0");
  if (options.rejections < 1) return InvalidField("rejections", "must be at least 1");
  if (options.threads < 1) return InvalidField("threads", "must be at least 1");
  if (options.most_primitives < 1) return InvalidField("most_primitives", "must be at least 1");
  if (options.most_evaluations < 1) return InvalidField("most_evaluations", "must be at least 1");
  return absl::OkStatus();
}

// Makes the primitives at one sample for all contenders, which share its derivatives.
class PrimitiveMaker {
 public:
  PrimitiveMaker(ParallelEvaluator& evaluator, const VectorXd& extents, double delta,
                 const Sample& sample)
      : evaluator_(evaluator), extents_(extents), delta_(delta), sample_(sample) {}

  // A point where no tangent pays, or none can be made: without derivatives, because a neighbour
  // cannot be evaluated, or because rounding spoils a programme of its radii.
  Primitive Make(CoverKind kind) {
    if (kind == CoverKind::kPoints || !HasFrame()) return Point();
    const Index axes = kind == CoverKind::kTangents
                           ? frame_->rank()
                           : AxesThatPay(frame_->predicted_radii(), delta_);
    if (axes == 0) return Point();
    absl::StatusOr<Primitive> primitive = TangentWith(axes);
    if (!primitive.ok()) return Point();
    if (kind == CoverKind::kMixed) KeepAxes(AxesThatPay(primitive->radii, delta_), &*primitive);
    return *std::move(primitive);
  }

 private:
  Primitive Point() const {
    return {.parameters = sample_.parameters,
            .center = sample_.value,
            .axes = Eigen::MatrixXd(sample_.value.size(), 0),
            .radii = VectorXd(0),
            .structure = sample_.structure};
  }

  bool HasFrame() {
    if (tried_) return frame_.has_value();
    tried_ = true;
    if (extents_.size() == 0) return false;
    const Manifold& manifold = evaluator_.manifold();
    const auto derivatives = manifold.OffersDerivatives()
                                 ? manifold.DerivativesAt(sample_.parameters)
                                 : CentralDifferences(evaluator_, sample_.parameters, sample_.value,
                                                      DifferenceSteps(extents_, manifold.noise()));
    if (manifold.OffersDerivatives() && derivatives.ok()) {
      evaluator_.CountOthers(derivatives->evaluations);
    }
    if (!derivatives.ok() || !derivatives->first.allFinite() || !derivatives->second.allFinite()) {
      return false;
    }
    const double error = manifold.OffersDerivatives() ? 0 : DerivativeError(manifold.noise());
    frame_.emplace(manifold.constraints(), sample_.parameters, *derivatives, extents_, delta_,
                   error);
    return true;
  }

  absl::StatusOr<Primitive> TangentWith(Index axes) {
    if (tangent_ && tangent_->axes.cols() == axes) return *tangent_;
    const TangentSite site{.parameters = sample_.parameters,
                           .value = sample_.value,
                           .structure = sample_.structure,
                           .delta = delta_,
                           .seed = sample_.seed};
    MORTISE_ASSIGN_OR_RETURN(tangent_, FitTangent(evaluator_, *frame_, axes, site));
    return *tangent_;
  }

  ParallelEvaluator& evaluator_;
  const VectorXd& extents_;
  double delta_;
  const Sample& sample_;
  bool tried_ = false;
  std::optional<TangentFrame> frame_;
  std::optional<Primitive> tangent_;
};

class Race {
 public:
  Race(const Manifold& manifold, CoverOptions options, VectorXd extents)
      : options_(std::move(options)),
        extents_(std::move(extents)),
        evaluator_(manifold, options_.threads),
        random_(options_.seed) {
    contenders_.push_back({.kind = options_.kind});
    if (options_.kind != CoverKind::kMixed || !options_.race) return;
    contenders_.push_back({.kind = CoverKind::kPoints});
    contenders_.push_back({.kind = CoverKind::kTangents});
  }

  absl::StatusOr<Cover> Run() {
    while (AnyRuns() && !AtLimit()) {
      MORTISE_RETURN_IF_ERROR(CheckStop());
      MORTISE_ASSIGN_OR_RETURN(const std::vector<Sample> batch, NextBatch());
      if (succeeded_ == 0 && samples_ >= options_.rejections) {
        return PreconditionFailed(
            "NOTHING_EVALUATED",
            absl::StrCat("none of ", samples_, " designs could be evaluated: ",
                         evaluator_.messages().empty() ? "" : evaluator_.messages().front()));
      }
      MORTISE_RETURN_IF_ERROR(Commit(batch));
      if (options_.progress) {
        options_.progress({evaluator_.evaluations(),
                           static_cast<int>(contenders_.front().set.size()),
                           contenders_.front().rejections});
      }
    }
    return Result();
  }

 private:
  bool AnyRuns() const {
    return std::any_of(contenders_.begin(), contenders_.end(),
                       [](const Contender& each) { return each.running; });
  }

  absl::Status CheckStop() const {
    if (!options_.stop.stop_requested()) return absl::OkStatus();
    return absl::CancelledError("the cover was cancelled");
  }

  bool AtLimit() const { return evaluator_.evaluations() >= options_.most_evaluations; }

  absl::StatusOr<std::vector<Sample>> NextBatch() {
    const std::uint64_t seed = random_.Next();
    MORTISE_ASSIGN_OR_RETURN(const std::vector<VectorXd> points,
                             evaluator_.manifold().Sample(kBatch, seed));
    const auto values = evaluator_.Evaluate(points);
    samples_ += static_cast<long>(points.size());
    std::vector<Sample> batch;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (!values[i].ok()) continue;
      const int structure = evaluator_.manifold().Structure(points[i]);
      batch.push_back({points[i], *values[i], structure, seed + i});
    }
    succeeded_ += static_cast<long>(batch.size());
    return batch;
  }

  // Which samples a contender covers already.
  std::vector<char> CoveredBy(const Contender& contender, const std::vector<Sample>& batch) const {
    std::vector<char> covered(batch.size());
    ParallelFor(static_cast<int>(batch.size()), options_.threads, [&](int i) {
      const Sample& sample = batch[static_cast<std::size_t>(i)];
      covered[static_cast<std::size_t>(i)] =
          contender.set.Covers(sample.value, sample.structure, options_.delta);
    });
    return covered;
  }

  // Offers the samples of a batch to all contenders, in order.
  absl::Status Commit(const std::vector<Sample>& batch) {
    std::vector<std::vector<char>> covered(contenders_.size());
    std::vector<std::size_t> sizes;
    for (std::size_t c = 0; c < contenders_.size(); ++c) {
      if (contenders_[c].running) covered[c] = CoveredBy(contenders_[c], batch);
      sizes.push_back(contenders_[c].set.size());
    }
    for (std::size_t i = 0; i < batch.size() && AnyRuns(); ++i) {
      if (i > 0 && AtLimit()) break;
      MORTISE_RETURN_IF_ERROR(CheckStop());
      PrimitiveMaker maker(evaluator_, extents_, options_.delta, batch[i]);
      for (std::size_t c = 0; c < contenders_.size(); ++c) {
        Contender& contender = contenders_[c];
        if (!contender.running) continue;
        if (covered[c][i] ||
            contender.set.Covers(batch[i].value, batch[i].structure, options_.delta, sizes[c])) {
          Reject(&contender);
          continue;
        }
        contender.rejections = 0;
        contender.set.Add(maker.Make(contender.kind));
        const bool full =
            contender.set.size() >= static_cast<std::size_t>(options_.most_primitives);
        if (full || (best_ && contender.set.cost() >= *best_)) contender.running = false;
      }
    }
    return absl::OkStatus();
  }

  void Reject(Contender* contender) {
    if (++contender->rejections < options_.rejections) return;
    contender->running = false;
    contender->covered = true;
    best_ = std::min(best_.value_or(contender->set.cost()), contender->set.cost());
    for (Contender& other : contenders_) {
      if (!other.covered && other.set.cost() >= *best_) other.running = false;
    }
  }

  Cover Result() const {
    const Contender* winner = nullptr;
    for (const Contender& each : contenders_) {
      if (each.covered && (!winner || each.set.cost() < winner->set.cost())) winner = &each;
    }
    Cover cover;
    if (!winner) {
      winner = &contenders_.front();
      cover.end = AtLimit() ? CoverEnd::kEvaluationLimit : CoverEnd::kPrimitiveLimit;
    }
    cover.primitives = winner->set.primitives();
    cover.kind = winner->kind;
    cover.cost = winner->set.cost();
    cover.samples = samples_;
    cover.evaluations = evaluator_.evaluations();
    cover.failures = evaluator_.failures();
    cover.failure_messages = evaluator_.messages();
    return cover;
  }

  CoverOptions options_;
  VectorXd extents_;
  ParallelEvaluator evaluator_;
  Random random_;
  std::vector<Contender> contenders_;
  std::optional<long> best_;  // the least cost of a cover that is done
  long samples_ = 0;
  long succeeded_ = 0;
};

}  // namespace

absl::StatusOr<Cover> CoverManifold(const Manifold& manifold, const CoverOptions& options) {
  MORTISE_RETURN_IF_ERROR(Check(options));
  MORTISE_ASSIGN_OR_RETURN(VectorXd extents, ExtentsOf(manifold.constraints()));
  CoverOptions checked = options;
  if (extents.size() == 0 || extents.maxCoeff() == 0) checked.rejections = 1;  // one design
  Race race(manifold, std::move(checked), std::move(extents));
  return race.Run();
}

}  // namespace mortise::retrieval
