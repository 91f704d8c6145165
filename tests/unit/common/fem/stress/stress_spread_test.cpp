// How von Mises stress is spread over the volume, against cases that can be told by hand.
#include "common/fem/stress/stress_spread.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "common/fem/elements/shape_functions.h"
#include "common/fem/problems/elasticity.h"
#include "tests/unit/common/fem/problems/clamped_box.h"

namespace mortise::simulator {
namespace {

using Eigen::Vector3d;

constexpr double kRelative = 1e-12;

const Vector3d kSize(0.4, 0.05, 0.06);  // m
double VolumeOfBox() { return kSize.prod(); }

Material SteelOf(double poissons_ratio) {
  Material steel = Steel();
  steel.poissons_ratio = poissons_ratio;
  steel.thermal_expansion = 1.2e-5;
  return steel;
}

// Of elements with straight sides, which hold quadratic displacements exactly; the nodes of BoxMesh
// are moved.
mesh::TetrahedralMesh StraightBox(const Eigen::Vector3i& cells, bool quadratic = true) {
  mesh::MappedBox box;
  for (int k = 0; k < 3; ++k) box.ticks[static_cast<std::size_t>(k)] = mesh::Ticks(cells[k]);
  box.place = [](const Vector3d& uvw) -> Vector3d { return kSize.cwiseProduct(uvw); };
  return mesh::MeshMappedBox(box, quadratic);
}

using Field = std::function<Vector3d(const Vector3d& x)>;
Eigen::Matrix3Xd AtNodes(const mesh::TetrahedralMesh& mesh, const Field& field) {
  Eigen::Matrix3Xd values(3, mesh.nodes.cols());
  for (Eigen::Index v = 0; v < values.cols(); ++v) values.col(v) = field(mesh.nodes.col(v));
  return values;
}

StressSpread Spread(const mesh::TetrahedralMesh& mesh, const Material& material, const Field& field,
                    const Eigen::VectorXd& temperature = {}) {
  ThreadTeam team(2);
  return SpreadOf(mesh, {material}, AtNodes(mesh, field), temperature, team);
}

// Stretched along x by `strain`, contracting freely.
Field Pulled(double strain, double poissons_ratio) {
  return [=](const Vector3d& x) -> Vector3d {
    return strain * Vector3d(x.x(), -poissons_ratio * x.y(), -poissons_ratio * x.z());
  };
}

// Bent about y through the middle of the height to the curvature κ, 1/m, without a force: σxx = −E
// κ (z − h/2).
Field Bent(double curvature, double poissons_ratio) {
  return [=](const Vector3d& x) -> Vector3d {
    const double z = x.z() - kSize.z() / 2, y = x.y();
    const double nu = poissons_ratio;
    return curvature * Vector3d(-x.x() * z, nu * y * z, (x.x() * x.x() + nu * (z * z - y * y)) / 2);
  };
}

TEST(StressSpread, OfAPulledBarIsOneStress) {
  const Material steel = SteelOf(0.3);
  const double stress = 1e-4 * steel.youngs_modulus;
  for (const bool quadratic : {false, true}) {
    const auto bar = BoxMesh(kSize, {5, 2, 3}, quadratic);
    const StressSpread spread = Spread(bar, steel, Pulled(1e-4, 0.3));
    EXPECT_NEAR(spread.Volume(), VolumeOfBox(), kRelative * VolumeOfBox());
    EXPECT_NEAR(spread.Mean(), stress, kRelative * stress);
    EXPECT_NEAR(spread.RootMeanSquare(), stress, kRelative * stress);
    EXPECT_NEAR(spread.Integral(), stress * VolumeOfBox(), kRelative * stress * VolumeOfBox());
    for (const double share : {0.0, 0.5, 0.99, 1.0}) {
      EXPECT_NEAR(spread.Percentile(share), stress, 1e-9 * stress) << share;
    }
  }
}

// |σ| = 2 σ_max |z| / h is as often each value up to the largest: its mean is a half of that, the
// root of its mean square 1/√3, and 99 % of it is below 0.99. Stress is linear, and so its square
// is integrated exactly; |σ| is but for the layer in the middle, with its kink.
TEST(StressSpread, OfPureBendingConvergesToHalfOfTheLargest) {
  const Material steel = SteelOf(0.3);
  const double largest = 0.01 * steel.youngs_modulus * kSize.z() / 2;
  for (const int layers : {3, 9, 27}) {
    const StressSpread spread = Spread(StraightBox({2, 1, layers}), steel, Bent(0.01, 0.3));
    EXPECT_NEAR(spread.RootMeanSquare(), largest / std::sqrt(3.0), kRelative * largest);
    const double allowed = 0.0025 / (layers * layers);
    EXPECT_NEAR(spread.Mean(), largest / 2, allowed * largest) << layers;
  }
  const StressSpread fine = Spread(StraightBox({2, 1, 81}), steel, Bent(0.01, 0.3));
  EXPECT_NEAR(fine.Percentile(0.99), 0.99 * largest, 2e-3 * largest);
  EXPECT_NEAR(fine.Percentile(0.5), 0.5 * largest, 3e-3 * largest);
  // Where sides of elements lie in the neutral plane none holds the kink.
  const StressSpread even = Spread(StraightBox({2, 1, 2}), steel, Bent(0.01, 0.3));
  EXPECT_NEAR(even.Mean(), largest / 2, kRelative * largest);
}

// A block that stands under its own weight: σzz = −ρ g (h − z), with ν = 0 exactly.
TEST(StressSpread, OfABlockUnderItsOwnWeightIsHalfOfThatAtItsFoot) {
  const Material steel = SteelOf(0);
  const double foot = steel.density * 9.81 * kSize.z();
  for (const bool quadratic : {false, true}) {
    AnalysisCase standing;
    standing.materials = {steel};
    standing.supports.push_back({{0, "w_min"}});
    standing.gravity = {0, 0, -9.81};
    double last_error = 1;
    for (const int cells : {2, 4, 8}) {
      const auto block = StraightBox({2, 2, cells}, quadratic);
      const auto solved = SolveElasticity(block, standing);
      ASSERT_TRUE(solved.ok()) << solved.status();
      ThreadTeam team(1);
      const StressSpread spread = SpreadOf(block, {steel}, solved->displacement, {}, team);
      const double error = std::abs(spread.Mean() / foot - 0.5);
      if (quadratic) {
        EXPECT_NEAR(spread.Mean(), foot / 2, 1e-8 * foot);
        EXPECT_NEAR(spread.RootMeanSquare(), foot / std::sqrt(3.0), 1e-8 * foot);
      } else {
        EXPECT_LT(error, 0.6 * last_error) << cells;
        EXPECT_LT(error, 0.2 / cells) << cells;
      }
      last_error = error;
    }
  }
}

// Held at both ends and free across, a bar that warms is pressed by E α ΔT; where ΔT grows along
// it, by that of each place.
TEST(StressSpread, OfAWarmBarIsThatOfTheExpansionThatIsHeld) {
  const Material steel = SteelOf(0);
  const double at_end = steel.youngs_modulus * steel.thermal_expansion * 80;
  for (const bool quadratic : {false, true}) {
    const auto bar = BoxMesh(kSize, {4, 2, 2}, quadratic);
    const auto free_across = [&](const Vector3d& x) -> Vector3d {
      return steel.thermal_expansion * 80 * Vector3d(0, x.y(), x.z());
    };
    const Eigen::VectorXd even = Eigen::VectorXd::Constant(bar.nodes.cols(), 80);
    EXPECT_NEAR(Spread(bar, steel, free_across, even).Mean(), at_end, kRelative * at_end);
    // Free all round nothing is under stress.
    const auto free = [&](const Vector3d& x) -> Vector3d {
      return steel.thermal_expansion * 80 * x;
    };
    EXPECT_NEAR(Spread(bar, steel, free, even).Percentile(1), 0, 1e-9 * at_end);
  }
  // ΔT = 80 x / L moves a bar that may bulge by α ΔT along y and z, and bends nothing where its
  // axis is y = z = 0: u = α 80 / L (−(y² + z²) / 2, x y, x z).
  const auto bar = StraightBox({4, 2, 2});
  const double slope = steel.thermal_expansion * 80 / kSize.x();
  const auto bulged = [&](const Vector3d& x) -> Vector3d {
    return slope * Vector3d(-(x.y() * x.y() + x.z() * x.z()) / 2, x.x() * x.y(), x.x() * x.z());
  };
  const Eigen::VectorXd growing = 80 / kSize.x() * bar.nodes.row(0).transpose();
  const StressSpread spread = Spread(bar, steel, bulged, growing);
  EXPECT_NEAR(spread.Mean(), at_end / 2, 1e-9 * at_end);
  EXPECT_NEAR(spread.RootMeanSquare(), at_end / std::sqrt(3.0), 1e-9 * at_end);
}

TEST(StressSpread, CountsVolumesRatherThanPoints) {
  StressSpread spread;
  spread.von_mises = Eigen::Vector3d(30, 10, 20);
  spread.volume = Eigen::Vector3d(1, 2, 1);
  EXPECT_DOUBLE_EQ(spread.Mean(), 17.5);
  EXPECT_DOUBLE_EQ(spread.Integral(), 70);
  EXPECT_DOUBLE_EQ(spread.RootMeanSquare(), std::sqrt(375.0));
  for (const double share : {0.0, 0.25, 0.5}) EXPECT_EQ(spread.Percentile(share), 10) << share;
  for (const double share : {0.51, 0.75}) EXPECT_EQ(spread.Percentile(share), 20) << share;
  for (const double share : {0.76, 1.0}) EXPECT_EQ(spread.Percentile(share), 30) << share;
}

TEST(StressSpread, OfPartsAddsUpToThatOfAll) {
  auto bar = BoxMesh(kSize, {4, 2, 2}, true);
  bar.part_names = {"left", "right"};
  for (Eigen::Index e = 0; e < bar.part.size(); ++e) {
    bar.part[e] = ElementPositions(bar, e).row(0).mean() > kSize.x() / 2 ? 1 : 0;
  }
  Material soft = SteelOf(0.3);
  soft.youngs_modulus /= 4;
  ThreadTeam team(2);
  const StressSpread all =
      SpreadOf(bar, {SteelOf(0.3), soft}, AtNodes(bar, Pulled(1e-4, 0.3)), {}, team);
  const StressSpread left = SpreadInPart(bar, all, 0), right = SpreadInPart(bar, all, 1);
  const double stress = 1e-4 * Steel().youngs_modulus;
  EXPECT_NEAR(left.Mean(), stress, kRelative * stress);
  EXPECT_NEAR(right.Mean(), stress / 4, kRelative * stress);
  EXPECT_NEAR(left.Integral() + right.Integral(), all.Integral(), kRelative * all.Integral());
  EXPECT_EQ(SpreadInPart(bar, all, 2).volume.size(), 0);
}

TEST(StressSpread, IsTheSameForAnyNumberOfThreads) {
  const auto bar = BoxMesh(kSize, {9, 4, 4}, true);
  const Eigen::Matrix3Xd u = AtNodes(bar, Bent(0.01, 0.3));
  ThreadTeam one(1), three(3);
  const StressSpread alone = SpreadOf(bar, {Steel()}, u, {}, one);
  const StressSpread shared = SpreadOf(bar, {Steel()}, u, {}, three);
  EXPECT_EQ(alone.von_mises, shared.von_mises);
  EXPECT_EQ(alone.volume, shared.volume);
}

// Against central differences along a random motion of displacements and of nodes.
TEST(StressSpread, HasTheDerivativesOfDifferences) {
  std::mt19937 bits(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (const bool quadratic : {false, true}) {
    auto bar = BoxMesh(kSize, {3, 2, 2}, quadratic);
    bar.part_names = {"left", "right"};
    for (Eigen::Index e = 0; e < bar.part.size(); ++e) bar.part[e] = e % 3 == 0 ? 1 : 0;
    Material wood = Steel();
    wood.orthotropy = Orthotropy{.youngs_modulus = {11e9, 0.9e9, 0.5e9},
                                 .poissons_ratio = {0.4, 0.5, 0.45},
                                 .shear_modulus = {0.7e9, 0.05e9, 0.6e9},
                                 .axes = GrainAxes({1, 0.4, 0.2}, {0, 0, 1})};
    const std::vector<Material> materials{Steel(), wood};
    const auto random = [&](double size) {
      Eigen::Matrix3Xd field(3, bar.nodes.cols());
      for (double& value : field.reshaped()) value = size * any(bits);
      return field;
    };
    const Eigen::Matrix3Xd u = random(1e-4), du = random(1), dx = random(1);
    ThreadTeam team(2);
    for (const SpreadMeasure measure :
         {SpreadMeasure::kIntegral, SpreadMeasure::kMean, SpreadMeasure::kRootMeanSquare}) {
      for (const int part : {-1, 0, 1}) {
        const auto value = [&](double by_u, double by_x) {
          mesh::TetrahedralMesh moved = bar;
          moved.nodes += by_x * dx;
          const StressSpread all = SpreadOf(moved, materials, u + by_u * du, {}, team);
          return ValueOf(measure, part < 0 ? all : SpreadInPart(moved, all, part));
        };
        const SpreadDerivative derivative = DerivativeOf(measure, bar, materials, u, part, team);
        EXPECT_NEAR(derivative.value, value(0, 0), kRelative * derivative.value);
        constexpr double kBy = 1e-8, kMove = 1e-7;
        const double by_u = (value(kBy, 0) - value(-kBy, 0)) / (2 * kBy);
        const double by_x = (value(0, kMove) - value(0, -kMove)) / (2 * kMove);
        EXPECT_NEAR((derivative.by_displacement.array() * du.array()).sum(), by_u,
                    1e-5 * std::abs(by_u));
        EXPECT_NEAR((derivative.by_position.array() * dx.array()).sum(), by_x,
                    1e-5 * std::abs(by_x));
      }
    }
  }
}

// A body at rest has no stress, and so nothing that could be steep.
TEST(StressSpread, OfABodyAtRestIsNothing) {
  const auto bar = BoxMesh(kSize, {2, 1, 1}, true);
  const Eigen::Matrix3Xd none = Eigen::Matrix3Xd::Zero(3, bar.nodes.cols());
  ThreadTeam team(1);
  for (const SpreadMeasure measure :
       {SpreadMeasure::kIntegral, SpreadMeasure::kMean, SpreadMeasure::kRootMeanSquare}) {
    const SpreadDerivative derivative = DerivativeOf(measure, bar, {Steel()}, none, -1, team);
    EXPECT_EQ(derivative.value, 0);
    EXPECT_TRUE(derivative.by_displacement.isZero(0));
    EXPECT_TRUE(derivative.by_position.isZero(0));
  }
}

}  // namespace
}  // namespace mortise::simulator
