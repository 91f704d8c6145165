// Metrics of how stress is spread over a design, on solids for which it is known.
#include <gtest/gtest.h>

#include <cmath>

#include "services/simulator/analysis/design_analysis.h"
#include "tests/unit/common/fem/problems/curved_bodies.h"
#include "tests/unit/services/simulator/analysis/test_cases.h"

namespace mortise::simulator {
namespace {

const std::vector<std::string> kMetrics{"mean_von_mises", "rms_von_mises", "von_mises_p99",
                                        "von_mises_integral"};

Eigen::VectorXd Values(const DesignModel& model, double element_size, bool quadratic,
                       const std::vector<std::string>& metrics = kMetrics) {
  DesignAnalysisOptions options;
  options.mesh.element_size = element_size;
  options.mesh.quadratic = quadratic;
  const auto analysis = AnalyzeDesign(model, metrics, false, options);
  EXPECT_TRUE(analysis.ok()) << analysis.status();
  Eigen::VectorXd values = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(metrics.size()));
  if (!analysis.ok()) return values;
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    values[static_cast<Eigen::Index>(i)] = analysis->metrics[i].value;
  }
  return values;
}

// Lamé's hollow ball: σ_v = c / r³, c = 3/2 p a³ b³ / (b³ − a³), over an eighth of the ball.
TEST(StressMetrics, OfAPressedBallConvergeToThoseOfLame) {
  constexpr double kInner = 0.01, kOuter = 0.02, kPressure = 1e6;
  const double a3 = std::pow(kInner, 3), b3 = std::pow(kOuter, 3);
  const double c = 1.5 * kPressure * a3 * b3 / (b3 - a3);
  const double volume = M_PI / 6 * (b3 - a3);
  const double integral = M_PI / 2 * c * std::log(kOuter / kInner);
  const double square = M_PI / 6 * c * c * (1 / a3 - 1 / b3);
  Eigen::VectorXd exact(4);
  exact << integral / volume, std::sqrt(square / volume), c / (a3 + 0.01 * (b3 - a3)), integral;
  const auto error = [&](double size, bool quadratic) {
    return Eigen::VectorXd(
        (Values(PressedBall(size).model, size, quadratic) - exact).cwiseQuotient(exact));
  };
  const Eigen::VectorXd coarse = error(0.008, true), fine = error(0.004, true);
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_LT(std::abs(coarse[i]), i == 2 ? 0.1 : 0.01) << kMetrics[static_cast<std::size_t>(i)];
    EXPECT_LT(std::abs(fine[i]), i == 2 ? 0.03 : 2e-3) << kMetrics[static_cast<std::size_t>(i)];
  }
  // Linear elements come to the same, more slowly.
  const Eigen::VectorXd linear = error(0.003, false);
  for (Eigen::Index i = 0; i < 4; ++i) {
    EXPECT_LT(std::abs(linear[i]), i == 2 ? 0.15 : 0.08) << kMetrics[static_cast<std::size_t>(i)];
  }
}

// Mean von Mises stress of a cantilever of square section under a force at its end, by the theory
// of beams: F x z / I of bending, and 3/2 F / A (1 − (2z/h)²) of shear. Pa.
double MeanOfBeam(double force, double length, double height) {
  constexpr int kSteps = 400;
  const double area = height * height, inertia = area * area / 12;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    for (int j = 0; j < kSteps; ++j) {
      const double x = (i + 0.5) / kSteps * length, z = ((j + 0.5) / kSteps - 0.5) * height;
      const double bending = force * x * z / inertia;
      const double shear = 1.5 * force / area * (1 - std::pow(2 * z / height, 2));
      sum += std::sqrt(bending * bending + 3 * shear * shear);
    }
  }
  return sum / (kSteps * kSteps);
}

// At the rim of the clamp the largest stress has no limit; what the volume has does.
TEST(StressMetrics, HaveALimitWhereTheLargestStressHasNone) {
  const DesignModel beam = Cantilever(0.4, 0.05, 100, 0.3);
  const std::vector<std::string> metrics{"max_von_mises", "von_mises_p99", "mean_von_mises"};
  const Eigen::VectorXd coarse = Values(beam, 0.025, true, metrics);
  const Eigen::VectorXd fine = Values(beam, 0.008, true, metrics);
  EXPECT_GT(fine[0], 1.1 * coarse[0]);
  EXPECT_NEAR(fine[1], coarse[1], 0.03 * fine[1]);
  EXPECT_NEAR(fine[2], coarse[2], 0.01 * fine[2]);
  const double theory = MeanOfBeam(100, 0.4, 0.05);
  EXPECT_NEAR(fine[2], theory, 0.02 * theory);
}

// As with all that is under loads, the worst load case counts.
TEST(StressMetrics, AreOfTheWorstLoadCase) {
  DesignModel beam = Cantilever(0.4, 0.05, 100, 0.3);
  const Eigen::VectorXd one = Values(beam, 0.05, true);
  LoadCase strong;
  strong.forces.push_back({{0, "x_max"}, {0, 0, 300}});
  beam.load_cases = {{"weak", {}}, {"strong", strong}};
  const Eigen::VectorXd worst = Values(beam, 0.05, true);
  EXPECT_NEAR((worst - 2 * one).cwiseQuotient(one).cwiseAbs().maxCoeff(), 0, 1e-8);
}

// A bar that is held at both ends and warmed: σ = E α ΔT.
TEST(StressMetrics, KnowTheStressOfWarmth) {
  DesignModel bar;
  bar.surface = mesh::AssembleBoxes({{"bar", {0, 0, 0}, {0.4, 0.05, 0.05}}});
  Material steel{"steel", 7850, 210e9, 0, 0};
  steel.thermal_expansion = 1.2e-5;
  steel.conductivity = 50;
  bar.analysis.materials = {steel};
  for (const char* face : {"x_min", "x_max", "y_min", "z_min"}) {
    Support& plane = bar.analysis.supports.emplace_back(Support{{0, face}});
    plane.symmetric = true;
  }
  bar.heat = HeatCase{.materials = {steel},
                      .temperatures = {{{0, "x_min"}, 373.15}},
                      .fluxes = {},
                      .convections = {},
                      .sources = {}};
  bar.reference_temperature = 293.15;
  const double stress = 210e9 * 1.2e-5 * 80;
  const Eigen::VectorXd values = Values(bar, 0.05, true);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(values[i], stress, 1e-7 * stress);
  EXPECT_NEAR(values[3], stress * 0.4 * 0.05 * 0.05, 1e-7 * stress * 0.001);
}

// What is not asked for is not computed.
TEST(StressMetrics, AloneTakeTheSpread) {
  const DesignModel beam = Cantilever(0.4, 0.05, 100, 0.3);
  DesignAnalysisOptions options;
  options.mesh.element_size = 0.05;
  const auto without = AnalyzeDesign(beam, {"max_von_mises"}, false, options);
  ASSERT_TRUE(without.ok()) << without.status();
  EXPECT_FALSE(without->cases[0].spread.has_value());
  EXPECT_FALSE(without->cases[0].error.has_value());
  const auto with = AnalyzeDesign(beam, {"von_mises_integral"}, false, options);
  ASSERT_TRUE(with.ok()) << with.status();
  EXPECT_TRUE(with->cases[0].spread.has_value());
  EXPECT_FALSE(with->cases[0].error.has_value());
}

}  // namespace
}  // namespace mortise::simulator
