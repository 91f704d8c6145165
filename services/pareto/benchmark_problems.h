// The published problems that discovery is measured against, with exact gradients.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/pareto/evaluation.h"

namespace mortise::pareto {

struct BenchmarkProblem {
  std::string name;
  DesignSpace space;
  Eigen::Index metric_count = 2;
  // The metrics of a design, with their Jacobian if asked for.
  std::function<Evaluation(const Eigen::VectorXd& x, bool gradients)> evaluate;
  Eigen::VectorXd reference;  // d, for the hypervolume
  double hypervolume = 0;     // of the true front against `reference`; 0 where it is not known
};

// ZDT1, 2, 3, 4, 6 (Zitzler, Deb, Thiele 2000; D >= 2), DTLZ1, 2, 3 (Deb et al. 2002; three
// metrics, D >= 3), Kursawe (1991; D = 3), and Fourier (Eq. 7.7 with K = 3; two metrics,
// coefficients from `seed`, x in [0, 2 pi]^D). Names are as written here, in any case.
// INVALID_ARGUMENT naming "name" or "dimensions".
absl::StatusOr<BenchmarkProblem> MakeBenchmarkProblem(const std::string& name, int dimensions,
                                                      std::uint64_t seed = 1);

std::vector<std::string> BenchmarkNames();

}  // namespace mortise::pareto
