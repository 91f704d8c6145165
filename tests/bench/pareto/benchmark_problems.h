// The published problems that discovery is measured against, with exact gradients.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/pareto/archive/evaluation.h"
#include "services/pareto/models/combinations.h"

namespace mortise::pareto {

struct BenchmarkProblem {
  std::string name;
  DesignSpace space;
  Eigen::Index metric_count = 2;
  int constraint_count = 0;
  // The metrics of a design, with their Jacobian if asked for.
  std::function<Evaluation(const Eigen::VectorXd& x, bool gradients)> evaluate;
  Eigen::VectorXd reference;  // d, for the hypervolume
  double hypervolume = 0;     // of the true front against `reference`; 0 where it is not known
  std::vector<DiscreteParameter> choices = {};
  // Whether choices and whole numbers are parameters like others, rounded: to compare with.
  bool rounded = false;
};

// How a problem differs from the published one. Its distance parameters (ZDT: all but the first;
// DTLZ: all but the first d - 1) become y = R (x - s), measured from where the best of them is, so
// that the true front stays what it was, but no optimum lies on a bound, and none can be found
// parameter by parameter. Terms that are not even count |y|.
struct BenchmarkVariant {
  bool shifted = false;        // the best of each is somewhere in the middle 40 % of its range
  bool rotated = false;        // R is a random rotation
  std::uint64_t instance = 1;  // seeds s, R, and Fourier's coefficients
  int metrics = 0;  // d, 2 to 6, where the problem leaves it open (DTLZ: 3; Fourier: 2, if 0)
};

// ZDT1, 2, 3, 4, 6 (Zitzler, Deb, Thiele 2000; D >= 2), DTLZ1 to 7 (Deb, Thiele, Laumanns, Zitzler
// 2002; two to six metrics, D >= d), Kursawe (1991; D = 3), and Fourier (Eq. 7.7 with K = 3; two to
// six metrics, x in [0, 2 pi]^D). With constraints: BNH (Binh, Korn 1997; D = 2), SRN (Srinivas,
// Deb 1994; D = 2), TNK (Tanaka and others 1995; D = 2) and OSY (Osyczka, Kundu 1995; D = 6). Those
// of winding_problems.h. With choices and whole numbers those of mixed_problems.h. Names are as
// written here, in any case. INVALID_ARGUMENT naming "name", "dimensions", "metrics" or, for those
// that are not ZDT or DTLZ, "variant".
absl::StatusOr<BenchmarkProblem> MakeBenchmarkProblem(const std::string& name, int dimensions,
                                                      const BenchmarkVariant& variant = {});

std::vector<std::string> BenchmarkNames();

// The number of parameters the problem was published with, for so many metrics (0: as published);
// 0 for an unknown name.
int PublishedDimensions(const std::string& name, int metrics = 0);

}  // namespace mortise::pareto
