// Benchmark problems whose optima wind through the space or hide among many others.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {

// UF1 and UF7 (Zhang and others 2008; D >= 3): where the first parameter is x the best of parameter
// j is sin(6 pi x + j pi / D), so that a step along the front moves all. WFG4 (Huband, Hingston,
// Barone, While 2006; two metrics, D >= 3, two of them position parameters): hundreds of local
// optima of each distance parameter. Names in any case. NOT_FOUND for one that is not here;
// INVALID_ARGUMENT naming "dimensions".
absl::StatusOr<BenchmarkProblem> MakeWindingProblem(const std::string& name, int dimensions);

std::vector<std::string> WindingNames();

// The number of parameters a problem has if nothing else is asked for; 0 for an unknown name.
int WindingDimensions(const std::string& name);

}  // namespace mortise::pareto
