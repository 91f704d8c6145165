// The window of proposals and results, and the life of tracks.
#include "services/pareto/discovery/discovery.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string_view>
#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/archive/stochastic_sampling.h"

namespace mortise::pareto {
namespace {

constexpr double kReference = 1.1;         // of the running hypervolume, in scaled performance
constexpr Eigen::Index kExactMetrics = 4;  // of gains; for more metrics they are bounds from above
constexpr std::size_t kMostOverlaps = 64;
constexpr int kRunningSamples = 1 << 12;  // of hypervolumes that progress is measured against
constexpr int kFinalSamples = 1 << 18;
constexpr std::int64_t kShownEvery = 16;  // a hypervolume is shown until there are that part more
constexpr double kMostCells = 2e9;        // so that their numbers fit 32 bits
constexpr std::int64_t kEvaluationsOfCell = 4;  // where the buffer adapts
constexpr int kBarrenTracks = 4;         // tracks without a new point before a sample is forced
constexpr int kExhaustedTracks = 200;    // and before the design space counts as exhausted
constexpr std::size_t kPopulation = 30;  // for each metric but one
constexpr int kChildren = 8;             // of a track
constexpr int kProbedPatches = 4;
constexpr int kProbes = 20;  // of a patch
constexpr int kMostAhead = 3;
constexpr std::int64_t kProbedBudget = 200;
constexpr std::int64_t kExploringBudget = 30;  // evaluations a parameter
constexpr std::int64_t kSurrogateBudget = 30;  // evaluations a parameter, at most, or
constexpr std::int64_t kAlwaysScarce = 300;    // so many, however few parameters there are,
constexpr std::int64_t kSurrogateLimit = 999;  // and no more than these
constexpr Eigen::Index kSurrogateParameters = 40;
constexpr double kSurrogateShare = 0.8;        // of the evaluations after the initial samples
constexpr std::int64_t kLargestPatch = 4;      // a quarter of the budget
constexpr std::int64_t kMeasuringBudget = 60;  // evaluations a parameter
constexpr std::int64_t kEvolvingBudget = 100;  // evaluations a parameter
constexpr double kInvestment = 0.5;            // of the evaluations while an evolution may pay
constexpr double kMeasuredShare = 0.1;         // of the budget, for slopes of pieces by differences
constexpr double kSamePiece = 0.01;            // pieces whose centres are this near are the same
constexpr std::int64_t kSecondLookBudget = 20;  // evaluations a parameter
constexpr std::int64_t kAmpleBudget = 500;    // evaluations a parameter and dimension of the front
constexpr std::int64_t kFinishingTrack = -2;  // before all others, and no initial sample
constexpr int kMostConstraints = 64;
constexpr std::int64_t kConstrainedSamples = 20;  // more: what is allowed may be in several parts
constexpr int kRestorationSteps = 20;             // of a design that violates constraints, at most
constexpr std::int64_t kBudgetLimit = 10'000'000;

double Spacing(std::int64_t evaluations, Eigen::Index d) {
  const double share = 6.0 / static_cast<double>(evaluations);
  const auto dimensions = static_cast<double>(std::max<Eigen::Index>(d - 1, 1));
  // With many metrics a piece of the front is large: its lattice is to have so many nodes all the
  // same.
  return std::clamp(std::pow(share, 1 / dimensions), 0.005, d <= 3 ? 0.15 : 0.5);
}

std::int64_t InitialSamples(const Discovery::Options& options, Eigen::Index size) {
  std::int64_t wanted = options.initial_samples;
  if (wanted == 0) wanted = size + 3 + (options.constraints > 0 ? kConstrainedSamples : 0);
  const std::int64_t given = options.initial_designs.cols();
  return given +
         std::clamp<std::int64_t>(wanted, 1, std::max<std::int64_t>(1, options.evaluations / 4));
}

TrackScheduler::Options SchedulingOptions(const Discovery::Options& options, Eigen::Index size,
                                          Eigen::Index d) {
  TrackScheduler::Options scheduling = options.scheduling;
  scheduling.optimization.tolerance = std::min(
      scheduling.optimization.tolerance, std::max(Spacing(options.evaluations, d) / 30, 1e-4));
  if (options.evaluations >= kSecondLookBudget * size)
    scheduling.second_look = static_cast<std::size_t>(InitialSamples(options, size));
  scheduling.given = static_cast<std::size_t>(options.initial_designs.cols());
  scheduling.explores = options.evaluations >= kExploringBudget * size;
  return scheduling;
}

absl::Status CheckInitialDesigns(const DesignSpace& space, const Discovery::Options& options) {
  const Eigen::MatrixXd& designs = options.initial_designs;
  if (designs.cols() == 0) return absl::OkStatus();
  if (designs.cols() >= options.evaluations)
    return InvalidField("initial_designs", absl::StrCat(designs.cols(), " are as many as the ",
                                                        options.evaluations, " evaluations"));
  if (designs.rows() != space.size())
    return InvalidField("initial_designs",
                        absl::StrCat("need ", space.size(), " parameters, not ", designs.rows()));
  for (Eigen::Index i = 0; i < designs.cols(); ++i)
    if (designs.col(i) != space.Nearest(designs.col(i)))
      return InvalidField(absl::StrCat("initial_designs[", i, "]"), "is not in the design space");
  return absl::OkStatus();
}

absl::Status CheckOptions(const Discovery::Options& options, Eigen::Index metric_count) {
  if (metric_count < 1 || metric_count > 6)
    return InvalidField("objectives", absl::StrCat("1 to 6 are possible, not ", metric_count));
  if (options.evaluations < 1 || options.evaluations > kBudgetLimit)
    return InvalidField("evaluations", absl::StrCat("must lie between 1 and ", kBudgetLimit));
  if (options.window < 1 || options.window > 4096)
    return InvalidField("window", "must lie between 1 and 4096");
  if (options.cells_per_angle < 0 || options.cells_per_angle > 10'000)
    return InvalidField("cells", "must lie between 1 and 10000, or be 0 for the default");
  if (options.constraints < 0 || options.constraints > kMostConstraints)
    return InvalidField("constraints", absl::StrCat("at most ", kMostConstraints, " are possible"));
  if (options.initial_samples < 0) return InvalidField("initial_samples", "must not be negative");
  return absl::OkStatus();
}

// The parameters with more than one value that can be set; at least one, so that there is a box.
std::vector<Eigen::Index> VaryingParameters(const DesignSpace& space) {
  const Eigen::VectorXd most = space.FromUnit(Eigen::VectorXd::Ones(space.size()));
  std::vector<Eigen::Index> varying;
  for (Eigen::Index i = 0; i < space.size(); ++i)
    if (most[i] > space.lower[i]) varying.push_back(i);
  if (varying.empty()) varying.push_back(0);
  return varying;
}

DesignSpace Restrict(const DesignSpace& space, const std::vector<Eigen::Index>& parameters) {
  DesignSpace part{space.lower(parameters), space.upper(parameters)};
  if (space.step.size() > 0) part.step = space.step(parameters);
  return part;
}

FrontFinishing::Options FinishingOptions(const Discovery::Options& options, Eigen::Index size,
                                         Eigen::Index d) {
  return {.evaluations = options.evaluations,
          .is_ample = options.constraints == 0 &&
                      options.evaluations >= kAmpleBudget * size * std::max<Eigen::Index>(1, d - 1),
          .window = options.window,
          .cells = Discovery::BufferOptions(options, d)};
}

std::size_t HashOf(const Eigen::VectorXd& u) {
  const Eigen::VectorXd one_zero = u.array() + 0.0;
  return std::hash<std::string_view>()(
      {reinterpret_cast<const char*>(one_zero.data()), sizeof(double) * one_zero.size()});
}

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

PerformanceBuffer::Options Discovery::BufferOptions(const Options& options, Eigen::Index d) {
  PerformanceBuffer::Options buffer;
  buffer.tolerance = options.delta_b;
  buffer.cells_per_angle = options.cells_per_angle;
  if (buffer.cells_per_angle == 0) buffer.cells_per_angle = d <= 2 ? 1000 : d == 3 ? 100 : 64;
  if (d <= 3) return buffer;
  const double most = std::pow(kMostCells, 1 / static_cast<double>(d - 1));
  buffer.cells_per_angle = std::min(buffer.cells_per_angle, static_cast<int>(most));
  buffer.cell_limit = static_cast<std::size_t>(
      std::clamp<std::int64_t>(options.evaluations / kEvaluationsOfCell, 50, 4000));
  return buffer;
}

absl::StatusOr<std::unique_ptr<Discovery>> Discovery::Create(const DesignSpace& space,
                                                             Eigen::Index metric_count,
                                                             const Options& options) {
  MORTISE_RETURN_IF_ERROR(Validate(space));
  MORTISE_RETURN_IF_ERROR(CheckOptions(options, metric_count));
  MORTISE_RETURN_IF_ERROR(CheckInitialDesigns(space, options));
  return absl::WrapUnique(new Discovery(space, metric_count, options));
}

Discovery::Discovery(const DesignSpace& space, Eigen::Index metric_count, const Options& options)
    : space_(space),
      free_(VaryingParameters(space)),
      box_(Restrict(space, free_)),
      metric_count_(metric_count),
      options_(options),
      buffer_(BufferOptions(options, metric_count), metric_count),
      scheduler_(SchedulingOptions(options, box_.size(), metric_count), options.seed),
      population_(kPopulation *
                  static_cast<std::size_t>(std::max<Eigen::Index>(metric_count - 1, 1))),
      surrogate_({}, box_, options.seed ^ 0x57a7eULL),
      evolution_(options.seed ^ 0xe501ULL),
      finishing_(FinishingOptions(options, box_.size(), metric_count)),
      random_(options.seed ^ 0x5eedULL),
      initial_samples_(InitialSamples(options, box_.size())),
      spacing_(Spacing(options.evaluations, metric_count)) {
  space_filling_ = LatinHypercube(initial_samples_ - given(), box_.size(), random_);
}

std::optional<Discovery::Proposal> Discovery::Ask() {
  if (stop_ != StopReason::kRunning) return std::nullopt;
  if (proposed_ >= options_.evaluations) {
    if (CommitUpTo(proposed_) && stop_ == StopReason::kRunning)
      Stop(StopReason::kBudget, absl::StrCat("all ", proposed_, " evaluations were made"));
    return std::nullopt;
  }
  if (proposed_ == initial_samples_) barrier_ = std::max(barrier_, proposed_);
  const std::int64_t needed =
      std::max({std::int64_t{0}, proposed_ - options_.window + 1, barrier_});
  if (!CommitUpTo(needed) || stop_ != StopReason::kRunning) return std::nullopt;
  if (options_.uses_all_told) CommitUpTo(proposed_);
  if (stop_ != StopReason::kRunning) return std::nullopt;

  std::int64_t track = -1;
  const std::optional<Eigen::VectorXd> u = NextPoint(track);
  if (stop_ != StopReason::kRunning) return std::nullopt;
  if (!u) {
    // Nothing to ask now. What is under way may open new ways; if nothing is, there are none.
    if (committed_ == proposed_) {
      Stop(StopReason::kConverged, "every design that the method would try has been evaluated");
      return std::nullopt;
    }
    idle_ += options_.window - std::ssize(pending_);
    barrier_ = proposed_;
    return Ask();
  }
  // Designs that were given are asked for bit for bit: the evaluator may know them.
  Proposal proposal{proposed_, proposed_ < given()
                                   ? Eigen::VectorXd(options_.initial_designs.col(proposed_))
                                   : DesignAt(*u)};
  ++proposed_;
  pending_[proposal.number] = {UnitOf(proposal.x), proposal.x, track, std::nullopt};
  return proposal;
}

absl::Status Discovery::Tell(std::int64_t number, Evaluation evaluation) {
  const auto at = pending_.find(number);
  if (at == pending_.end() || at->second.result)
    return InvalidField("number", absl::StrCat("no result is awaited for proposal ", number));
  if (evaluation.x != at->second.x)
    return InvalidField("x", absl::StrCat("not the design of proposal ", number));
  MORTISE_RETURN_IF_ERROR(
      CheckAnswer(evaluation, space_.size(), metric_count_, options_.constraints));
  at->second.result = std::move(evaluation);
  return absl::OkStatus();
}

bool Discovery::CommitUpTo(std::int64_t count) {
  while (committed_ < count && stop_ == StopReason::kRunning) {
    const auto first = pending_.find(committed_);
    if (first == pending_.end() || !first->second.result) return false;
    CommitNext();
  }
  return true;
}

ArchiveEntry Discovery::EntryOf(const Pending& pending) const {
  const Evaluation& result = *pending.result;
  ArchiveEntry entry;
  entry.u = pending.u;
  entry.evaluated = IsUsable(result);
  if (!entry.evaluated) return entry;
  entry.metrics = result.metrics;
  entry.constraints = result.constraints;
  const Eigen::VectorXd sides = box_.upper - box_.lower;
  if (result.jacobian.size() > 0)
    entry.jacobian = result.jacobian(Eigen::all, free_) * sides.asDiagonal();
  if (result.constraint_jacobian.size() > 0)
    entry.constraint_jacobian = result.constraint_jacobian(Eigen::all, free_) * sides.asDiagonal();
  return entry;
}

// Into the archive and all that goes by it; returns the hypervolume gained.
double Discovery::Admit(const Pending& pending, std::size_t& entry) {
  entry = archive_.Add(EntryOf(pending));
  if (pending.x != DesignAt(pending.u)) designs_.emplace(entry, pending.x);
  deviations_.push_back(pending.result->deviations);
  if (archive_[entry].feasible) population_.Offer(archive_, entry);
  if (!EvaluatedAt(pending.u)) evaluated_.emplace(HashOf(pending.u), entry);
  return Absorb(entry);
}

absl::Status Discovery::Learn(const Evaluation& evaluation) {
  if (evaluation.x.size() != space_.size())
    return InvalidField("x", absl::StrCat("must have ", space_.size(), " parameters"));
  MORTISE_RETURN_IF_ERROR(
      CheckAnswer(evaluation, space_.size(), metric_count_, options_.constraints));
  if (proposed_ == 0) initial_samples_ = std::max(given(), initial_samples_ - 1);
  std::size_t entry = 0;
  Admit({UnitOf(evaluation.x), evaluation.x, -1, evaluation}, entry);
  if (archive_[entry].evaluated && !archive_[entry].feasible) ++learnt_violating_;
  return absl::OkStatus();
}

void Discovery::CommitNext() {
  const std::int64_t number = committed_++;
  const auto first = pending_.find(number);
  const Pending pending = std::move(first->second);
  pending_.erase(first);
  if (!IsUsable(*pending.result)) {
    ++failed_;
    failures_.Add(*pending.result);
    if (message_.empty()) message_ = pending.result->message;
  }
  std::size_t entry = 0;
  const double gain = Admit(pending, entry);
  const auto track = tracks_.find(pending.track);
  if (track != tracks_.end()) {
    track->second.gain += gain;
    ++track->second.evaluations;
  }
  Answer(number, entry);
}

// To all tracks that have asked for the design of a proposal.
void Discovery::Answer(std::int64_t number, std::size_t entry) {
  bool was_asked = false;
  for (auto& [id, track] : tracks_) {
    for (Asked& asked : track.asked) {
      if (asked.number != number) continue;
      asked.entry = entry;
      was_asked = true;
    }
    TellInOrder(track);
  }
  if (was_asked) RetireFinished();
}

double Discovery::DominatedVolume(const Scaling& scaling, double reference, int samples) const {
  std::vector<Eigen::VectorXd> points;
  for (const std::size_t index : archive_.non_dominated())
    points.push_back(scaling.Apply(archive_[index].metrics));
  return QuickHypervolume(points, Eigen::VectorXd::Constant(metric_count_, reference), samples);
}

// The hypervolume that the last entry, which nothing dominates, adds to what was not dominated
// before; in the scaling of the buffer.
double Discovery::GainOf(std::size_t entry) const {
  const Scaling& scaling = buffer_.scaling();
  const auto front = archive_.non_dominated_metrics();
  const auto others = front.cols() - 1;
  const std::vector<std::size_t>& displaced = archive_.displaced();
  Eigen::MatrixXd before(metric_count_, others + std::ssize(displaced));
  before.leftCols(others) = front.leftCols(others);
  for (std::size_t k = 0; k < displaced.size(); ++k)
    before.col(others + static_cast<Eigen::Index>(k)) = archive_[displaced[k]].metrics;
  const double volume = HypervolumeContribution(archive_[entry].metrics, before,
                                                scaling.ideal + kReference * scaling.range,
                                                metric_count_ <= kExactMetrics ? 0 : kMostOverlaps);
  return volume / scaling.range.prod();
}

// Puts an entry into the buffer; returns the hypervolume gained over what was not dominated before,
// in the scaling that holds afterwards.
double Discovery::Absorb(std::size_t entry) {
  if (!archive_[entry].feasible) return 0;
  const Scaling scaling = archive_.CurrentScaling();
  const bool is_trade_off = archive_.non_dominated().back() == entry;
  if (buffer_.NeedsRebuild(scaling)) {
    buffer_.Rebuild(archive_, scaling);
    hypervolume_ = DominatedVolume(scaling, kReference, kRunningSamples);
    progress_mark_ = 0;  // another scale: progress is counted anew
    tracks_since_progress_ = 0;
    return is_trade_off ? GainOf(entry) : 0;
  }
  buffer_.Insert(entry, buffer_.scaling().Apply(archive_[entry].metrics));
  if (!is_trade_off) return 0;
  const double gain = GainOf(entry);
  hypervolume_ += gain;
  return gain;
}

Eigen::VectorXd Discovery::DesignAt(const Eigen::VectorXd& u) const {
  Eigen::VectorXd x = space_.lower;
  x(free_) = box_.FromUnit(u);
  return x;
}

// Of the entry that has been evaluated there.
std::optional<std::size_t> Discovery::EvaluatedAt(const Eigen::VectorXd& u) const {
  const auto [first, last] = evaluated_.equal_range(HashOf(u));
  const auto known =
      std::find_if(first, last, [&](const auto& each) { return archive_[each.second].u == u; });
  return known == last ? std::nullopt : std::optional(known->second);
}

// The number of the proposal under way with that design.
std::optional<std::int64_t> Discovery::UnderWayAt(const Eigen::VectorXd& u) const {
  const auto at =
      std::ranges::find_if(pending_, [&](const auto& each) { return each.second.u == u; });
  return at == pending_.end() ? std::nullopt : std::optional(at->first);
}

Eigen::VectorXd Discovery::UnitOf(const Eigen::VectorXd& x) const { return box_.ToUnit(x(free_)); }

// Those given, then the Latin hypercube; uniformly at random while nothing feasible has been found.
Eigen::VectorXd Discovery::InitialDesign() {
  if (proposed_ < given()) return UnitOf(options_.initial_designs.col(proposed_));
  if (proposed_ < initial_samples_)
    return space_filling_[static_cast<std::size_t>(proposed_ - given())];
  Eigen::VectorXd u(box_.size());
  for (double& value : u) value = random_.Uniform();
  return u;
}

std::optional<Eigen::VectorXd> Discovery::NextPoint(std::int64_t& track) {
  track = -1;
  if (proposed_ < initial_samples_ || archive_.evaluated_count() == 0) return InitialDesign();
  if (archive_.feasible_count() == 0) {
    do {
      const std::optional<Eigen::VectorXd> u = AskTracks(track, false);
      if (u || stop_ != StopReason::kRunning) return u;
    } while (StartRestoration());
    return tracks_.empty() ? std::optional(InitialDesign()) : std::nullopt;
  }
  if (SurrogateIsDue() && !finishing_.PolishesOnly(Left()))
    if (const std::optional<Eigen::VectorXd> u = AskSurrogate(track)) return u;
  if (Explores()) StartFinishing();
  for (int barren = 0; barren < kExhaustedTracks; ++barren) {
    const std::int64_t newest = next_track_;
    const bool polishes = barren < kBarrenTracks && finishing_.PolishesOnly(Left());
    const std::optional<Eigen::VectorXd> u = AskTracks(track, polishes);
    if (u || stop_ != StopReason::kRunning) return u;
    if (next_track_ != newest) continue;  // an expansion has begun
    if (AwaitsOpening() && !pending_.empty())
      return UsesSurrogate() ? AskSurrogate(track) : std::nullopt;
    // What is polished next depends on what came of this.
    if (polishes && tracks_.contains(kFinishingTrack)) return std::nullopt;
    StartTrack(barren >= kBarrenTracks, polishes);
  }
  return std::nullopt;
}

// The next point of the oldest track that has one. Designs that have been evaluated before are
// answered from the archive. With `polishes` of those alone that polish.
std::optional<Eigen::VectorXd> Discovery::AskTracks(std::int64_t& track, bool polishes) {
  for (auto& [id, asked] : tracks_) {
    if (polishes && id != kFinishingTrack && asked.kind != TrackKind::kPolish) continue;
    track = id;
    const std::optional<Eigen::VectorXd> u = AskTrack(asked);
    if (u) return u;
  }
  track = -1;
  RetireFinished();
  return std::nullopt;
}

std::optional<Eigen::VectorXd> Discovery::AskTrack(Track& track) {
  while (const std::optional<Eigen::VectorXd> u = track.source->Ask(archive_)) {
    const Eigen::VectorXd possible = UnitOf(DesignAt(*u));
    if (const std::optional<std::size_t> known = EvaluatedAt(possible)) {
      track.asked.push_back({.entry = known});
      TellInOrder(track);
    } else if (const std::optional<std::int64_t> number = UnderWayAt(possible)) {
      track.asked.push_back({.number = *number});
    } else {
      track.asked.push_back({.number = proposed_});
      return u;
    }
  }
  return std::nullopt;
}

// What is known of the points of a track, as far as those asked for before them are known.
void Discovery::TellInOrder(Track& track) {
  while (!track.asked.empty() && track.asked.front().entry) {
    const std::size_t entry = *track.asked.front().entry;
    track.asked.pop_front();
    track.source->Tell(archive_, entry);
  }
}

void Discovery::RetireFinished() {
  for (auto at = tracks_.begin(); at != tracks_.end();) {
    if (!at->second.source->Finished()) {
      ++at;
      continue;
    }
    const Track track = std::move(at->second);
    at = tracks_.erase(at);
    Retire(track);
  }
}

void Discovery::Retire(const Track& track) {
  scheduler_.Report(track.kind, track.gain, track.evaluations);
  if (track.patch != nullptr) {
    measured_ += track.patch->measurements();
    if (track.patch->piece().directions.cols() > 0) {
      pieces_.push_back(track.patch->piece());
    } else if (track.patch->probes()) {
      --probed_patches_;
    }
    return;
  }
  if (track.optimization == nullptr) {
    if (track.kind != TrackKind::kOpening) return;  // children, say
    if (track.evaluations > 0) LearnFromLines();
    if (std::exchange(descending_, false)) {
      TryLeastAlongLines();
      TraverseFromMiddle();
    }
    return;
  }
  if (track.evaluations > 0) ++optimizations_;
  if (archive_.feasible_count() == 0) return;
  if (hypervolume_ > progress_mark_ * (1 + options_.delta_i)) {
    progress_mark_ = hypervolume_;
    tracks_since_progress_ = 0;
  } else if (track.evaluations > 0 && ++tracks_since_progress_ == options_.stall_tracks) {
    Stop(StopReason::kConverged,
         absl::StrCat("no progress in ", options_.stall_tracks, " optimisations"));
    return;
  }
  const std::optional<std::size_t> best = track.optimization->best();
  if (!best || !archive_[*best].feasible ||
      archive_.ClearlyDominated(archive_[*best].metrics, buffer_.scaling(), options_.delta_b))
    return;
  if (track.kind == TrackKind::kOpening) StartTraverses(*best);
  const Eigen::VectorXd& u = archive_[*best].u;
  if (std::any_of(pieces_.begin(), pieces_.end(), [&](const AffinePiece& piece) {
        return (piece.centre - u).lpNorm<Eigen::Infinity>() < kSamePiece;
      }))
    return;
  PatchSampling::Options options;
  options.spacing = std::max(spacing_, Spacing(committed_, metric_count_));
  options.tolerance = options_.delta_b;
  options.evaluations = static_cast<int>(
      std::max<std::int64_t>(options.evaluations, options_.evaluations / kLargestPatch));
  // A small budget has other use for them.
  if (options_.evaluations >= kProbedBudget && probed_patches_ < kProbedPatches) {
    ++probed_patches_;
    options.probes = kProbes;
  }
  options.measures = MayMeasure();
  options.ahead = std::min(kMostAhead, (options_.window - 1) / 2);
  auto patch = std::make_unique<PatchSampling>(options, buffer_.scaling(), *best);
  PatchSampling* const view = patch.get();
  tracks_[next_track_++] = {std::move(patch), nullptr, view, track.kind, 0, 0};
  ++expansions_;
}

// Whether a piece's slopes may be measured: differences need values as small as they like.
bool Discovery::MayMeasure() const {
  if (options_.evaluations < kMeasuringBudget * box_.size() || (box_.step.array() > 0).any())
    return false;
  const std::int64_t all = measured_ + DifferenceModel::Evaluations(box_.size());
  return static_cast<double>(all) <= kMeasuredShare * static_cast<double>(options_.evaluations);
}

// Whether the budget allows for more than local optimisations and what follows from them.
bool Discovery::Explores() const { return options_.evaluations >= kExploringBudget * box_.size(); }

// Before all others.
void Discovery::StartFinishing() {
  if (std::unique_ptr<PointSource> round = finishing_.NextRound(archive_, Left()))
    tracks_[kFinishingTrack] = {std::move(round), nullptr, nullptr, TrackKind::kFinishing, 0, 0};
}

void Discovery::StartTrack(bool force_sample, bool polishes) {
  if (!opened_) {
    if (OffersGradients()) scheduler_.UseGradients(static_cast<std::size_t>(initial_samples_));
  }
  if (!std::exchange(opened_, true) && Explores()) {
    descending_ = true;
    tracks_[next_track_++] = {MakeDescent(), nullptr, nullptr, TrackKind::kOpening, 0, 0};
    return;
  }
  if (options_.evaluations >= kEvolvingBudget * box_.size())
    scheduler_.Invest(kInvestment * evolution_.Promise());
  TrackScheduler::Track next = polishes ? scheduler_.Polish(archive_, buffer_)
                                        : scheduler_.Next(archive_, buffer_, force_sample);
  if (next.kind == TrackKind::kBreed)
    next.other = std::make_unique<Breeding>(archive_, population_, kChildren, random_);
  if (next.kind == TrackKind::kEvolve)
    next.other =
        std::make_unique<Evolving>(archive_, archive_.CurrentScaling(), kChildren, evolution_);
  if (next.kind == TrackKind::kTransfer)
    next.other = std::make_unique<PointList>(evolution_.Transfers(archive_, kChildren));
  if (next.other != nullptr) {
    tracks_[next_track_++] = {std::move(next.other), nullptr, nullptr, next.kind, 0, 0};
    return;
  }
  LocalOptimization* const view = next.optimization.get();
  tracks_[next_track_++] = {std::move(next.optimization), view, nullptr, next.kind, 0, 0};
}

// Of all metrics; a slope may be infinite here or there.
bool Discovery::OffersGradients() const {
  return OffersEvery(archive_[archive_.non_dominated().front()].jacobian);
}

// Automatically where evaluations are so few that each is worth some thought. With gradients local
// models need no other.
bool Discovery::UsesSurrogate() const {
  if (options_.surrogate != Surrogate::kAutomatic) return options_.surrogate == Surrogate::kAlways;
  const std::int64_t scarce = std::max(kSurrogateBudget * box_.size(), kAlwaysScarce);
  return box_.size() <= kSurrogateParameters &&
         options_.evaluations <= std::min(kSurrogateLimit, scarce) && !OffersGradients();
}

// Whether the next evaluation is the surrogate's.
bool Discovery::SurrogateIsDue() const {
  const auto searched = static_cast<double>(proposed_ - initial_samples_);
  return static_cast<double>(surrogate_proposals_) <= kSurrogateShare * searched && UsesSurrogate();
}

std::optional<Eigen::VectorXd> Discovery::AskSurrogate(std::int64_t& track) {
  std::vector<Eigen::VectorXd> under_way;
  for (const auto& [number, pending] : pending_) under_way.push_back(pending.u);
  track = next_track_++;
  Track& proposal = tracks_[track] = {
      surrogate_.Next(archive_, under_way), nullptr, nullptr, TrackKind::kSurrogate, 0, 0};
  ++surrogate_proposals_;
  return AskTrack(proposal);
}

// While nothing meets the constraints: from the design that is nearest to that and was not tried
// yet. False where there is none, or enough are under way.
bool Discovery::StartRestoration() {
  // The first one alone: the others go by the slopes that it measures.
  const int most = restored_from_.size() == 1 ? 1 : std::max(1, options_.window / 2);
  if (static_cast<int>(tracks_.size()) >= most) return false;
  std::optional<std::size_t> start;
  for (std::size_t entry = 0; entry < archive_.size(); ++entry) {
    if (!archive_[entry].evaluated || restored_from_.contains(entry)) continue;
    if (!start || archive_.Violation(entry) < archive_.Violation(*start)) start = entry;
  }
  if (!start) return false;
  restored_from_.insert(*start);
  LocalOptimization::Options local = options_.scheduling.optimization;
  local.join = false;
  local.evaluations = kRestorationSteps;
  if (restored_from_.size() == 1 && options_.evaluations >= kSecondLookBudget * box_.size()) {
    local.differences = true;
    local.evaluations += static_cast<int>(box_.size());
  }
  const Eigen::VectorXd direction = Eigen::VectorXd::Constant(metric_count_, -1).normalized();
  const Scaling scaling = archive_.CurrentScaling();
  const double reach = options_.scheduling.delta_s;
  const LocalOptimization::Target target{
      scaling.Apply(archive_[*start].metrics) + reach * direction, direction, reach};
  auto restoration = std::make_unique<LocalOptimization>(local, scaling, target, *start);
  LocalOptimization* const view = restoration.get();
  tracks_[next_track_++] = {std::move(restoration), view, nullptr, TrackKind::kSample, 0, 0};
  return true;
}

void Discovery::Stop(StopReason reason, std::string message) {
  if (stop_ != StopReason::kRunning) return;
  CommitUpTo(proposed_);
  stop_ = reason;
  shown_.committed = -1;  // to be measured once more, as well as may be
  message_ = std::move(message);
  if (archive_.feasible_count() > 0) buffer_.Rebuild(archive_, archive_.CurrentScaling());
}

Discovery::Summary Discovery::summary() const {
  Summary summary;
  summary.stop_reason = stop_;
  summary.message = message_;
  summary.evaluations = committed_;
  summary.failed = failed_;
  summary.violating =
      static_cast<std::int64_t>(archive_.evaluated_count() - archive_.feasible_count()) -
      learnt_violating_;
  summary.failures = failures_.failures();
  summary.optimizations = optimizations_;
  summary.expansions = expansions_;
  summary.pieces = std::ssize(pieces_);
  summary.cells_covered = static_cast<std::int64_t>(buffer_.cells().size());
  const std::int64_t since = committed_ - shown_.committed;
  if (archive_.feasible_count() > 0 && since > (Finished() ? 0 : shown_.committed / kShownEvery)) {
    shown_ = {committed_, DominatedVolume(archive_.CurrentScaling(), 1,
                                          Finished() ? kFinalSamples : kRunningSamples)};
  }
  summary.surrogate = surrogate_.quality();
  summary.hypervolume = shown_.hypervolume;
  return summary;
}

Front Discovery::front() const {
  Front front = BuildFront(box_, archive_, buffer_, pieces_);
  for (FrontPoint& point : front.points) {
    const auto exact = designs_.find(point.entry);
    point.x = exact == designs_.end() ? DesignAt(archive_[point.entry].u) : exact->second;
    point.deviations = deviations_[point.entry];
  }
  for (FrontPiece& piece : front.pieces) {
    Eigen::VectorXd origin = space_.lower;
    origin(free_) = piece.origin;
    Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(space_.size(), piece.directions.cols());
    directions(free_, Eigen::all) = piece.directions;
    piece.origin = std::move(origin);
    piece.directions = std::move(directions);
  }
  return front;
}

}  // namespace mortise::pareto
