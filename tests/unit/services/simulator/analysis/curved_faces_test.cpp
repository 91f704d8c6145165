// Solids with curved faces, from their exact surfaces to stresses that are known.
#include <gtest/gtest.h>

#include <cmath>

#include "services/simulator/analysis/design_analysis.h"
#include "tests/unit/common/fem/problems/curved_bodies.h"

namespace mortise::simulator {
namespace {

DesignAnalysis Solved(const DesignModel& model, double element_size) {
  DesignAnalysisOptions options;
  options.mesh.element_size = element_size;
  auto analysis = AnalyzeDesign(model, {"max_displacement", "max_von_mises"}, false, options);
  EXPECT_TRUE(analysis.ok()) << analysis.status();
  return *std::move(analysis);
}

// The stress along a direction at the node nearest to a place.
double StressNear(const DesignAnalysis& analysis, const Eigen::Vector3d& place, int component) {
  Eigen::Index node = 0;
  (analysis.mesh->nodes.colwise() - place).colwise().squaredNorm().minCoeff(&node);
  return analysis.cases[0].solution.stress(component, node);
}

// A plate with a hole of 20 mm under the tractions of Kirsch's solution (1898) for 1 MPa along x at
// infinity, in plane strain: three times as much at the hole.
TEST(CurvedFacesTest, ConcentrateStressAtAHole) {
  constexpr double kRadius = 0.01, kThickness = 0.004, kPull = 1e6, kSize = 0.002;
  const DesignModel model = PlateWithAHole(kSize).model;
  const DesignAnalysis analysis = Solved(model, kSize);
  EXPECT_NEAR(StressNear(analysis, {0, kRadius, kThickness / 2}, 0), 3 * kPull, 0.03 * kPull);
  EXPECT_NEAR(StressNear(analysis, {kRadius, 0, kThickness / 2}, 1), -kPull, 0.03 * kPull);
}

// Lamé's thick cylinder, 20 mm inside and 40 mm outside, under 1 MPa inside, in plane strain.
TEST(CurvedFacesTest, HoldAPressureInside) {
  constexpr double kInner = 0.01, kOuter = 0.02, kPressure = 1e6, kSize = 0.002;
  const DesignModel model = PressedRing(kSize).model;
  const DesignAnalysis analysis = Solved(model, kSize);
  const double a2 = kInner * kInner, b2 = kOuter * kOuter;
  const double hoop = kPressure * (a2 + b2) / (b2 - a2);
  const double widening = kPressure * kInner * 1.3 * (0.4 * a2 + b2) / (200e9 * (b2 - a2));
  EXPECT_NEAR(analysis.metrics[0].value, widening, 5e-4 * widening);
  int inside = 0;
  for (Eigen::Index v = 0; v < analysis.mesh->nodes.cols(); ++v) {
    const Eigen::Vector2d at = analysis.mesh->nodes.col(v).head<2>();
    if (at.norm() > 1.001 * kInner) continue;
    const Eigen::Vector2d t = Eigen::Vector2d(-at.y(), at.x()).normalized();
    const auto stress = analysis.cases[0].solution.stress.col(v);
    const double found =
        stress[0] * t.x() * t.x() + stress[1] * t.y() * t.y() + 2 * stress[3] * t.x() * t.y();
    EXPECT_NEAR(found, hoop, 0.02 * hoop) << "at " << at.transpose();
    ++inside;
  }
  EXPECT_GT(inside, 20);
}

}  // namespace
}  // namespace mortise::simulator
