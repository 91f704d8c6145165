// Invariants of the performance buffer and of the archive's scaling.
#include "services/pareto/archive/performance_buffer.h"

#include <gtest/gtest.h>

#include "common/base/random.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

Archive RandomArchive(int count, Eigen::Index d, std::uint64_t seed) {
  Random random(seed);
  Archive archive;
  for (int i = 0; i < count; ++i) {
    ArchiveEntry entry;
    entry.u = VectorXd::Constant(1, random.Uniform());
    entry.evaluated = random.Uniform() > 0.1;
    if (entry.evaluated) entry.metrics = random.UnitVector(d).cwiseAbs() * (1 + random.Uniform());
    archive.Add(entry);
  }
  return archive;
}

// Cells per angle follow from how many cells that makes.
TEST(PerformanceBuffer, BecomesCoarserUntilCellsAreFewEnough) {
  PerformanceBuffer::Options options;
  options.cells_per_angle = 64;
  options.cell_limit = 150;
  const Archive archive = RandomArchive(2000, 5, 4);
  PerformanceBuffer buffer(options, 5);
  buffer.Rebuild(archive, archive.CurrentScaling());
  EXPECT_LE(buffer.cells().size(), 150u);
  EXPECT_GT(buffer.cells().size(), 30u);
  EXPECT_LT(buffer.cells_per_angle(), 64);
  // As few entries make few cells, they stay fine.
  const Archive small = RandomArchive(40, 5, 4);
  buffer.Rebuild(small, small.CurrentScaling());
  EXPECT_EQ(buffer.cells_per_angle(), 64);
}

TEST(PerformanceBuffer, IsToBeRebuiltWhenCellsBecomeTooMany) {
  PerformanceBuffer::Options options;
  options.cells_per_angle = 64;
  options.cell_limit = 20;
  Archive archive = RandomArchive(15, 4, 4);
  PerformanceBuffer buffer(options, 4);
  const Scaling scaling{VectorXd::Zero(4), VectorXd::Ones(4)};
  buffer.Rebuild(archive, scaling);
  Random random(5);
  int inserted = 0;
  while (!buffer.NeedsRebuild(scaling) && inserted < 1000) {
    ArchiveEntry entry;
    entry.u = VectorXd::Zero(1);
    entry.evaluated = true;
    entry.metrics = random.UnitVector(4).cwiseAbs();
    buffer.Insert(archive.Add(entry), entry.metrics);
    ++inserted;
  }
  EXPECT_LT(inserted, 100);
  EXPECT_EQ(buffer.cells().size(), 41u);
  buffer.Rebuild(archive, scaling);
  EXPECT_LE(buffer.cells().size(), 20u);
  EXPECT_FALSE(buffer.NeedsRebuild(scaling));
}

class BufferTest : public testing::TestWithParam<int> {};

TEST_P(BufferTest, HoldsItsInvariants) {
  const Eigen::Index d = GetParam();
  PerformanceBuffer::Options options;
  options.cells_per_angle = 20;
  options.tolerance = 0.2;
  options.candidates_per_cell = 5;
  const Archive archive = RandomArchive(2000, d, 3);
  PerformanceBuffer buffer(options, d);
  buffer.Rebuild(archive, archive.CurrentScaling());
  ASSERT_FALSE(buffer.cells().empty());
  for (const auto& [cell, candidates] : buffer.cells()) {
    EXPECT_GE(cell, 0);
    EXPECT_LT(cell, buffer.CellCount());
    ASSERT_FALSE(candidates.empty());
    EXPECT_LE(candidates.size(), 5u);
    double previous = candidates.front().distance;
    for (const auto& candidate : candidates) {
      EXPECT_TRUE(archive[candidate.entry].feasible);
      const VectorXd scaled = buffer.scaling().Apply(archive[candidate.entry].metrics);
      EXPECT_EQ(buffer.CellOf(scaled), cell);
      EXPECT_DOUBLE_EQ(candidate.distance, scaled.norm());
      EXPECT_GE(candidate.distance, previous);
      EXPECT_LE(candidate.distance, candidates.front().distance + 0.2);
      previous = candidate.distance;
    }
  }
}

TEST_P(BufferTest, KeepsTheNearestOfEachCell) {
  const Eigen::Index d = GetParam();
  PerformanceBuffer::Options options;
  options.cells_per_angle = 10;
  const Archive archive = RandomArchive(500, d, 8);
  PerformanceBuffer buffer(options, d);
  buffer.Rebuild(archive, archive.CurrentScaling());
  for (std::size_t i = 0; i < archive.size(); ++i) {
    if (!archive[i].feasible) continue;
    const VectorXd scaled = buffer.scaling().Apply(archive[i].metrics);
    const auto cell = buffer.cells().find(buffer.CellOf(scaled));
    ASSERT_NE(cell, buffer.cells().end());
    EXPECT_LE(cell->second.front().distance, scaled.norm());
  }
}

TEST_P(BufferTest, DirectionsLieInTheirCells) {
  const Eigen::Index d = GetParam();
  PerformanceBuffer::Options options;
  options.cells_per_angle = 12;
  const PerformanceBuffer buffer(options, d);
  for (PerformanceBuffer::CellId cell = 0; cell < buffer.CellCount(); ++cell) {
    EXPECT_NEAR(buffer.DirectionOf(cell).norm(), 1, 1e-12);
    EXPECT_EQ(buffer.CellOf(3 * buffer.DirectionOf(cell)), cell);
  }
}

INSTANTIATE_TEST_SUITE_P(Metrics, BufferTest, testing::Values(2, 3));

TEST(BufferTest, AsksForARebuildWhenIdealOrNadirMoveByATenth) {
  PerformanceBuffer buffer({}, 2);
  const Scaling scaling{VectorXd::Zero(2), VectorXd::Ones(2)};
  EXPECT_TRUE(buffer.NeedsRebuild(scaling));
  buffer.Rebuild(Archive(), scaling);
  EXPECT_FALSE(buffer.NeedsRebuild(scaling));
  EXPECT_FALSE(buffer.NeedsRebuild({VectorXd::Constant(2, 0.05), VectorXd::Ones(2)}));
  EXPECT_TRUE(buffer.NeedsRebuild({VectorXd::Constant(2, 0.11), VectorXd::Ones(2)}));
  EXPECT_TRUE(buffer.NeedsRebuild({VectorXd::Zero(2), Eigen::Vector2d(1, 1.2)}));
}

TEST(ArchiveTest, ScalesFromIdealToNadirOfTheNonDominated) {
  Archive archive;
  for (const Eigen::Vector2d& metrics :
       {Eigen::Vector2d(0, 4), Eigen::Vector2d(2, 1), Eigen::Vector2d(9, 9)}) {
    archive.Add({VectorXd::Zero(1), true, metrics, {}, {}});
  }
  EXPECT_EQ(archive.non_dominated().size(), 2u);
  EXPECT_EQ(archive.CurrentScaling().ideal, Eigen::Vector2d(0, 1));
  EXPECT_EQ(archive.CurrentScaling().range, Eigen::Vector2d(2, 3));
}

TEST(ArchiveTest, ScalesAConstantMetricByOne) {
  Archive archive;
  archive.Add({VectorXd::Zero(1), true, Eigen::Vector2d(3, 7), {}, {}});
  EXPECT_EQ(archive.CurrentScaling().range, Eigen::Vector2d(1, 1));
}

}  // namespace
}  // namespace mortise::pareto
