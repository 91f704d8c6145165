// Says how a discovery divides its budget: every constant of the search, and what follows from the
// budget, the number of parameters and the number of metrics.
//
// All of it is our own, and was chosen on the published problems of tests/bench/pareto. Budgets
// "for each parameter" count the parameters that can vary.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "services/pareto/archive/performance_buffer.h"
#include "services/pareto/discovery/discovery_options.h"
#include "services/pareto/sources/coordinate_descent.h"
#include "services/pareto/sources/front_finishing.h"
#include "services/pareto/sources/local_optimization.h"
#include "services/pareto/sources/patch_sampling.h"

namespace mortise::pareto {

class SearchPolicy {
 public:
  // Tracks in a row without a new point, after which a stochastic sample is forced.
  static constexpr int kBarrenTracks = 4;
  // Tracks in a row without a new point, after which the design space counts as exhausted.
  static constexpr int kExhaustedTracks = 200;
  // The number of children of one track.
  static constexpr int kChildren = 8;
  // The share of the evaluations that evolution gets while nobody knows whether it pays.
  static constexpr double kInvestment = 0.5;
  // Pieces whose centres are as near as this in every unit coordinate count as the same.
  static constexpr double kSamePiece = 0.01;
  // Traverses along one parameter whose starts are as near as this in the others are the same.
  static constexpr double kSameTraverse = 1e-6;
  // A parameter trades metrics off if it does so by as much as this, in ranges of the front.
  static constexpr double kMinTrade = 0.1;

  // `size` is the number of parameters that can vary. The options have been checked.
  SearchPolicy(const DiscoveryOptions& options, Eigen::Index size, Eigen::Index metric_count);

  // Returns how many designs are evaluated before the search begins: those given and those that
  // fill the space. More fill it with constraints, as what is allowed may be in several parts.
  std::int64_t InitialSamples() const;

  // Returns how far apart trade-offs along a patch are to be, in scaled performance, so that a
  // front of as many metrics takes so many evaluations.
  double SpacingFor(std::int64_t evaluations) const;

  TrackScheduler::Options Scheduling() const;
  FrontFinishing::Options Finishing() const;
  std::size_t PopulationSize() const;

  // Whether the budget allows for more than local optimisations and what follows from them.
  bool Explores() const;

  // Whether it allows for evolution, too.
  bool Evolves() const;

  // Whether a surrogate may propose the next design after `proposed` ones; automatically it may
  // earn turns (surrogate_turns.h) among the first thousand evaluations. With gradients local
  // models need no other.
  bool UsesSurrogate(bool offers_gradients, std::int64_t proposed) const;

  // Returns the share of the proposals that the surrogate has whatever it earns, if it has one.
  std::optional<double> FixedSurrogateShare() const;

  // Returns how a piece is followed when `committed` evaluations have been made. `may_probe` says
  // whether fewer pieces look beyond their ends than may.
  PatchSampling::Options Patch(std::int64_t committed, bool may_probe, bool measures) const;

  // Whether a piece may look beyond its ends while `probing` others do. A small budget has other
  // use for these evaluations.
  bool MayProbe(int probing) const;

  // Whether the slopes of another piece may be measured by differences, when `measured` evaluations
  // went into those of others.
  bool MayMeasure(std::int64_t measured) const;

  // Returns how a design that violates constraints is led to where it meets them. The first one
  // measures slopes, which the others go by.
  LocalOptimization::Options Restoration(bool is_first) const;

  // Returns how many restorations run side by side once the first has ended.
  int RestorationsAtOnce() const;

  // Returns how the descent along one parameter after the other is made.
  CoordinateDescent::Options Descent() const;

  // Whether another traverse may begin after `traverses`, each of so many evaluations.
  bool MayTraverse(std::size_t traverses, int evaluations) const;

  // Says how much there is still waited for once there was room for `idle` evaluations while
  // results were waited for: for all opening tracks; for optimisations alone, no longer for a piece
  // along a single direction; for nothing.
  enum class Patience { kAll, kOptimizations, kNone };
  Patience PatienceAfter(std::int64_t idle) const;

 private:
  double Budget() const { return static_cast<double>(options_.evaluations); }

  DiscoveryOptions options_;
  Eigen::Index size_;
  Eigen::Index metric_count_;
};

// Returns how the buffer of a discovery of `metric_count` metrics is divided into cells.
PerformanceBuffer::Options BufferOptions(const DiscoveryOptions& options,
                                         Eigen::Index metric_count);

}  // namespace mortise::pareto
