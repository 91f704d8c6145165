// A discovery on a benchmark problem, in this process, measured.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "absl/status/statusor.h"
#include "services/pareto/discovery/discovery.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {

struct BenchmarkPoint {
  Eigen::VectorXd x;            // D
  Eigen::VectorXd metrics;      // d
  Eigen::VectorXd constraints;  // m, all <= 0
};

struct BenchmarkResult {
  Discovery::Summary summary;
  std::int64_t evaluations = 0;  // counted by the problem; one with gradients counts as one
  double own_seconds = 0;        // of discovery, without the problem's own
  // Every design evaluated that no other dominates, by the first metric, then the second.
  std::vector<BenchmarkPoint> non_dominated;
  double hypervolume = 0;  // of those, against the problem's reference
  Front front;
};

// Discovers the front of `problem`, one evaluation after the other. `progress` is told how far it
// is a hundred times, and `cancelled` asked as often: true stops it with what was found. A seed
// gives the same result each time. INVALID_ARGUMENT naming the option at fault ("evaluations",
// "window", ...).
absl::StatusOr<BenchmarkResult> RunBenchmark(
    const BenchmarkProblem& problem, const Discovery::Options& options, bool gradients,
    const std::function<void(const Discovery::Summary&)>& progress = {},
    const std::function<bool()>& cancelled = {});

}  // namespace mortise::pareto
