// Proposals and results: the step of Algorithm 2, and what becomes of an answer.
#include "services/pareto/discovery/discovery.h"

#include <algorithm>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/pareto/archive/stochastic_sampling.h"

namespace mortise::pareto {
namespace {

constexpr std::int64_t kNoTrack = -1;

}  // namespace

const char* StopReasonName(AskTell::StopReason reason) {
  switch (reason) {
    case Discovery::StopReason::kRunning:
      return "RUNNING";
    case Discovery::StopReason::kBudget:
      return "BUDGET";
    case Discovery::StopReason::kConverged:
      return "CONVERGED";
    case Discovery::StopReason::kCancelled:
      return "CANCELLED";
    case Discovery::StopReason::kEvaluatorLost:
      return "EVALUATOR_LOST";
  }
  return "RUNNING";
}

absl::StatusOr<std::unique_ptr<Discovery>> Discovery::Create(const DesignSpace& space,
                                                             Eigen::Index metric_count,
                                                             const Options& options) {
  MORTISE_RETURN_IF_ERROR(Validate(space));
  MORTISE_RETURN_IF_ERROR(Validate(options, space, metric_count));
  return absl::WrapUnique(new Discovery(space, metric_count, options));
}

Discovery::Discovery(const DesignSpace& space, Eigen::Index metric_count, const Options& options)
    : box_(space),
      metric_count_(metric_count),
      options_(options),
      policy_(options, box_.size(), metric_count),
      window_(options.evaluations, options.window,
              {space.size(), metric_count, options.constraints}),
      buffer_(BufferOptions(options, metric_count), metric_count),
      scheduler_(policy_.Scheduling(), options.seed),
      population_(policy_.PopulationSize()),
      surrogate_({}, box_.box(), options.seed ^ 0x57a7eULL),
      turns_(box_.size(), policy_.FixedSurrogateShare()),
      evolution_(options.seed ^ 0xe501ULL),
      finishing_(policy_.Finishing()),
      random_(options.seed ^ 0x5eedULL),
      initial_samples_(policy_.InitialSamples()) {
  space_filling_ = LatinHypercube(initial_samples_ - given(), box_.size(), random_);
}

std::optional<Discovery::Proposal> Discovery::Ask() {
  if (Finished()) return std::nullopt;
  const std::int64_t number = window_.proposed();
  if (window_.left() <= 0) {
    if (CommitUpTo(number) && !Finished()) {
      Stop(StopReason::kBudget, absl::StrCat("all ", number, " evaluations were made"));
    }
    return std::nullopt;
  }
  if (number == initial_samples_) window_.AwaitAll();
  if (!CommitUpTo(window_.needed()) || Finished()) return std::nullopt;
  if (options_.uses_all_told) CommitUpTo(number);
  if (Finished()) return std::nullopt;

  const std::optional<TrackPool::Request> request = Step();
  if (Finished()) return std::nullopt;
  if (!request) {
    // Nothing to ask now. What is under way may open new ways; if nothing is, there are none.
    if (window_.committed() == number) {
      Stop(StopReason::kConverged, "every design that the method would try has been evaluated");
      return std::nullopt;
    }
    idle_ += window_.room();
    window_.AwaitAll();
    return Ask();
  }
  // Designs that were given are asked for bit for bit: the evaluator may know them.
  Proposal proposal{number, number < given() ? Eigen::VectorXd(options_.initial_designs.col(number))
                                             : box_.DesignAt(request->u)};
  const bool is_surrogates = request->track == surrogate_track_;
  if (number >= initial_samples_) turns_.Propose(is_surrogates, surrogate_.quality());
  window_.Propose(proposal.x, {box_.UnitOf(proposal.x), request->track, is_surrogates});
  return proposal;
}

absl::Status Discovery::Tell(std::int64_t number, Evaluation evaluation) {
  return window_.Tell(number, std::move(evaluation));
}

absl::Status Discovery::Learn(const Evaluation& evaluation) {
  if (evaluation.x.size() != space().size()) {
    return InvalidField("x", absl::StrCat("must have ", space().size(), " parameters"));
  }
  MORTISE_RETURN_IF_ERROR(
      CheckAnswer(evaluation, space().size(), metric_count_, options_.constraints));
  if (window_.proposed() == 0) initial_samples_ = std::max(given(), initial_samples_ - 1);
  const std::size_t entry = Admit(box_.UnitOf(evaluation.x), evaluation.x, evaluation).entry;
  if (archive_[entry].evaluated && !archive_[entry].feasible) ++learnt_violating_;
  return absl::OkStatus();
}

bool Discovery::CommitUpTo(std::int64_t count) {
  return window_.CommitUpTo(count, [this](std::int64_t number, const Window::Proposed& proposed) {
    Commit(number, proposed);
    return !Finished();
  });
}

void Discovery::Commit(std::int64_t number, const Window::Proposed& proposed) {
  const Evaluation& result = *proposed.result;
  if (!IsUsable(result)) {
    ++failed_;
    failures_.Add(FailureOf(result));
    if (message_.empty()) message_ = result.message;
  }
  const Admitted admitted = Admit(proposed.origin.u, proposed.x, result);
  tracks_.Credit(proposed.origin.track, admitted.gain);
  if (number >= initial_samples_) turns_.Count(proposed.origin.is_surrogates, admitted.gain);
  if (tracks_.Answer(archive_, number, admitted.entry)) RetireFinished();
}

ArchiveEntry Discovery::EntryOf(const Eigen::VectorXd& u, const Evaluation& result) const {
  ArchiveEntry entry;
  entry.u = u;
  entry.evaluated = IsUsable(result);
  if (!entry.evaluated) return entry;
  entry.metrics = result.metrics;
  entry.constraints = result.constraints;
  entry.jacobian = box_.UnitJacobian(result.jacobian);
  entry.constraint_jacobian = box_.UnitJacobian(result.constraint_jacobian);
  return entry;
}

// Takes a result into the archive and all that goes by it.
Discovery::Admitted Discovery::Admit(const Eigen::VectorXd& u, const Eigen::VectorXd& x,
                                     const Evaluation& result) {
  const std::size_t entry = archive_.Add(EntryOf(u, result));
  if (x != box_.DesignAt(u)) designs_.emplace(entry, x);
  deviations_.push_back(result.deviations);
  if (archive_[entry].feasible) population_.Offer(archive_, entry);
  evaluated_.Add(archive_, entry);
  return {entry, Absorb(entry)};
}

// Puts an entry into the buffer; returns the hypervolume gained over what was not dominated before,
// in the scaling that holds afterwards.
double Discovery::Absorb(std::size_t entry) {
  if (!archive_[entry].feasible) return 0;
  const Scaling scaling = archive_.CurrentScaling();
  const bool is_trade_off = archive_.non_dominated().back() == entry;
  if (buffer_.NeedsRebuild(scaling)) {
    buffer_.Rebuild(archive_, scaling);
    hypervolume_ =
        DominatedVolume(archive_, scaling, kRunningReference, HypervolumeSamples::kRunning);
    progress_mark_ = 0;  // another scale: progress is counted anew
    tracks_since_progress_ = 0;
    return is_trade_off ? GainedVolume(archive_, buffer_.scaling(), entry) : 0;
  }
  buffer_.Insert(entry, buffer_.scaling().Apply(archive_[entry].metrics));
  if (!is_trade_off) return 0;
  const double gain = GainedVolume(archive_, buffer_.scaling(), entry);
  hypervolume_ += gain;
  return gain;
}

// Makes one step of Algorithm 2: the next design of the samples that fill the space; after these,
// of the local optimisations and first-order expansions under way; where none of them has one, of
// an optimisation that begins at a sample of the buffer. Gives none while answers are needed first,
// and when no way is left.
std::optional<TrackPool::Request> Discovery::Step() {
  if (window_.proposed() < initial_samples_ || archive_.evaluated_count() == 0) {
    return InitialDesign();
  }
  if (archive_.feasible_count() == 0) return RestoreConstraints();
  if (SurrogateIsDue() && !PolishesOnly()) {
    if (std::optional<TrackPool::Request> request = AskSurrogate()) return request;
  }
  if (policy_.Explores()) StartFinishing();
  for (int barren = 0; barren < SearchPolicy::kExhaustedTracks; ++barren) {
    const std::int64_t started = tracks_.started();
    const bool polishes = barren < SearchPolicy::kBarrenTracks && PolishesOnly();
    std::optional<TrackPool::Request> request = AskTracks(polishes);
    if (request || Finished()) return request;
    if (tracks_.started() != started) continue;  // an expansion has begun
    if (AwaitsOpening() && !window_.under_way().empty()) {
      return turns_.IsFixed() && UsesSurrogate() ? AskSurrogate() : std::nullopt;
    }
    // What is polished next depends on what came of this.
    if (polishes && tracks_.IsFinishing()) return std::nullopt;
    StartTrack(barren >= SearchPolicy::kBarrenTracks, polishes);
  }
  return std::nullopt;
}

// Gives the designs that were given, then those of the Latin hypercube; designs uniformly at random
// while nothing feasible has been found.
TrackPool::Request Discovery::InitialDesign() {
  const std::int64_t number = window_.proposed();
  if (number < given()) return {kNoTrack, box_.UnitOf(options_.initial_designs.col(number))};
  if (number < initial_samples_) {
    return {kNoTrack, space_filling_[static_cast<std::size_t>(number - given())]};
  }
  Eigen::VectorXd u(box_.size());
  for (double& value : u) value = random_.Uniform();
  return {kNoTrack, u};
}

// Leads designs to where they meet the constraints, which none does yet.
std::optional<TrackPool::Request> Discovery::RestoreConstraints() {
  do {
    std::optional<TrackPool::Request> request = AskTracks(false);
    if (request || Finished()) return request;
  } while (StartRestoration());
  return tracks_.empty() ? std::optional(InitialDesign()) : std::nullopt;
}

// Asks the tracks, the oldest first, for a design that has not been evaluated before.
std::optional<TrackPool::Request> Discovery::AskTracks(bool only_polishes) {
  std::optional<TrackPool::Request> request = tracks_.Ask(
      archive_, window_.proposed(), [this](const auto& u) { return Find(u); }, only_polishes);
  if (!request) RetireFinished();
  return request;
}

// Tells what is known of the design that can be set at `u`.
TrackPool::KnownDesign Discovery::Find(const Eigen::VectorXd& u) const {
  const Eigen::VectorXd possible = box_.UnitOf(box_.DesignAt(u));
  if (const std::optional<std::size_t> entry = evaluated_.Find(archive_, possible)) {
    return {.entry = entry};
  }
  const auto at = std::ranges::find_if(
      window_.under_way(), [&](const auto& each) { return each.second.origin.u == possible; });
  if (at == window_.under_way().end()) return {};
  return {.number = at->first};
}

void Discovery::Stop(StopReason reason, std::string message) {
  if (Finished()) return;
  CommitUpTo(window_.proposed());
  stop_ = reason;
  shown_.Forget();  // to be measured once more, as well as may be
  message_ = std::move(message);
  if (archive_.feasible_count() > 0) buffer_.Rebuild(archive_, archive_.CurrentScaling());
}

Discovery::Summary Discovery::summary() const {
  Summary summary;
  summary.stop_reason = stop_;
  summary.message = message_;
  summary.evaluations = window_.committed();
  summary.failed = failed_;
  summary.violating =
      static_cast<std::int64_t>(archive_.evaluated_count() - archive_.feasible_count()) -
      learnt_violating_;
  summary.failures = failures_.failures();
  summary.optimizations = optimizations_;
  summary.expansions = expansions_;
  summary.pieces = std::ssize(pieces_);
  summary.cells_covered = static_cast<std::int64_t>(buffer_.cells().size());
  summary.surrogate = surrogate_.quality();
  summary.hypervolume = shown_.At(archive_, window_.committed(), Finished());
  return summary;
}

Front Discovery::front() const {
  Front front = BuildFront(box_.box(), archive_, buffer_, pieces_);
  for (FrontPoint& point : front.points) {
    const auto exact = designs_.find(point.entry);
    point.x = exact == designs_.end() ? box_.DesignAt(archive_[point.entry].u) : exact->second;
    point.deviations = deviations_[point.entry];
  }
  for (FrontPiece& piece : front.pieces) box_.AddHeldParameters(piece);
  return front;
}

}  // namespace mortise::pareto
