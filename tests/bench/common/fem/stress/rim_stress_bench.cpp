// Stress at rims of curved bodies: recovered, and as the mean of elements, beside what is known.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/unit/common/fem/problems/curved_bodies.h"

namespace mortise::simulator {
namespace {

void Print(const CurvedBody& body, bool quadratic) {
  const auto errors = MeasureRim(body, quadratic);
  if (!errors.ok()) {
    std::printf("%-18s %s\n", body.name.c_str(), std::string(errors.status().message()).c_str());
    return;
  }
  const double percent = 100 / body.largest;
  std::printf(
      "%-18s %-9s %7d elements %5d nodes: off by %6.2f %% (mean of elements %6.2f %%), on the mean "
      "%+6.2f %% (%+6.2f %%), at edges %6.2f %% (%6.2f %%), largest %+6.1f %% (%+6.1f %%), "
      "traction %6.2f %% (%6.2f %%)\n",
      body.name.c_str(), quadratic ? "quadratic" : "linear", errors->elements, errors->nodes,
      percent * errors->recovered.stress, percent * errors->mean.stress,
      percent * errors->recovered.bias, percent * errors->mean.bias,
      percent * errors->recovered.at_edges, percent * errors->mean.at_edges,
      percent * errors->recovered.largest - 100, percent * errors->mean.largest - 100,
      percent * errors->recovered.traction, percent * errors->mean.traction);
  std::fflush(stdout);
}

}  // namespace
}  // namespace mortise::simulator

// With an argument: only sizes of elements of at least that many millimetres.
int main(int argc, char** argv) {
  using namespace mortise::simulator;
  const double least = argc > 1 && argv[1][0] != '-' ? 1e-3 * std::atof(argv[1]) : 0;
  for (const bool quadratic : {true, false}) {
    for (const auto body : {PressedRing, PressedBall, PlateWithAHole}) {
      for (const double size : {0.005, 0.003, 0.002, 0.001}) {
        if (size >= least) Print(body(size), quadratic);
      }
    }
    for (const double size : {0.006, 0.004, 0.0025, 0.0015}) {
      if (size >= least) Print(BoredPlate(size), quadratic);
    }
  }
  return 0;
}
