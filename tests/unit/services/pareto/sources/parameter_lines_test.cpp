// Lines found among other designs, which parameter trades metrics off, and along which they ripple.
#include "services/pareto/sources/parameter_lines.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "common/base/random.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

const Scaling kLineScaling{VectorXd::Zero(2), VectorXd::Ones(2)};

// `metrics` of designs that take parameter `along` from bound to bound, beside those known.
template <typename Metrics>
void AddLine(Archive& archive, VectorXd u, Eigen::Index along, int count, const Metrics& metrics) {
  for (int k = 0; k < count; ++k) {
    u[along] = static_cast<double>(k) / (count - 1);
    archive.Add({u, true, metrics(u), {}, {}});
  }
}

// The first parameter trades off, the second is the same for both, the third does nothing.
Eigen::Vector2d Trading(const VectorXd& u) { return {u[0] + u[1], 1 - u[0] + u[1]}; }

TEST(ParameterLines, FindsDesignsAlikeButForOneParameterAmongOthers) {
  Archive archive;
  Random random(5);
  const VectorXd first = Eigen::Vector3d(0.31, 0.62, 0.13);
  AddLine(archive, first, 1, 5, Trading);
  for (int k = 0; k < 200; ++k) {
    VectorXd u(3);
    for (double& value : u) value = random.Uniform();
    archive.Add({u, true, Trading(u), {}, {}});
  }
  AddLine(archive, Eigen::Vector3d(0.31, 0.62, 0.5), 2, 4, Trading);
  AddLine(archive, Eigen::Vector3d(0.9, 0.9, 0.5), 0, 3, Trading);  // too few
  const std::vector<ParameterLine> lines = ParameterLines(archive);
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_EQ(lines[0].parameter, 1);
  EXPECT_EQ(lines[0].entries, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(lines[1].parameter, 2);
  for (const ParameterLine& line : lines) {
    for (std::size_t k = 1; k < line.entries.size(); ++k) {
      const VectorXd step = archive[line.entries[k]].u - archive[line.entries[k - 1]].u;
      EXPECT_GT(step[line.parameter], 0);
      EXPECT_EQ((step.array() != 0).count(), 1);
    }
  }
}

TEST(ParameterLines, LeavesOutWhatFailsOrIsThereTwice) {
  Archive archive;
  const auto add = [&](double value, bool evaluated, double constraint) {
    ArchiveEntry entry{Eigen::Vector3d(value, 0.5, 0.5), evaluated, {}, {}, {}};
    if (evaluated) entry.metrics = Trading(entry.u);
    if (evaluated) entry.constraints = VectorXd::Constant(1, constraint);
    archive.Add(std::move(entry));
  };
  for (const double value : {0.0, 0.3, 0.6, 1.0}) add(value, true, -1);
  add(0.3, true, -1);
  add(0.2, false, 0);
  add(0.4, true, 0.1);
  const std::vector<ParameterLine> lines = ParameterLines(archive);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].entries, (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_TRUE(ParameterLines(Archive{}).empty());
}

TEST(TradingParameters, AreThoseThatMakeOneMetricBetterAndAnotherWorse) {
  Archive archive;
  for (Eigen::Index i = 0; i < 3; ++i) {
    AddLine(archive, Eigen::Vector3d(0.31, 0.62, 0.13), i, 5, Trading);
  }
  const std::vector<ParameterLine> lines = ParameterLines(archive);
  EXPECT_EQ(TradingParameters(archive, lines, kLineScaling, 0.1), std::vector<Eigen::Index>{0});
  EXPECT_TRUE(TradingParameters(archive, lines, kLineScaling, 1.5).empty());
}

TEST(TradingParameters, ComeStrongestFirst) {
  const auto metrics = [](const VectorXd& u) -> VectorXd {
    return Eigen::Vector3d(u[0] + 0.3 * u[1], 1 - u[0] + 0.2 * u[2], 1 - 0.3 * u[1] - 0.2 * u[2]);
  };
  Archive archive;
  for (Eigen::Index i = 0; i < 3; ++i) {
    AddLine(archive, Eigen::Vector3d(0.31, 0.62, 0.13), i, 5, metrics);
  }
  const Scaling scaling{VectorXd::Zero(3), VectorXd::Ones(3)};
  EXPECT_EQ(TradingParameters(archive, ParameterLines(archive), scaling, 0.1),
            (std::vector<Eigen::Index>{0, 1, 2}));
}

TEST(RelativeLengths, AreShortWhereMetricsRippleWhateverTheirRange) {
  const auto metrics = [](double size) {
    return [size](const VectorXd& u) {
      const double ripple = u[0] * std::sin(10 * std::numbers::pi * u[0]);
      return Eigen::Vector2d(u[0], size * (1 - ripple + u[1] * u[1] + 0.5 * std::cos(u[2])));
    };
  };
  VectorXd lengths[2];
  for (const int k : {0, 1}) {
    const double size = k == 0 ? 1 : 50;
    Archive archive;
    const VectorXd u = Eigen::Vector3d(0.31, 0.62, 0.13);
    AddLine(archive, u, 0, 16, metrics(size));
    for (const Eigen::Index i : {1, 2}) AddLine(archive, u, i, 5, metrics(size));
    const Scaling scaling{VectorXd::Zero(2), Eigen::Vector2d(1, size)};
    lengths[k] = RelativeLengths(archive, ParameterLines(archive), scaling);
  }
  EXPECT_LT(lengths[0][0], 0.4);
  EXPECT_GE(lengths[0][0], 0.05);
  EXPECT_EQ(lengths[0].tail(2), VectorXd::Ones(2));
  EXPECT_TRUE(lengths[1].isApprox(lengths[0], 1e-9));
}

TEST(RelativeLengths, AreAllTheSameForSmoothMetricsAndWithoutLines) {
  const auto metrics = [](const VectorXd& u) {
    return Eigen::Vector2d(std::exp(u[0]) + u[1] * u[1], std::pow(1.2 - u[0], 3) + u[2]);
  };
  Archive archive;
  archive.Add(
      {Eigen::Vector3d(0.1, 0.2, 0.3), true, metrics(Eigen::Vector3d(0.1, 0.2, 0.3)), {}, {}});
  EXPECT_EQ(RelativeLengths(archive, {}, kLineScaling), VectorXd::Ones(3));
  for (Eigen::Index i = 0; i < 3; ++i) {
    AddLine(archive, Eigen::Vector3d(0.31, 0.62, 0.13), i, 8, metrics);
  }
  EXPECT_EQ(RelativeLengths(archive, ParameterLines(archive), kLineScaling), VectorXd::Ones(3));
}

// Both metrics are sums over parameters with several optima each; the best of the second are
// elsewhere.
TEST(ParameterLines, PutTogetherWhatIsLeastForEachMetric) {
  const auto metrics = [](const VectorXd& u) {
    const auto term = [](double value, double best) {
      return std::pow(value - best, 2) - 0.3 * std::cos(14 * (value - best));
    };
    Eigen::Vector2d sums = Eigen::Vector2d::Zero();
    for (const double value : u) sums += Eigen::Vector2d(term(value, 0.2), term(value, 0.75));
    return VectorXd(sums);
  };
  Archive archive;
  const VectorXd base = Eigen::Vector3d(0.43, 0.51, 0.36);
  AddLine(archive, base, 0, 41, metrics);
  AddLine(archive, base, 2, 41, metrics);
  const std::vector<VectorXd> designs = LeastAlongLines(archive, ParameterLines(archive));
  ASSERT_EQ(designs.size(), 2u);
  EXPECT_NEAR(designs[0][0], 0.2, 0.0126);
  EXPECT_NEAR(designs[0][2], 0.2, 0.0126);
  EXPECT_NEAR(designs[1][0], 0.75, 0.0126);
  EXPECT_NEAR(designs[1][2], 0.75, 0.0126);
  EXPECT_EQ(designs[0][1], 0.51) << "no line tells of it";
  EXPECT_TRUE(LeastAlongLines(archive, {}).empty());
}

}  // namespace
}  // namespace mortise::pareto
