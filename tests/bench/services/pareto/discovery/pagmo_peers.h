// What discovery is measured against: the multi-objective algorithms of pagmo 2.18, as they come.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {

struct Peer {
  std::string algorithm;  // "NSGA-II", "MOEA/D", "NSPSO" or "MACO"
  int population = 0;     // a multiple of 4, at least 8
};

// Each algorithm at each size of population.
std::vector<Peer> Peers(const std::vector<int>& populations);

// The metrics of the first `evaluations` designs that a peer evaluates, in order: its first
// population, then generation after generation. None of them looks ahead to where it will be
// stopped, so a shorter run is the beginning of a longer one.
std::vector<Eigen::VectorXd> RunPeer(const Peer& peer, const BenchmarkProblem& problem,
                                     std::int64_t evaluations, std::uint64_t seed);

}  // namespace mortise::pareto
