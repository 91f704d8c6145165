#include "services/pareto/discovery/search_policy.h"

#include <algorithm>
#include <cmath>

namespace mortise::pareto {
namespace {

// Budgets in evaluations for each parameter, from which on something pays.
constexpr std::int64_t kSecondLookBudget = 20;  // to look for each optimum a second time
constexpr std::int64_t kExploringBudget = 30;   // bridges, children, sweeps, and a descent at first
constexpr std::int64_t kMeasuringBudget = 60;   // slopes of pieces by differences
constexpr std::int64_t kEvolvingBudget = 100;   // evolution
constexpr std::int64_t kAmpleBudget = 500;      // and for each dimension of the front: finishing

// The initial samples beyond the number of parameters.
constexpr std::int64_t kSpaceFilling = 3;
constexpr std::int64_t kMoreWithConstraints = 20;

// A surrogate that nobody asked for takes part in so many evaluations, for so many parameters at
// most: its own time grows with both.
constexpr std::int64_t kSurrogateEvaluations = 1000;
constexpr Eigen::Index kSurrogateParameters = 40;
constexpr double kSurrogateShare = 0.8;  // of the evaluations, where it is asked for

// Pieces of the front.
constexpr std::int64_t kMaxPatch = 4;        // a patch takes at most this part of the budget
constexpr std::int64_t kProbedBudget = 200;  // evaluations from which on patches probe
constexpr int kProbedPatches = 4;            // patches that probe at a time
constexpr int kProbes = 20;                  // of one of them
constexpr int kMaxAhead = 3;                 // nodes asked for before their neighbour is known
constexpr double kMeasuredShare = 0.1;       // of the budget, for slopes by differences

// The opening.
constexpr double kDescentShare = 0.25;  // of the budget, for the descent
constexpr double kTraverseShare = 0.2;  // of the budget, for traverses
constexpr double kIdleShare = 0.26;     // of the budget, after which nothing is waited for
constexpr double kMinIdle = 78;         // evaluations, the least after which patience ends

constexpr std::size_t kPopulation = 30;  // for each metric but one
constexpr int kRestorationSteps = 20;    // of a design that violates constraints, at most

constexpr double kMaxCells = 2e9;               // so that their numbers fit 32 bits
constexpr std::int64_t kEvaluationsOfCell = 4;  // where the buffer adapts

}  // namespace

SearchPolicy::SearchPolicy(const DiscoveryOptions& options, Eigen::Index size,
                           Eigen::Index metric_count)
    : options_(options), size_(size), metric_count_(metric_count) {}

std::int64_t SearchPolicy::InitialSamples() const {
  std::int64_t wanted = options_.initial_samples;
  if (wanted == 0) {
    wanted = size_ + kSpaceFilling + (options_.constraints > 0 ? kMoreWithConstraints : 0);
  }
  const std::int64_t most = std::max<std::int64_t>(1, options_.evaluations / 4);
  return options_.initial_designs.cols() + std::clamp<std::int64_t>(wanted, 1, most);
}

double SearchPolicy::SpacingFor(std::int64_t evaluations) const {
  const double share = 6.0 / static_cast<double>(evaluations);
  const auto dimensions = static_cast<double>(std::max<Eigen::Index>(metric_count_ - 1, 1));
  // With many metrics a piece of the front is large: its lattice is to have so many nodes all the
  // same.
  return std::clamp(std::pow(share, 1 / dimensions), 0.005, metric_count_ <= 3 ? 0.15 : 0.5);
}

TrackScheduler::Options SearchPolicy::Scheduling() const {
  TrackScheduler::Options scheduling = options_.scheduling;
  scheduling.optimization.tolerance = std::min(
      scheduling.optimization.tolerance, std::max(SpacingFor(options_.evaluations) / 30, 1e-4));
  if (options_.evaluations >= kSecondLookBudget * size_) {
    scheduling.second_look = static_cast<std::size_t>(InitialSamples());
  }
  scheduling.given = static_cast<std::size_t>(options_.initial_designs.cols());
  scheduling.explores = Explores();
  return scheduling;
}

FrontFinishing::Options SearchPolicy::Finishing() const {
  const Eigen::Index dimensions = std::max<Eigen::Index>(1, metric_count_ - 1);
  return {.evaluations = options_.evaluations,
          .is_ample = options_.constraints == 0 &&
                      options_.evaluations >= kAmpleBudget * size_ * dimensions,
          .window = options_.window,
          .cells = BufferOptions(options_, metric_count_)};
}

std::size_t SearchPolicy::PopulationSize() const {
  return kPopulation * static_cast<std::size_t>(std::max<Eigen::Index>(metric_count_ - 1, 1));
}

bool SearchPolicy::Explores() const { return options_.evaluations >= kExploringBudget * size_; }

bool SearchPolicy::Evolves() const { return options_.evaluations >= kEvolvingBudget * size_; }

bool SearchPolicy::UsesSurrogate(bool offers_gradients, std::int64_t proposed) const {
  using Surrogate = DiscoveryOptions::Surrogate;
  if (options_.surrogate != Surrogate::kAutomatic) return options_.surrogate == Surrogate::kAlways;
  return size_ <= kSurrogateParameters && proposed < kSurrogateEvaluations && !offers_gradients;
}

std::optional<double> SearchPolicy::FixedSurrogateShare() const {
  if (options_.surrogate != DiscoveryOptions::Surrogate::kAlways) return std::nullopt;
  return kSurrogateShare;
}

PatchSampling::Options SearchPolicy::Patch(std::int64_t committed, bool may_probe,
                                           bool measures) const {
  PatchSampling::Options patch;
  patch.spacing = std::max(SpacingFor(options_.evaluations), SpacingFor(committed));
  patch.tolerance = options_.delta_b;
  patch.evaluations =
      static_cast<int>(std::max<std::int64_t>(patch.evaluations, options_.evaluations / kMaxPatch));
  if (may_probe) patch.probes = kProbes;
  patch.measures = measures;
  patch.ahead = std::min(kMaxAhead, (options_.window - 1) / 2);
  return patch;
}

bool SearchPolicy::MayProbe(int probing) const {
  return options_.evaluations >= kProbedBudget && probing < kProbedPatches;
}

bool SearchPolicy::MayMeasure(std::int64_t measured) const {
  if (options_.evaluations < kMeasuringBudget * size_) return false;
  const std::int64_t all = measured + DifferenceModel::Evaluations(size_);
  return static_cast<double>(all) <= kMeasuredShare * Budget();
}

LocalOptimization::Options SearchPolicy::Restoration(bool is_first) const {
  LocalOptimization::Options local = options_.scheduling.optimization;
  local.join = false;
  local.evaluations = kRestorationSteps;
  if (is_first && options_.evaluations >= kSecondLookBudget * size_) {
    local.differences = true;
    local.evaluations += static_cast<int>(size_);
  }
  return local;
}

int SearchPolicy::RestorationsAtOnce() const { return std::max(1, options_.window / 2); }

CoordinateDescent::Options SearchPolicy::Descent() const {
  CoordinateDescent::Options descent;
  const double share = kDescentShare * Budget();
  descent.evaluations = static_cast<int>(share);
  // Where constraints hold, what is best along each may not be put together.
  descent.lines =
      std::max(1, options_.constraints > 0 ? options_.window / 2 : 3 * options_.window / 4);
  descent.line.values =
      static_cast<int>(std::clamp(0.5 * share / static_cast<double>(size_), 4.0, 64.0));
  return descent;
}

bool SearchPolicy::MayTraverse(std::size_t traverses, int evaluations) const {
  const auto spent = static_cast<double>(traverses + 1) * evaluations;
  return spent <= kTraverseShare * Budget();
}

SearchPolicy::Patience SearchPolicy::PatienceAfter(std::int64_t idle) const {
  const auto waited = static_cast<double>(idle);
  if (waited >= std::max(kMinIdle, kIdleShare * Budget())) return Patience::kNone;
  return waited < kMinIdle || metric_count_ > 2 ? Patience::kAll : Patience::kOptimizations;
}

PerformanceBuffer::Options BufferOptions(const DiscoveryOptions& options,
                                         Eigen::Index metric_count) {
  PerformanceBuffer::Options buffer;
  buffer.tolerance = options.delta_b;
  buffer.cells_per_angle = options.cells_per_angle;
  if (buffer.cells_per_angle == 0) {
    buffer.cells_per_angle = metric_count <= 2 ? 1000 : metric_count == 3 ? 100 : 64;
  }
  if (metric_count <= 3) return buffer;
  const double most = std::pow(kMaxCells, 1 / static_cast<double>(metric_count - 1));
  buffer.cells_per_angle = std::min(buffer.cells_per_angle, static_cast<int>(most));
  buffer.cell_limit = static_cast<std::size_t>(
      std::clamp<std::int64_t>(options.evaluations / kEvaluationsOfCell, 50, 4000));
  return buffer;
}

}  // namespace mortise::pareto
