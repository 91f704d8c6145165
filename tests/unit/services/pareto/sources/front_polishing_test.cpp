// Designs pushed on to fronts that are known.
#include "services/pareto/sources/front_polishing.h"

#include <gtest/gtest.h>

#include <cmath>

#include "common/base/random.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr Eigen::Index kParameters = 4;

// Best at `kParameters` coordinates of a curve over the first: u2 = 0.5 + 0.2 sin(3 u1), u3 = 0.3,
// u4 = 0, where the metrics are u1 and 1 - sqrt(u1).
VectorXd OnCurve(double t) {
  VectorXd u(kParameters);
  u << t, 0.5 + 0.2 * std::sin(3 * t), 0.3, 0;
  return u;
}

VectorXd MetricsOf(const VectorXd& u) {
  const double off = std::pow(u[1] - OnCurve(u[0])[1], 2) + 2 * std::pow(u[2] - 0.3, 2) + u[3];
  return Eigen::Vector2d(u[0] + off, 1 - std::sqrt(u[0]) + off);
}

// Designs along the curve, `spread` off it, and some further off, as a search leaves them behind.
Archive AroundCurve(int count, double spread) {
  Random random(5);
  Archive archive;
  for (int i = 0; i < 40; ++i) {
    const VectorXd u = (OnCurve(random.Uniform()) + 0.1 * random.UnitVector(kParameters))
                           .cwiseMax(0.0)
                           .cwiseMin(1.0);
    archive.Add({u, true, MetricsOf(u), {}, {}});
  }
  for (int i = 0; i < count; ++i) {
    VectorXd u = OnCurve(0.2 + 0.6 * i / (count - 1)) + spread * random.UnitVector(kParameters);
    if (i % 2 == 0) u[3] = 0;
    u = u.cwiseMax(0.0).cwiseMin(1.0);
    archive.Add({u, true, MetricsOf(u), {}, {}});
  }
  return archive;
}

TEST(FrontPolishing, MovesDesignsOnToTheFront) {
  const Archive archive = AroundCurve(120, 0.02);
  const Scaling scaling = archive.CurrentScaling();
  for (const double t : {0.3, 0.41, 0.5, 0.66}) {
    VectorXd u = OnCurve(t);
    u[1] += 0.02;
    u[2] -= 0.015;
    const PolishedDesign polished = Polished(archive, scaling, u, 0.05);
    const auto off = [](const VectorXd& v) { return (v - OnCurve(v[0])).norm(); };
    EXPECT_LT(off(polished.u), 0.3 * off(u)) << t;
    // What it says to gain is what it gains.
    const VectorXd gained = (MetricsOf(u) - MetricsOf(polished.u)).cwiseQuotient(scaling.range);
    EXPECT_GT(polished.gain, 0);
    EXPECT_LT(polished.gain, 2 * gained.norm());
    EXPECT_EQ(polished.u[3], 0) << "a bound is kept";
  }
}

TEST(FrontPolishing, LeavesTheFrontWhereItIs) {
  const Archive archive = AroundCurve(120, 0.01);
  const PolishedDesign polished = Polished(archive, archive.CurrentScaling(), OnCurve(0.45), 0.05);
  EXPECT_LT(polished.gain, 1e-3);
  EXPECT_LT((polished.u - OnCurve(polished.u[0])).norm(), 0.01);
}

TEST(FrontPolishing, KeepsToConstraints) {
  Random random(5);
  Archive archive;
  // The curve's second coordinate is 0.7 in the middle.
  const auto limit = [](const VectorXd& u) { return u[1] - 0.69; };
  for (int i = 0; i < 120; ++i) {
    const VectorXd u = (OnCurve(0.2 + 0.6 * i / 119) + 0.05 * random.UnitVector(kParameters))
                           .cwiseMax(0.0)
                           .cwiseMin(1.0);
    ArchiveEntry entry{u, true, MetricsOf(u), {}, {}};
    entry.constraints = VectorXd::Constant(1, limit(u));
    archive.Add(std::move(entry));
  }
  VectorXd u = OnCurve(0.5);
  u[1] = 0.67;
  const PolishedDesign polished = Polished(archive, archive.CurrentScaling(), u, 0.05);
  EXPECT_LT(limit(polished.u), 1e-4);
  EXPECT_GT(polished.u[1], 0.68) << "about as far as the limit allows";
}

TEST(FrontPolishing, TakesThoseOfAFrontThatGain) {
  const Archive archive = AroundCurve(60, 0.005);
  PerformanceBuffer buffer({.cells_per_angle = 100}, 2);
  buffer.Rebuild(archive, archive.CurrentScaling());
  const std::vector<VectorXd> few = FrontPolishing().Next(archive, buffer, 5, {});
  EXPECT_EQ(few.size(), 5u);
  int better = 0;
  for (const VectorXd& u : few) {
    EXPECT_TRUE((u.array() >= 0).all() && (u.array() <= 1).all());
    better += archive.ClearlyDominated(MetricsOf(u), buffer.scaling(), 0) ? 0 : 1;
  }
  EXPECT_GE(better, 4) << "what none dominates";
  EXPECT_TRUE(FrontPolishing().Next(archive, buffer, 0, {}).empty());
}

TEST(FrontPolishing, EndsWhereNothingGainsAnyMore) {
  Archive archive = AroundCurve(60, 0.005);
  FrontPolishing polishing;
  std::size_t asked = 0, last = 0;
  for (int round = 0; round < 20; ++round) {
    PerformanceBuffer buffer({.cells_per_angle = 100}, 2);
    buffer.Rebuild(archive, archive.CurrentScaling());
    const std::vector<VectorXd> designs = polishing.Next(archive, buffer, 1000, {});
    for (const VectorXd& u : designs) archive.Add({u, true, MetricsOf(u), {}, {}});
    last = designs.size();
    asked += last;
  }
  EXPECT_GT(asked, 30u);
  EXPECT_EQ(last, 0u);
}

// |u - a_i|^2 for three corners a_i of a triangle in the plane u3 = 0.5: the front is the triangle.
VectorXd ThreeMetrics(const VectorXd& u) {
  const Eigen::Vector3d a(0.2, 0.2, 0.5), b(0.8, 0.2, 0.5), c(0.5, 0.8, 0.5);
  return Eigen::Vector3d((u - a).squaredNorm(), (u - b).squaredNorm(), (u - c).squaredNorm());
}

// Where a metric has no weight: below the edge of the triangle from a to b.
TEST(FrontPolishing, ReachesTheEdgeOfTheFrontFromOutside) {
  Random random(2);
  Archive archive;
  for (int i = 0; i < 400; ++i) {
    const VectorXd u = Eigen::Vector3d(0.2 + 0.6 * random.Uniform(), 0.1 + 0.2 * random.Uniform(),
                                       0.4 + 0.2 * random.Uniform());
    archive.Add({u, true, ThreeMetrics(u), {}, {}});
  }
  const Scaling scaling = archive.CurrentScaling();
  for (const double t : {0.35, 0.5, 0.61}) {
    const VectorXd u = Eigen::Vector3d(t, 0.17, 0.51);
    const PolishedDesign polished = Polished(archive, scaling, u, 0.05);
    EXPECT_NEAR(polished.u[1], 0.2, 0.004) << t;
    EXPECT_NEAR(polished.u[2], 0.5, 0.006) << t;
    EXPECT_GT(polished.gain, 0);
    EXPECT_TRUE((ThreeMetrics(polished.u).array() < ThreeMetrics(u).array()).all()) << t;
  }
}

}  // namespace
}  // namespace mortise::pareto
