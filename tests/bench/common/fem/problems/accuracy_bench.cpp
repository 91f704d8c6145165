// Published targets at the sizes people compare: quadratic at about 60,000 tetrahedra, linear at
// about 200,000, and how the error falls with refinement.
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "tests/unit/common/fem/problems/published_targets.h"

namespace mortise::simulator {
namespace {

struct Row {
  TargetAnswer (*solve)(int n, bool quadratic);
  double elements;  // at n = 1
  std::vector<int> quadratic, linear;
};

TargetAnswer HardPlate(int n, bool quadratic) {
  return ThickPlateVibration(n, quadratic, PlateSupport::kHard);
}
TargetAnswer SoftPlate(int n, bool quadratic) {
  return ThickPlateVibration(n, quadratic, PlateSupport::kSoft);
}
TargetAnswer PlateOnEdges(int n, bool quadratic) {
  return ThickPlateVibration(n, quadratic, PlateSupport::kEdges);
}

void Print(const TargetAnswer& answer, bool quadratic) {
  std::printf("%-26s %-9s %7d tetrahedra %7d unknowns %7.2f s  %14.6g of %.6g: %+.3f %%\n",
              answer.what.c_str(), quadratic ? "quadratic" : "linear", answer.elements,
              answer.unknowns, answer.seconds, answer.value, answer.target, 100 * answer.error());
  std::fflush(stdout);
}

}  // namespace
}  // namespace mortise::simulator

// With an argument: only the sizes up to that number of elements, in thousands.
int main(int argc, char** argv) {
  using namespace mortise::simulator;
  const double most = argc > 1 && argv[1][0] != '-' ? 1e3 * std::atof(argv[1]) : 300e3;
  const Row rows[] = {{ThickPlate, 36, {4, 8, 10, 12}, {8, 12, 18}},
                      {PlateWithHole, 864, {1, 2, 4}, {2, 4, 6}},
                      {ThickCylinder, 576, {1, 2, 3, 5}, {2, 4, 6, 7}},
                      {ThickCylinderWidening, 576, {1, 2, 5}, {2, 4, 7}},
                      {Cantilever3d, 48, {2, 4, 8, 11}, {4, 8, 14, 16}},
                      {TaperedSphere, 630, {1, 2, 3, 4, 5}, {2, 4, 5, 6, 7}},
                      {PlateWithConvection, 90, {4, 8, 26}, {8, 26, 47}},
                      {HardPlate, 96, {2, 4, 8}, {4, 8, 12}},
                      {SoftPlate, 96, {2, 4}, {}},
                      {PlateOnEdges, 96, {2, 4}, {}}};
  for (const Row& row : rows) {
    for (const bool quadratic : {true, false}) {
      for (const int n : quadratic ? row.quadratic : row.linear) {
        // Plates of one layer grow with n² only.
        const double elements = row.elements * n * n * (row.solve == PlateWithConvection ? 1 : n);
        if (elements <= most) Print(row.solve(n, quadratic), quadratic);
      }
    }
  }
  return 0;
}
