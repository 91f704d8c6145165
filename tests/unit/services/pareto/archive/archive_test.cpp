// The running set of trade-offs against a filter of all that was evaluated.
#include "services/pareto/archive/archive.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "common/base/random.h"
#include "services/pareto/archive/non_dominated.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

ArchiveEntry RandomEntry(Eigen::Index d, Random& random) {
  ArchiveEntry entry;
  entry.u.resize(3);
  for (double& value : entry.u) value = random.Uniform();
  entry.evaluated = random.Uniform() > 0.1;
  if (!entry.evaluated) return entry;
  entry.metrics.resize(d);
  // Few values, so that some are equal.
  for (double& value : entry.metrics) value = static_cast<double>(random.Index(12));
  entry.constraints = VectorXd::Constant(1, random.Uniform() - 0.8);
  return entry;
}

TEST(Archive, KeepsWhatNothingDominatesAsItGrows) {
  for (const Eigen::Index d : {2, 4}) {
    Random random(static_cast<std::uint64_t>(d));
    Archive archive;
    std::vector<VectorXd> metrics;      // of feasible entries
    std::vector<std::size_t> entries;   // their indices
    std::vector<std::size_t> previous;  // trade-offs
    for (int i = 0; i < 300; ++i) {
      const std::size_t entry = archive.Add(RandomEntry(d, random));
      if (archive[entry].feasible) {
        metrics.push_back(archive[entry].metrics);
        entries.push_back(entry);
      }
      std::vector<std::size_t> expected;
      for (const std::size_t k : NonDominated(metrics)) expected.push_back(entries[k]);
      ASSERT_EQ(archive.non_dominated(), expected);
      const auto columns = archive.non_dominated_metrics();
      ASSERT_EQ(columns.cols(), std::ssize(expected));
      for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_EQ(columns.col(static_cast<Eigen::Index>(k)), archive[expected[k]].metrics);
      }
      std::vector<std::size_t> gone;
      std::ranges::set_difference(previous, expected, std::back_inserter(gone));
      EXPECT_EQ(archive.displaced(), gone);
      previous = expected;
    }
  }
}

TEST(Archive, FindsTheNearestDesigns) {
  Random random(8);
  Archive archive;
  for (int i = 0; i < 200; ++i) archive.Add(RandomEntry(2, random));
  const VectorXd u = VectorXd::Constant(3, 0.4);
  const std::vector<std::size_t> nearest = archive.Nearest(u, 10);
  ASSERT_EQ(nearest.size(), 10u);
  const auto distance = [&](std::size_t entry) { return (archive[entry].u - u).norm(); };
  EXPECT_TRUE(std::ranges::is_sorted(nearest, {}, distance));
  for (std::size_t entry = 0; entry < archive.size(); ++entry) {
    if (!archive[entry].evaluated || std::ranges::find(nearest, entry) != nearest.end()) continue;
    EXPECT_GE(distance(entry), distance(nearest.back()));
  }
}

TEST(Archive, TellsWhatIsClearlyDominated) {
  Archive archive;
  for (const Eigen::Vector2d& metrics : {Eigen::Vector2d(0, 4), Eigen::Vector2d(2, 0)}) {
    ArchiveEntry entry;
    entry.u = VectorXd::Zero(1);
    entry.evaluated = true;
    entry.metrics = metrics;
    archive.Add(entry);
  }
  const Scaling scaling{Eigen::Vector2d(0, 0), Eigen::Vector2d(2, 4)};
  const auto dominated = [&](double a, double b) {
    return archive.ClearlyDominated(Eigen::Vector2d(a, b), scaling, 0.1);
  };
  EXPECT_TRUE(dominated(0.21, 4.41));   // by the margin in both
  EXPECT_FALSE(dominated(0.21, 4.01));  // in one only
  EXPECT_TRUE(dominated(0.7, 4));       // by three times the margin in one
  EXPECT_FALSE(dominated(-0.1, 9));
  EXPECT_FALSE(dominated(1, 1));
}

TEST(Archive, MeasuresDistancesInLengths) {
  Archive archive;
  archive.Add({Eigen::Vector2d(0.2, 0), true, Eigen::Vector2d(0, 1), {}, {}});
  archive.Add({Eigen::Vector2d(0, 0.3), true, Eigen::Vector2d(1, 0), {}, {}});
  const VectorXd origin = VectorXd::Zero(2);
  EXPECT_EQ(archive.lengths(), VectorXd::Ones(2));
  EXPECT_EQ(archive.Nearest(origin, 2), (std::vector<std::size_t>{0, 1}));
  archive.UseLengths(Eigen::Vector2d(0.5, 1));
  EXPECT_EQ(archive.Nearest(origin, 2), (std::vector<std::size_t>{1, 0}));
}

}  // namespace
}  // namespace mortise::pareto
