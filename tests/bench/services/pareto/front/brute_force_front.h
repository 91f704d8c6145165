// A front by brute force: a grid over the box, then a local optimisation from the best of it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/pareto/archive/archive.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {

struct BruteForceFront {
  std::vector<Eigen::VectorXd> designs;      // unit coordinates; none dominates another
  std::vector<Eigen::VectorXd> performance;  // scaled
  Scaling scaling;
};

// `steps` of the grid along each parameter: for three parameters or so. Two or three metrics, a
// smooth problem.
BruteForceFront FindByBruteForce(const BenchmarkProblem& problem, int steps);

// Which stretch of continuous designs each lies on, numbered from 0 along the front: neighbours
// along the front are on the same one if their designs are within a tenth of the parameters'
// ranges.
std::vector<int> StretchesOf(const BruteForceFront& front);

// Two metrics: how many straight lines through design space, each from a design of a stretch to
// another, perform within `tolerance` of the front all along, taken greedily. 0 for three metrics.
int CountStraightPieces(const BenchmarkProblem& problem, const BruteForceFront& front,
                        double tolerance = 1e-2);

}  // namespace mortise::pareto
