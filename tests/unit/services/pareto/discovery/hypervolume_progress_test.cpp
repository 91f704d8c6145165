#include "services/pareto/discovery/hypervolume_progress.h"

#include <gtest/gtest.h>

namespace mortise::pareto {
namespace {

using Eigen::Vector2d;

std::size_t AddMetrics(Archive& archive, const Vector2d& metrics) {
  ArchiveEntry entry;
  entry.u = Vector2d(0, 0);
  entry.evaluated = true;
  entry.metrics = metrics;
  return archive.Add(std::move(entry));
}

const Scaling kUnscaled{Vector2d(0, 0), Vector2d(1, 1)};

double VolumeOf(const Archive& archive) {
  return DominatedVolume(archive, kUnscaled, kRunningReference, HypervolumeSamples::kRunning);
}

TEST(HypervolumeProgressTest, MeasuresWhatTheFrontDominates) {
  Archive archive;
  AddMetrics(archive, {0, 1});
  AddMetrics(archive, {1, 0});
  EXPECT_NEAR(VolumeOf(archive), 2 * 1.1 * 0.1 - 0.01, 1e-15);
}

// The volumes are those of staircases, whose steps one can count; the last entry takes two others
// off the front.
TEST(HypervolumeProgressTest, GainsAddUpToTheVolumeWhateverIsDisplaced) {
  Archive archive;
  AddMetrics(archive, {0, 1});
  double volume = VolumeOf(archive);
  for (const Vector2d& metrics :
       {Vector2d(1, 0), Vector2d(0.5, 0.6), Vector2d(0.6, 0.5), Vector2d(0.4, 0.4)}) {
    const std::size_t entry = AddMetrics(archive, metrics);
    volume += GainedVolume(archive, kUnscaled, entry);
    EXPECT_NEAR(volume, VolumeOf(archive), 1e-14) << metrics.transpose();
  }
  EXPECT_EQ(archive.non_dominated().size(), 3u);
}

TEST(HypervolumeProgressTest, GainIsInTheScalingItIsGiven) {
  Archive archive;
  AddMetrics(archive, {0, 10});
  AddMetrics(archive, {10, 0});
  const std::size_t entry = AddMetrics(archive, {5, 5});
  EXPECT_NEAR(GainedVolume(archive, {Vector2d(0, 0), Vector2d(10, 10)}, entry), 0.25, 1e-14);
}

TEST(HypervolumeProgressTest, ShownIsMeasuredAgainWithASixteenthMoreAndAtTheEnd) {
  Archive archive;
  ShownHypervolume shown;
  EXPECT_EQ(shown.At(archive, 5, false), 0) << "nothing is feasible yet";
  AddMetrics(archive, {0, 1});
  AddMetrics(archive, {1, 0});
  EXPECT_EQ(shown.At(archive, 32, false), 0);
  AddMetrics(archive, {0.5, 0.5});
  EXPECT_EQ(shown.At(archive, 34, false), 0);
  EXPECT_EQ(shown.At(archive, 35, false), 0.25);
  AddMetrics(archive, {0.25, 0.25});
  EXPECT_EQ(shown.At(archive, 36, false), 0.25);
  EXPECT_EQ(shown.At(archive, 36, true), 0.5625);
}

TEST(HypervolumeProgressTest, ForgottenShownIsMeasuredAnew) {
  Archive archive;
  ShownHypervolume shown;
  AddMetrics(archive, {0, 1});
  AddMetrics(archive, {1, 0});
  EXPECT_EQ(shown.At(archive, 32, false), 0);
  AddMetrics(archive, {0.5, 0.5});
  EXPECT_EQ(shown.At(archive, 32, true), 0);
  shown.Forget();
  EXPECT_EQ(shown.At(archive, 32, true), 0.25);
}

}  // namespace
}  // namespace mortise::pareto
