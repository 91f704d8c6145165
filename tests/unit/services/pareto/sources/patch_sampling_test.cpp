// A walk along an affine piece of a front: what it covers, and where it ends.
#include "services/pareto/sources/patch_sampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;
using SurfaceMetrics = std::function<VectorXd(const VectorXd&)>;

ArchiveEntry EntryWithGradients(const SurfaceMetrics& metrics, const VectorXd& u) {
  constexpr double kStep = 1e-6;
  ArchiveEntry entry{u, true, metrics(u), {}, {}};
  entry.jacobian.resize(entry.metrics.size(), u.size());
  for (Eigen::Index i = 0; i < u.size(); ++i) {
    VectorXd before = u, after = u;
    before[i] -= kStep;
    after[i] += kStep;
    entry.jacobian.col(i) = (metrics(after) - metrics(before)) / (2 * kStep);
  }
  return entry;
}

// Runs a walk from `centre` to its end; how many designs it asked for.
int WalkPiece(Archive& archive, const SurfaceMetrics& metrics, const VectorXd& centre,
              const PatchSampling::Options& options) {
  const std::size_t entry = archive.Add(EntryWithGradients(metrics, centre));
  const Eigen::Index d = archive[entry].metrics.size();
  PatchSampling patch(options, {VectorXd::Zero(d), VectorXd::Ones(d)}, entry);
  int asked = 0;
  while (!patch.Finished()) {
    const auto u = patch.Ask(archive);
    if (!u && patch.Finished()) break;
    if (!u) ADD_FAILURE() << "waits for nothing";
    if (!u) break;
    EXPECT_GE(u->minCoeff(), 0);
    EXPECT_LE(u->maxCoeff(), 1);
    ++asked;
    patch.Tell(archive, archive.Add(EntryWithGradients(metrics, *u)));
  }
  return asked;
}

// The front of three metrics is an eighth of the sphere, its designs those with u2 = 0.5; angles
// are as in DTLZ2, to a power.
SurfaceMetrics PowerSphere(double power) {
  return [power](const VectorXd& u) -> VectorXd {
    const double a = std::numbers::pi / 2 * std::pow(u[0], power);
    const double b = std::numbers::pi / 2 * std::pow(u[1], power);
    const double size = 1 + std::pow(u[2] - 0.5, 2);
    return size *
           Eigen::Vector3d(std::cos(a) * std::cos(b), std::cos(a) * std::sin(b), std::sin(a));
  };
}

TEST(PatchSampling, CoversAPieceUpToTheBounds) {
  Archive archive;
  const int asked =
      WalkPiece(archive, PowerSphere(1), Eigen::Vector3d(0.45, 0.4, 0.5), {.evaluations = 2000});
  EXPECT_LT(asked, 2000) << "it ends by itself";
  for (double a = 0; a <= 1; a += 0.1) {
    for (double b = 0; b <= 1; b += 0.1) {
      const VectorXd wanted = PowerSphere(1)(Eigen::Vector3d(a, b, 0.5));
      EXPECT_TRUE(std::ranges::any_of(
          archive.non_dominated(),
          [&](std::size_t entry) { return (archive[entry].metrics - wanted).norm() < 0.075; }))
          << a << " " << b;
    }
  }
}

// To a high power almost all designs are as good as the same one.
TEST(PatchSampling, EndsWhereMetricsStandStillAlongThePiece) {
  Archive archive;
  const int asked = WalkPiece(archive, PowerSphere(100), Eigen::Vector3d(0.995, 0.995, 0.5),
                              {.evaluations = 5000});
  EXPECT_LT(asked, 500);
  EXPECT_GT(archive.non_dominated().size(), 50u);
}

// The same of two metrics, where the walk goes ahead of what it knows and looks beyond its end.
TEST(PatchSampling, EndsAheadOfWhatItKnowsToo) {
  const auto metrics = [](const VectorXd& u) -> VectorXd {
    const double angle = std::numbers::pi / 2 * std::pow(u[0], 400);
    return (1 + std::pow(u[1] - 0.5, 2)) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  };
  Archive archive;
  const int asked = WalkPiece(archive, metrics, Eigen::Vector2d(0.9985, 0.5),
                              {.evaluations = 2000, .probes = 20, .ahead = 3});
  EXPECT_LT(asked, 150);
  EXPECT_GT(archive.non_dominated().size(), 3u);
}

}  // namespace
}  // namespace mortise::pareto
