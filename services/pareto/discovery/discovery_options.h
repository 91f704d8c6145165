// Says how much a discovery (discovery.h) may spend, and on what.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "absl/status/status.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/discovery/track_scheduler.h"

namespace mortise::pareto {

struct DiscoveryOptions {
  // Whether a surrogate proposes designs (surrogate_search.h) after the space-filling ones, at some
  // 5 to 100 ms each. Automatically it has the turns that it earns (surrogate_turns.h), at most two
  // of five of the first thousand, for up to 40 parameters, unless all gradients are offered;
  // always it has four of five.
  enum class Surrogate { kAutomatic, kAlways, kNever };

  std::int64_t evaluations = 1000;  // budget, 1 to 10,000,000
  std::uint64_t seed = 1;
  int window = 8;  // evaluations under way at once, 1 to 4096; part of what is computed
  // The cells per angle of the buffer, up to 10,000; 0 stands for 1000 for d = 2, and 100 for 3.
  // For d > 3 it is the finest (0 stands for 64), and the buffer adapts so that one cell for four
  // evaluations is occupied, 50 to 4,000.
  int cells_per_angle = 0;
  int constraints = 0;      // m, told with each evaluation, 0 to 64
  int initial_samples = 0;  // space-filling designs at the start; 0: D + 3, with constraints D +
                            // 23, at most a quarter of the budget
  Surrogate surrogate = Surrogate::kAutomatic;
  // The designs of the space to evaluate before any other, D x n, fewer than `evaluations`; see
  // warm_start.h.
  Eigen::MatrixXd initial_designs = {};
  double delta_b = 1e-2;   // tolerance of the buffer, scaled performance
  double delta_i = 1e-4;   // improvement of hypervolume (relative) that counts as progress
  int stall_tracks = 300;  // optimisations in a row without progress that end it; 0: never
  // True if proposals go by every result told so far rather than by those that the window makes
  // sure of. This is for a caller that tells at times which depend on nothing but seed and
  // answers.
  bool uses_all_told = false;
  TrackScheduler::Options scheduling;
};

// Checks the options of a discovery of `metric_count` metrics in `space`, which has been checked.
// INVALID_ARGUMENT naming the option at fault ("evaluations", "window", "initial_designs[2]", ...),
// or "objectives" for a number of metrics that is not 1 to 6.
absl::Status Validate(const DiscoveryOptions& options, const DesignSpace& space,
                      Eigen::Index metric_count);

}  // namespace mortise::pareto
