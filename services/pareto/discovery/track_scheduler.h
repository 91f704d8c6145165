// Chooses where the next local optimisation starts and what it aims at (§7.5.2).
//
// First come the middle of the front and each metric's own optimum, so that the scaling of
// performance is soon about right. Then ten ways of spending an evaluation take turns:
//   - gap: aim into the widest hole between known trade-offs, starting from one beside it, which
//     costs nothing (the neighbouring-cell direction of the thesis, with the cell chosen by need);
//     where one design dominates all others, from any of those towards the best of a metric;
//   - refine: push a known trade-off straight down, along the normal of the front there;
//   - sample: the thesis's stochastic sample x_s = x_j + 2^(-delta) d with the direction of a cell
//     within delta_N of its own, which is what leaves local minima;
//   - bridge: designs between those of neighbouring trade-offs (front_bridging.h);
//   - polish: the same, pushed on to the front as far as models tell (front_polishing.h);
//   - breed: children of the best designs so far (population.h), which is what gets through very
//     many local optima;
//   - sweep: along one parameter of a known trade-off (coordinate_search.h);
//   - evolve: samples of a Gaussian that learns how metrics fall (evolution_search.h);
//   - transfer: the step that evolution took from one trade-off, taken from others;
//   - align: trade-offs moved on to the subspace of another one (front_alignment.h).
// Each gets a share of the evaluations in proportion to the hypervolume that it has lately brought
// per evaluation, none less than its part of `least_share`.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/performance_buffer.h"
#include "services/pareto/sources/front_bridging.h"
#include "services/pareto/sources/local_optimization.h"

namespace mortise::pareto {

enum class TrackKind {
  kGap = 0,
  kRefine = 1,
  kSample = 2,
  kBridge = 3,
  kBreed = 4,
  kSweep = 5,
  kPolish = 6,
  kEvolve = 7,
  kTransfer = 8,
  kAlign = 9,
  kOpening = 10,
  kSurrogate = 11,  // proposals of a surrogate, which the caller interleaves
  kFinishing = 12   // rounds at the end, the same
};

class TrackScheduler {
  static constexpr std::size_t kWays = 10, kLocalWays = 3;

 public:
  struct Options {
    double delta_s = 0.3;       // distance of the reference point, relative to |y|
    double delta_p = 10;        // exponent range of the perturbation
    double delta_n = 0.2;       // neighbourhood of a cell, in parts of each angle
    double least_share = 0.25;  // of all ways together, in equal parts
    bool explores = true;       // whether bridges, children and sweeps have a share
    // The number of entries, the first of the archive, from which each metric's optimum is looked
    // for a second time, independently of what is known by then: the first time may end in a corner
    // where all slopes vanish. With 0 there is no second time.
    std::size_t second_look = 0;
    std::size_t given = 0;  // the first so many of these are not looked at: they are of a front
    LocalOptimization::Options optimization;
  };

  struct Track {
    TrackKind kind = TrackKind::kOpening;
    std::unique_ptr<LocalOptimization> optimization;
    std::unique_ptr<PointSource> other;  // of kBridge, kSweep, kPolish, kAlign; those of kBreed,
                                         // kEvolve, kTransfer are the caller's
  };

  TrackScheduler(const Options& options, std::uint64_t seed) : options_(options), random_(seed) {}

  // Is called where all gradients are offered: each metric's optimum is then looked for a second
  // time whatever the budget (Options::second_look).
  void UseGradients(std::size_t entries) {
    options_.second_look = entries;
    has_gradients_ = true;
  }

  // Returns the next track. `buffer` has been built and holds a feasible entry of `archive`. With
  // `force_sample` it is a stochastic sample, which always asks for a new point.
  Track Next(const Archive& archive, const PerformanceBuffer& buffer, bool force_sample);

  // Returns the next track of kPolish.
  Track Polish(const Archive& archive, const PerformanceBuffer& buffer);

  // Counts what a track (with the expansion after it) brought: hypervolume gained for evaluations
  // spent.
  void Report(TrackKind kind, double gain, int evaluations);

  // Sets the part of the evaluations that evolution gets before what it brought is counted: its
  // first search brings nothing until it has learnt how metrics fall.
  void Invest(double part) { investment_ = part; }

  // Whether an opening track that is under way should end before Next is called again: the middle
  // of the front comes first, then each metric's optimum side by side, then the rest.
  bool AwaitsOpening(Eigen::Index metric_count) const {
    return opened_ == 1 || opened_ > LastOpening(metric_count);
  }

 private:
  Eigen::Index LastOpening(Eigen::Index metric_count) const {
    return options_.second_look > 0 ? 2 * metric_count : metric_count;
  }
  std::size_t OpeningStart(const Archive& archive, const Scaling& scaling, Eigen::Index metric,
                           const std::vector<std::size_t>& candidates) const;
  Track OpeningTrack(const Archive& archive);
  Track GapTrack(const Archive& archive, const PerformanceBuffer& buffer);
  Track ElsewhereTrack(const Archive& archive, const PerformanceBuffer& buffer);
  Track PlanarGapTrack(const Archive& archive, const PerformanceBuffer& buffer);
  Track RefineTrack(const Archive& archive, const PerformanceBuffer& buffer);
  Track BridgeTrack(const Archive& archive, const PerformanceBuffer& buffer);
  Track SweepTrack(const Archive& archive, const PerformanceBuffer& buffer);
  Track AlignTrack(const Archive& archive, const PerformanceBuffer& buffer);
  Track SampleTrack(const Archive& archive, const PerformanceBuffer& buffer);
  std::array<double, kWays> Shares() const;
  TrackKind ChooseKind();
  std::size_t DrawFrontEntry(const Archive& archive, const PerformanceBuffer& buffer);
  int& TriesAt(const PerformanceBuffer& buffer, const Eigen::VectorXd& scaled);

  Options options_;
  Random random_;
  FrontBridging bridging_;
  int opened_ = 0;
  bool has_gradients_ = false;
  double investment_ = 0;
  std::map<std::int64_t, int> tries_;  // by coarse cell
  std::array<double, kWays> gain_{};
  std::array<double, kWays> spent_{};
  std::array<double, kWays> balance_{};  // evaluations each way is owed
};

}  // namespace mortise::pareto
