#include "services/interpolator/shapes/shape_difference.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>

#include "common/base/errors.h"
#include "tests/unit/services/interpolator/shapes/block_designs.h"
#include "tests/unit/services/interpolator/shapes/brought_design.h"

namespace mortise::interpolator {
namespace {

const BlockCells kCells{.along = 6, .across = 4, .high = 3};

fields::DesignFields Box(const Eigen::Vector3d& size) {
  return BlockDesign(BoxShape(size), kCells);
}

class Comparing : public testing::Test {
 protected:
  BlendedShape Blended(const fields::DesignFields& design, const BlendedParts& parts) const {
    const PackedShape packed = Pack(Brought(design, mesh_).value().shape, mesh_).value();
    BlendedShape blended;
    EXPECT_TRUE(Blend(std::vector<WeightedShape>{{&packed, 1}}, mesh_, parts, blended).ok());
    return blended;
  }

  const CanonicalMesh mesh_ = CanonicalMesh::Create(Box({2, 1, 0.5})).value();
  const BlendedParts everything_{false, {0, 1, 2, 3}};
};

TEST_F(Comparing, FindsNothingBetweenADesignAndItself) {
  const fields::DesignFields truth = Box({2.2, 1, 0.5});
  const ConsistentShape brought = Brought(truth, mesh_).value().shape;
  const ShapeDifference difference =
      Difference(Blended(truth, everything_), mesh_, truth, &brought).value();
  EXPECT_NEAR(difference.size, Eigen::Vector3d(2.2, 1, 0.5).norm(), 1e-12);
  EXPECT_LT(difference.shape.largest, 1e-5 * difference.size);
  const std::vector<FieldRange> ranges = RangesOf(brought);
  ASSERT_EQ(difference.fields.size(), 4u);
  for (std::size_t f = 0; f < 4; ++f) {
    EXPECT_LT(difference.fields[f].largest, 3e-5 * ranges[f].length());
  }
}

// A box that is longer by d: its end is off by d, everything else lies on the other's surface.
TEST_F(Comparing, TellsHowFarSurfacesAreApart) {
  const ShapeDifference difference =
      Difference(Blended(Box({2, 1, 0.5}), {true, {}}), mesh_, Box({2.1, 1, 0.5}), nullptr).value();
  EXPECT_NEAR(difference.to_truth.largest, 0.1, 1e-4);    // the end face, which is inside
  EXPECT_NEAR(difference.from_truth.largest, 0.1, 1e-4);  // and sticks out
  EXPECT_NEAR(difference.shape.largest, 0.1, 1e-4);
  EXPECT_LE(difference.shape.of_99, difference.shape.largest);
  EXPECT_LT(difference.shape.mean, difference.shape.of_99);
  EXPECT_TRUE(difference.fields.empty());
}

// What sticks out of one surface is far from the other, though nothing of that is far from it.
TEST_F(Comparing, LooksFromBothSides) {
  fields::DesignFields spiked = Box({2, 1, 0.5});
  int corner = 0;
  spiked.nodes.colwise().squaredNorm().maxCoeff(&corner);
  spiked.nodes.col(corner) += Eigen::Vector3d(3, 0, 0);
  const BlendedShape plain = Blended(Box({2, 1, 0.5}), {true, {}});
  const ShapeDifference there = Difference(plain, mesh_, spiked, nullptr).value();
  EXPECT_NEAR(there.from_truth.largest, 3, 1e-4);
  EXPECT_LT(there.to_truth.largest, 0.5);
  const ShapeDifference back =
      Difference(Blended(spiked, {true, {}}), mesh_, Box({2, 1, 0.5}), nullptr).value();
  EXPECT_NEAR(back.to_truth.largest, 3, 1e-3);
  EXPECT_NEAR(there.shape.largest, 3, 1e-3);
  EXPECT_NEAR(back.shape.largest, 3, 1e-3);
  EXPECT_LT(back.shape.mean, 0.2);
}

// A design is as round as its 6-node triangles are: a quarter as far from a circle as its corners'
// triangles.
TEST(CurvedSides, AreWhatIsMeasuredTo) {
  const fields::DesignFields fine =
      BlockDesign(CylinderShape(1, 1), {.along = 24, .across = 24, .high = 2});
  const CanonicalMesh mesh = CanonicalMesh::Create(fine).value();
  const PackedShape packed = Pack(Brought(fine, mesh).value().shape, mesh).value();
  BlendedShape blended;
  ASSERT_TRUE(Blend(std::vector<WeightedShape>{{&packed, 1}}, mesh, {true, {}}, blended).ok());
  const fields::DesignFields flat =
      BlockDesign(CylinderShape(1, 1), {.along = 6, .across = 6, .high = 2});
  fields::DesignFields curved = Quadratic(flat);
  for (Eigen::Index t = 0; t < curved.triangles.cols(); ++t) {
    for (int side = 0; side < 3; ++side) {
      const auto at = [&](int k) { return curved.nodes.col(curved.triangles(k, t)).head<2>(); };
      if (at(side).norm() < 0.999 || at((side + 1) % 3).norm() < 0.999) continue;
      if ((at(side) - at((side + 1) % 3)).norm() > 0.5) continue;  // not a chord of the rim
      at(3 + side) /= at(3 + side).norm();
    }
  }
  const double of_flat = Difference(blended, mesh, flat, nullptr).value().to_truth.largest;
  const double of_curved = Difference(blended, mesh, curved, nullptr).value().to_truth.largest;
  EXPECT_GT(of_flat, 0.01);
  EXPECT_LT(of_curved, 0.3 * of_flat);
}

TEST_F(Comparing, TakesLengthsOfVectorsAndTensors) {
  const fields::DesignFields truth = Box({2, 1, 0.5});
  ConsistentShape brought = Brought(truth, mesh_).value().shape;
  brought.fields[0].array() -= 7;
  brought.fields[1].colwise() += Eigen::Vector3d(3, 0, 4);
  Eigen::Matrix<double, 6, 1> tensor;
  tensor << 1e6, 0, 0, 2e6, 0, 0;
  brought.fields[2].colwise() += tensor;
  brought.fields[3].col(5) += Eigen::Vector3d(0, 1000, 0);
  const ShapeDifference difference =
      Difference(Blended(truth, everything_), mesh_, truth, &brought).value();
  EXPECT_NEAR(difference.fields[0].largest, 7, 0.01);
  EXPECT_NEAR(difference.fields[0].mean, 7, 0.01);
  EXPECT_NEAR(difference.fields[1].of_99, 5, 1e-4);
  EXPECT_NEAR(difference.fields[2].mean, 3e6, 2e3);  // 1² + 2 · 2² = 3²
  EXPECT_NEAR(difference.fields[3].largest, 1000, 0.1);
  EXPECT_LT(difference.fields[3].of_99, 0.1);
}

TEST_F(Comparing, RefusesWhatIsOfAnotherMesh) {
  const fields::DesignFields truth = Box({2, 1, 0.5});
  const ConsistentShape brought = Brought(truth, mesh_).value().shape;
  BlendedShape blended = Blended(truth, everything_);
  ConsistentShape other = brought;
  other.fields.pop_back();
  EXPECT_EQ(DetailOf(Difference(blended, mesh_, truth, &other).status()).field,
            "truth_brought.fields");
  fields::DesignFields damaged = truth;
  damaged.nodes(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(DetailOf(Difference(blended, mesh_, damaged, &brought).status()).field, "truth.nodes");
  blended.positions.resize(12);
  EXPECT_EQ(DetailOf(Difference(blended, mesh_, truth, &brought).status()).field, "blended");
}

TEST(Spread, IsOfTheBestNinetyNineOfAHundred) {
  std::vector<double> numbers(200);
  std::iota(numbers.rbegin(), numbers.rend(), 1);
  const Spread spread = SpreadOf(numbers);
  EXPECT_EQ(spread.largest, 200);
  EXPECT_EQ(spread.of_99, 198);
  EXPECT_EQ(spread.mean, 100.5);
  std::vector<double> one = {3};
  EXPECT_EQ(SpreadOf(one).of_99, 3);
  std::vector<double> none;
  EXPECT_EQ(SpreadOf(none).largest, 0);
}

TEST(FieldRange, IsOfAllShapesTogether) {
  FieldRange range{-1, 2};
  range.Include({0, 5});
  range.Include({-3, 1});
  EXPECT_EQ(range.minimum, -3);
  EXPECT_EQ(range.maximum, 5);
  EXPECT_EQ(range.length(), 8);
}

TEST(FieldRange, IsTheSameOfAPackedShape) {
  const CanonicalMesh mesh = CanonicalMesh::Create(Box({2, 1, 0.5})).value();
  const ConsistentShape shape = Brought(Box({2, 1, 1}), mesh).value().shape;
  const std::vector<FieldRange> exact = RangesOf(shape);
  const std::vector<FieldRange> packed = RangesOf(Pack(shape, mesh).value());
  ASSERT_EQ(exact.size(), 4u);
  for (std::size_t f = 0; f < exact.size(); ++f) {
    EXPECT_EQ(packed[f].minimum, exact[f].minimum);
    EXPECT_NEAR(packed[f].maximum, exact[f].maximum, 1e-12 * std::abs(exact[f].maximum));
  }
}

}  // namespace
}  // namespace mortise::interpolator
