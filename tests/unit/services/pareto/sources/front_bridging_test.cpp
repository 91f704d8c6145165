#include "services/pareto/sources/front_bridging.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

// The front is the quarter circle; its designs are the line u2 = 0.3, away from which it is worse.
ArchiveEntry EntryAt(double along, double across) {
  const VectorXd u = Eigen::Vector2d(along, across);
  const double angle = along * std::numbers::pi / 2, size = 1 + std::abs(across - 0.3);
  return {u, true, Eigen::Vector2d(size * std::cos(angle), size * std::sin(angle)), {}, {}};
}

const Scaling kScaling{VectorXd::Zero(2), VectorXd::Ones(2)};

TEST(FrontBridging, StaysOnAFlatPieceAndWithinTheBox) {
  Archive archive;
  for (const double along : {0.1, 0.2, 0.5, 0.9}) archive.Add(EntryAt(along, 0.3));
  FrontBridging bridging;
  Random random(1);
  const std::vector<Bridge> bridges = bridging.Next(archive, kScaling, 6, random);
  ASSERT_FALSE(bridges.empty());
  EXPECT_LE(bridges.size(), 6u);
  for (const Bridge& bridge : bridges) {
    EXPECT_NEAR(bridge.u[1], 0.3, 1e-12);
    EXPECT_GE(bridge.u.minCoeff(), 0);
    EXPECT_LE(bridge.u.maxCoeff(), 1);
  }
  const auto widest = std::ranges::find_if(
      bridges, [](const Bridge& bridge) { return std::abs(bridge.u[0] - 0.7) < 1e-12; });
  ASSERT_NE(widest, bridges.end()) << "the middle of the widest hole";
  EXPECT_NEAR(widest->length, 0.2, 1e-12);
}

TEST(FrontBridging, FillsTheFront) {
  Archive archive;
  archive.Add(EntryAt(0, 0.3));
  archive.Add(EntryAt(1, 0.3));
  FrontBridging bridging;
  Random random(1);
  for (int round = 0; round < 30; ++round) {
    for (const Bridge& bridge : bridging.Next(archive, kScaling, 8, random)) {
      archive.Add(EntryAt(bridge.u[0], bridge.u[1]));
    }
  }
  double widest = 0, last = 0;
  std::vector<double> along = {1};
  for (const std::size_t entry : archive.non_dominated()) along.push_back(archive[entry].u[0]);
  std::ranges::sort(along);
  for (const double each : along) {
    widest = std::max(widest, each - last);
    last = each;
  }
  EXPECT_LT(widest, 0.05);
}

TEST(FrontBridging, TriesNothingTwice) {
  Archive archive;
  archive.Add(EntryAt(0.2, 0.3));
  archive.Add(EntryAt(0.4, 0.3));
  FrontBridging bridging;
  Random random(1);
  // Between them, and beyond each.
  EXPECT_EQ(bridging.Next(archive, kScaling, 100, random).size(), 3u);
  EXPECT_TRUE(bridging.Next(archive, kScaling, 100, random).empty());
}

TEST(FrontBridging, HasNothingToBridgeWithOnePoint) {
  Archive archive;
  archive.Add(EntryAt(0.2, 0.3));
  FrontBridging bridging;
  Random random(1);
  EXPECT_TRUE(bridging.Next(archive, kScaling, 4, random).empty());
}

}  // namespace
}  // namespace mortise::pareto
