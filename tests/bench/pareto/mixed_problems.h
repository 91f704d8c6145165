// Benchmark problems with choices and whole numbers, whose true fronts are known.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {

// MixedZDT1, 2, 3 (D >= 4) and MixedDTLZ2 (D >= 5): the published problems with a choice of six and
// a whole number of eight (48 combinations) after their position parameters. Three of the choices
// reach a third of the front each, by their first parameter; the others none of it, though at first
// they look better. Each has an optimum of its own in the distance parameters and in the whole
// number. The true front is the published one.
//
// DiscBrake (Ray, Liew 2002; the number of friction surfaces is 2 to 20), WeldedBeam (after Deb,
// Goyal 1996: two kinds of weld, four materials, plates in sixteenths of an inch; cost against
// deflection) and GearTrain (Deb 2000: four gears of 12 to 60 teeth; error of the ratio against the
// largest gear). Names in any case. NOT_FOUND for one that is not here; INVALID_ARGUMENT naming
// "dimensions".
absl::StatusOr<BenchmarkProblem> MakeMixedProblem(const std::string& name, int dimensions);

std::vector<std::string> MixedNames();

// The number of parameters a problem has if nothing else is asked for; 0 for an unknown name.
int MixedDimensions(const std::string& name);

}  // namespace mortise::pareto
