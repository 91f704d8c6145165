// The one file that pagmo is compiled in.
#include "tests/bench/services/pareto/discovery/pagmo_peers.h"

#include <algorithm>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/maco.hpp>
#include <pagmo/algorithms/moead.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/algorithms/nspso.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <utility>

namespace mortise::pareto {
namespace {

// A benchmark problem as pagmo wants it, which keeps the answers. pagmo copies its problems, so the
// answers are elsewhere.
struct RecordedProblem {
  const BenchmarkProblem* problem = nullptr;
  std::vector<Eigen::VectorXd>* answers = nullptr;

  pagmo::vector_double fitness(const pagmo::vector_double& x) const {
    const Eigen::VectorXd metrics =
        problem
            ->evaluate(Eigen::VectorXd::Map(x.data(), static_cast<Eigen::Index>(x.size())), false)
            .metrics;
    answers->push_back(metrics);
    return {metrics.begin(), metrics.end()};
  }

  std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const {
    const auto& [lower, upper, step] = problem->space;
    return {{lower.begin(), lower.end()}, {upper.begin(), upper.end()}};
  }

  pagmo::vector_double::size_type get_nobj() const {
    return static_cast<pagmo::vector_double::size_type>(problem->metric_count);
  }

  // Other threads would put the answers out of order.
  pagmo::thread_safety get_thread_safety() const { return pagmo::thread_safety::none; }
};

// With pagmo's own settings but for those that a small population does not allow, and weights of
// MOEA/D, whose grid wants certain sizes of population where there are three metrics.
pagmo::algorithm Make(const Peer& peer, Eigen::Index metric_count, unsigned generations,
                      unsigned seed) {
  const auto population = static_cast<unsigned>(peer.population);
  if (peer.algorithm == "NSGA-II") {
    pagmo::nsga2 algorithm(generations);
    algorithm.set_seed(seed);
    return pagmo::algorithm(algorithm);
  }
  if (peer.algorithm == "MOEA/D") {
    pagmo::moead algorithm(generations, metric_count == 2 ? "grid" : "low discrepancy",
                           "tchebycheff", std::min(20u, population / 2));
    algorithm.set_seed(seed);
    return pagmo::algorithm(algorithm);
  }
  if (peer.algorithm == "NSPSO") {
    pagmo::nspso algorithm(generations);
    algorithm.set_seed(seed);
    return pagmo::algorithm(algorithm);
  }
  pagmo::maco algorithm(generations, std::min(63u, population));
  algorithm.set_seed(seed);
  return pagmo::algorithm(algorithm);
}

}  // namespace

std::vector<Peer> Peers(const std::vector<int>& populations) {
  std::vector<Peer> peers;
  for (const char* algorithm : {"NSGA-II", "MOEA/D", "NSPSO", "MACO"}) {
    for (const int population : populations) peers.push_back({algorithm, population});
  }
  return peers;
}

std::vector<Eigen::VectorXd> RunPeer(const Peer& peer, const BenchmarkProblem& problem,
                                     std::int64_t evaluations, std::uint64_t seed) {
  std::vector<Eigen::VectorXd> answers;
  pagmo::population population(pagmo::problem(RecordedProblem{&problem, &answers}),
                               static_cast<unsigned>(peer.population), static_cast<unsigned>(seed));
  const std::int64_t generations = (evaluations - 1) / peer.population;  // after the first
  if (generations > 0) {
    Make(peer, problem.metric_count, static_cast<unsigned>(generations),
         static_cast<unsigned>(seed))
        .evolve(population);
  }
  answers.resize(std::min(answers.size(), static_cast<std::size_t>(evaluations)));
  return answers;
}

}  // namespace mortise::pareto
