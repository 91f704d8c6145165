// A front along one parameter, whole and in parts, and where there is none.
#include "services/pareto/sources/front_traverse.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

constexpr Eigen::Index kAlong = 1;
const Scaling kTraverseScaling{VectorXd::Zero(2), VectorXd::Ones(2)};

// Runs a traverse from `start` to its end. The designs it asked for.
template <typename Metrics>
std::vector<VectorXd> Traverse(Archive& archive, const VectorXd& start, const Metrics& metrics) {
  const std::size_t entry = archive.Add({start, true, metrics(start), {}, {}});
  FrontTraverse traverse({}, archive, kTraverseScaling, entry, kAlong);
  std::vector<VectorXd> asked;
  while (!traverse.Finished()) {
    const auto u = traverse.Ask(archive);
    if (!u) ADD_FAILURE() << "waits for nothing";
    if (!u) break;
    asked.push_back(*u);
    traverse.Tell(archive, archive.Add({*u, true, metrics(*u), {}, {}}));
  }
  return asked;
}

// The quarter circle, steep at its ends, with the third parameter at 0.3.
Eigen::Vector2d Circle(const VectorXd& u) {
  const double angle = u[kAlong] * std::numbers::pi / 2, size = 1 + std::abs(u[2] - 0.3);
  return {size * std::cos(angle), size * std::sin(angle)};
}

// The front of ZDT3, in five parts.
Eigen::Vector2d Parted(const VectorXd& u) {
  const double x = u[kAlong];
  return {x, 1 - std::sqrt(x) - x * std::sin(10 * std::numbers::pi * x)};
}

TEST(FrontTraverse, GoesFromBoundToBoundAndChangesNothingElse) {
  const VectorXd start = Eigen::Vector3d(0.2, 0.4, 0.3);
  Archive archive;
  const std::vector<VectorXd> asked = Traverse(archive, start, Circle);
  EXPECT_LE(asked.size(), 16u);
  double least = 1, most = 0;
  for (const VectorXd& u : asked) {
    EXPECT_EQ(u[0], start[0]);
    EXPECT_EQ(u[2], start[2]);
    least = std::min(least, u[kAlong]);
    most = std::max(most, u[kAlong]);
  }
  EXPECT_EQ(least, 0);
  EXPECT_EQ(most, 1);
}

TEST(FrontTraverse, CoversTheFront) {
  Archive archive;
  Traverse(archive, Eigen::Vector3d(0.2, 0.4, 0.3), Circle);
  std::vector<double> along;
  for (const std::size_t entry : archive.non_dominated()) along.push_back(archive[entry].u[kAlong]);
  std::ranges::sort(along);
  for (std::size_t k = 1; k < along.size(); ++k) EXPECT_LT(along[k] - along[k - 1], 0.15);
  EXPECT_EQ(along.size(), archive.size());
}

TEST(FrontTraverse, CrossesWhatIsDominatedBetweenPartsOfAFront) {
  Archive archive;
  Traverse(archive, Eigen::Vector3d(0.2, 0.4, 0.3), Parted);
  const double parts[5][2] = {
      {0, 0.083}, {0.182, 0.258}, {0.409, 0.454}, {0.618, 0.653}, {0.823, 0.852}};
  const auto found = std::ranges::count_if(parts, [&](const auto& part) {
    return std::ranges::any_of(archive.non_dominated(), [&](std::size_t entry) {
      const double x = archive[entry].u[kAlong];
      return x > part[0] - 0.03 && x < part[1] + 0.03;
    });
  });
  EXPECT_GE(found, 4);
}

TEST(FrontTraverse, SpendsNoMoreThanItsFirstValuesOnWhatIsDominated) {
  Archive archive;
  archive.Add({Eigen::Vector3d(0, 0, 0), true, Eigen::Vector2d(0, 0), {}, {}});
  EXPECT_EQ(Traverse(archive, Eigen::Vector3d(0.2, 0.4, 0.9), Circle).size(), 8u);
}

TEST(FrontTraverse, GoesOnBesideWhatFails) {
  Archive archive;
  const VectorXd start = Eigen::Vector3d(0.2, 0.4, 0.3);
  const std::size_t entry = archive.Add({start, true, Circle(start), {}, {}});
  FrontTraverse traverse({}, archive, kTraverseScaling, entry, kAlong);
  int asked = 0;
  while (!traverse.Finished()) {
    // All that it offers, before any of it is told.
    std::vector<VectorXd> offered;
    while (const auto u = traverse.Ask(archive)) offered.push_back(*u);
    ASSERT_FALSE(offered.empty());
    for (const VectorXd& u : offered) {
      ++asked;
      const bool fails = u[kAlong] > 0.5;
      traverse.Tell(archive,
                    archive.Add({u, !fails, fails ? VectorXd() : VectorXd(Circle(u)), {}, {}}));
    }
  }
  EXPECT_GE(asked, 8);
  EXPECT_LE(asked, 16);
  EXPECT_GE(archive.non_dominated().size(), 5u);
}

}  // namespace
}  // namespace mortise::pareto
