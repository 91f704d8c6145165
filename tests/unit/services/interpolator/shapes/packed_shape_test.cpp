#include "services/interpolator/shapes/packed_shape.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "common/base/errors.h"
#include "tests/unit/services/interpolator/shapes/block_designs.h"

namespace mortise::interpolator {
namespace {

CanonicalMesh BoxMesh(const Eigen::Vector3d& size, const BlockCells& cells) {
  return CanonicalMesh::Create(BlockDesign(BoxShape(size), cells)).value();
}

// Random numbers of sizes from 1e-6 to 1e6, in a random box each.
ConsistentShape RandomShape(const CanonicalMesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> exponent(-6, 6), sign(-1, 1), unit(0, 1);
  const auto fill = [&](auto& numbers) {
    const double size = std::pow(10, exponent(random)), middle = sign(random) * size;
    for (double& number : numbers.reshaped()) number = middle + size * unit(random);
  };
  ConsistentShape shape;
  shape.nodes.resize(3, mesh.node_count());
  for (int axis = 0; axis < 3; ++axis) {
    auto row = shape.nodes.row(axis);
    fill(row);
  }
  for (const FieldKind& kind : mesh.fields) {
    fill(shape.fields.emplace_back(kind.components, mesh.ValueCount(kind)));
  }
  return shape;
}

TEST(PackedShape, IsOffByNoMoreThanItSays) {
  const CanonicalMesh mesh = BoxMesh({1, 1, 1}, {.along = 3, .across = 3, .high = 3});
  for (unsigned seed = 1; seed <= 50; ++seed) {
    const ConsistentShape shape = RandomShape(mesh, seed);
    const PackedShape packed = Pack(shape, mesh).value();
    const ConsistentShape back = Unpack(packed);
    const Eigen::Matrix3Xd moved = back.nodes - shape.nodes;
    const double rounding = 1e-14 * shape.nodes.cwiseAbs().maxCoeff();
    EXPECT_LE(moved.colwise().norm().maxCoeff(), PositionError(packed) + rounding);
    const Eigen::Vector3d sides =
        shape.nodes.rowwise().maxCoeff() - shape.nodes.rowwise().minCoeff();
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(moved.row(axis).cwiseAbs().maxCoeff(), 7.7e-6 * sides[axis]);
    }
    for (std::size_t f = 0; f < shape.fields.size(); ++f) {
      const double off = (back.fields[f] - shape.fields[f]).cwiseAbs().maxCoeff();
      const double range = shape.fields[f].maxCoeff() - shape.fields[f].minCoeff();
      const double size = shape.fields[f].cwiseAbs().maxCoeff();
      EXPECT_LE(off, packed.fields[f].step / 2 + 1e-14 * size);
      EXPECT_LE(off, 7.7e-6 * range);
    }
  }
}

TEST(PackedShape, KeepsTheEndsOfEveryRange) {
  const CanonicalMesh mesh = BoxMesh({1, 2, 3}, {.along = 2, .across = 2, .high = 2});
  const ConsistentShape shape = RandomShape(mesh, 4);
  const PackedShape packed = Pack(shape, mesh).value();
  for (std::size_t f = 0; f < shape.fields.size(); ++f) {
    EXPECT_EQ(packed.fields[f].minimum, shape.fields[f].minCoeff());
    EXPECT_NEAR(packed.fields[f].maximum(), shape.fields[f].maxCoeff(),
                1e-15 * shape.fields[f].cwiseAbs().maxCoeff());
  }
}

TEST(PackedShape, HasConstantsExactly) {
  const CanonicalMesh mesh = BoxMesh({1, 1, 1}, {.along = 2, .across = 2, .high = 2});
  ConsistentShape shape = RandomShape(mesh, 5);
  shape.fields[0].setConstant(293.15);
  shape.fields[1].setZero();
  shape.fields[2].setConstant(-1e300 / 1e270);
  shape.nodes.row(2).setConstant(0.1);  // flat
  const ConsistentShape back = Unpack(Pack(shape, mesh).value());
  for (int f = 0; f < 3; ++f) {
    EXPECT_EQ(back.fields[static_cast<std::size_t>(f)], shape.fields[static_cast<std::size_t>(f)]);
  }
  EXPECT_EQ(back.nodes.row(2), shape.nodes.row(2));
}

TEST(PackedShape, RefusesWhatIsNotOfTheMesh) {
  const CanonicalMesh mesh = BoxMesh({1, 1, 1}, {.along = 2, .across = 2, .high = 2});
  const ConsistentShape good = RandomShape(mesh, 6);
  const auto field_of = [&](const ConsistentShape& shape) {
    const absl::Status status = Pack(shape, mesh).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return DetailOf(status).field;
  };
  ConsistentShape bad = good;
  bad.nodes = bad.nodes.leftCols(5).eval();
  EXPECT_EQ(field_of(bad), "shape.nodes");
  bad = good;
  bad.nodes(1, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field_of(bad), "shape.nodes");
  bad = good;
  bad.fields.pop_back();
  EXPECT_EQ(field_of(bad), "shape.fields");
  bad = good;
  bad.fields[1] = bad.fields[1].topRows(2).eval();
  EXPECT_EQ(field_of(bad), "shape.fields[1]");
  bad = good;
  bad.fields[2](0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_EQ(field_of(bad), "shape.fields[2]");
  bad = good;
  bad.fields[0](0, 0) = 1e35;
  EXPECT_EQ(field_of(bad), "shape.fields[0]");
}

TEST(PackedShape, FitsItsMeshAlone) {
  const CanonicalMesh mesh = BoxMesh({1, 1, 1}, {.along = 2, .across = 2, .high = 2});
  const CanonicalMesh other = BoxMesh({1, 1, 1}, {.along = 3, .across = 2, .high = 2});
  const PackedShape packed = Pack(RandomShape(mesh, 7), mesh).value();
  EXPECT_TRUE(CheckFits(packed, mesh).ok());
  EXPECT_EQ(DetailOf(CheckFits(packed, other)).field, "positions");
}

TEST(PackedShape, TakesTwoBytesANumber) {
  const CanonicalMesh mesh = BoxMesh({1, 1, 1}, {.along = 9, .across = 9, .high = 9});
  const PackedShape packed = Pack(RandomShape(mesh, 8), mesh).value();
  const int numbers =
      3 * mesh.node_count() + (1 + 3 + 6) * mesh.node_count() + 3 * mesh.element_count();
  EXPECT_GE(packed.ByteSize(), 2 * numbers);
  EXPECT_LT(packed.ByteSize(), 2 * numbers + 1000);
}

// Layers of a thin plate: the elements stay as they are where they are wider than a step's
// diagonal.
TEST(PackedShape, TurnsOverNoElementThatIsWideEnough) {
  for (const double thickness : {1e-1, 1e-2, 1e-3, 2e-4}) {
    const CanonicalMesh mesh = BoxMesh({1, 1, 1}, {.along = 4, .across = 4, .high = 4});
    ConsistentShape shape = RandomShape(mesh, 9);
    // A layer of cells a quarter of the thickness high, tilted so that steps of all axes matter.
    shape.nodes = mesh.nodes;
    shape.nodes.row(2) *= thickness;
    shape.nodes.row(2) += 0.1 * (shape.nodes.row(0) + shape.nodes.row(1));
    const PackedShape packed = Pack(shape, mesh).value();
    // The cells' elements are as wide as a cell is high, divided by the square root of 3 at least.
    const double width = thickness / 4 / std::sqrt(3.0) / 1.05;
    ASSERT_GT(width, 2 * PositionError(packed)) << thickness;
    EXPECT_EQ(TurnedOver(mesh, Unpack(packed).nodes), 0) << thickness;
  }
}

TEST(PackedShape, CountsElementsThatRoundingTurnsOver) {
  const CanonicalMesh mesh = BoxMesh({1, 1, 1}, {.along = 4, .across = 4, .high = 4});
  ConsistentShape shape = RandomShape(mesh, 10);
  shape.nodes = mesh.nodes;
  shape.nodes.row(2) *= 1e-6;
  shape.nodes.row(2) += 0.1 * (shape.nodes.row(0) + shape.nodes.row(1));
  EXPECT_EQ(TurnedOver(mesh, shape.nodes), 0);
  EXPECT_GT(TurnedOver(mesh, Unpack(Pack(shape, mesh).value()).nodes), 0);
}

}  // namespace
}  // namespace mortise::interpolator
