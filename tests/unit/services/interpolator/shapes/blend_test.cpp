#include "services/interpolator/shapes/blend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "common/base/errors.h"
#include "tests/unit/services/interpolator/shapes/block_designs.h"

namespace mortise::interpolator {
namespace {

constexpr int kTemperature = 0, kDisplacement = 1, kHeatFlux = 3;

class Blending : public testing::Test {
 protected:
  // As many random shapes as are asked for, of a mesh whose counts fill no whole vectors.
  std::vector<PackedShape> RandomShapes(int count, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<PackedShape> shapes;
    for (int k = 0; k < count; ++k) {
      ConsistentShape shape{mesh_.nodes, {}};
      for (double& number : shape.nodes.reshaped()) number += 0.3 * unit(random);
      for (const FieldKind& kind : mesh_.fields) {
        Eigen::MatrixXd values(kind.components, mesh_.ValueCount(kind));
        for (double& number : values.reshaped()) number = 1e7 * unit(random) + 3e6;
        shape.fields.push_back(values);
      }
      shapes.push_back(Pack(shape, mesh_).value());
    }
    return shapes;
  }

  static std::vector<WeightedShape> Weighted(const std::vector<PackedShape>& shapes,
                                             unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> weight(-1, 1.5);
    std::vector<WeightedShape> weighted;
    for (const PackedShape& shape : shapes) weighted.push_back({&shape, weight(random)});
    return weighted;
  }

  const CanonicalMesh mesh_ =
      CanonicalMesh::Create(
          BlockDesign(BoxShape({2, 1, 0.5}), {.along = 4, .across = 3, .high = 4}))
          .value();
  const BlendedParts everything_{false, {0, 1, 2, 3}};
};

double LargestOf(const Eigen::MatrixXd& numbers) { return numbers.cwiseAbs().maxCoeff(); }

TEST_F(Blending, IsTheWeightedSumUpToRounding) {
  for (const int count : {1, 2, 3, 7, 8, 9, 16, 17, 64}) {
    const std::vector<PackedShape> shapes = RandomShapes(count, 10);
    const std::vector<WeightedShape> weighted = Weighted(shapes, 11);
    BlendedShape blended;
    ASSERT_TRUE(Blend(weighted, mesh_, everything_, blended).ok());
    Eigen::Matrix3Xd nodes = Eigen::Matrix3Xd::Zero(3, mesh_.node_count());
    std::vector<Eigen::MatrixXd> fields;
    for (const FieldKind& kind : mesh_.fields) {
      fields.push_back(Eigen::MatrixXd::Zero(kind.components, mesh_.ValueCount(kind)));
    }
    double node_scale = 0;
    std::vector<double> field_scale(fields.size(), 0);
    for (const auto& [shape, weight] : weighted) {
      const ConsistentShape exact = Unpack(*shape);
      nodes += weight * exact.nodes;
      node_scale += std::abs(weight) * LargestOf(exact.nodes);
      for (std::size_t f = 0; f < fields.size(); ++f) {
        fields[f] += weight * exact.fields[f];
        field_scale[f] += std::abs(weight) * LargestOf(exact.fields[f]);
      }
    }
    const double rounding = (count + 4) * 1.2e-7;
    for (Eigen::Index i = 0; i < nodes.size(); ++i) {
      ASSERT_NEAR(blended.positions[static_cast<std::size_t>(i)], nodes.data()[i],
                  rounding * node_scale);
    }
    for (std::size_t f = 0; f < fields.size(); ++f) {
      ASSERT_EQ(std::ssize(blended.fields[f]), fields[f].size());
      for (Eigen::Index i = 0; i < fields[f].size(); ++i) {
        ASSERT_NEAR(blended.fields[f][static_cast<std::size_t>(i)], fields[f].data()[i],
                    rounding * field_scale[f]);
      }
    }
  }
}

TEST_F(Blending, IsTheShapeItselfAtASample) {
  const std::vector<PackedShape> shapes = RandomShapes(3, 20);
  const std::vector<WeightedShape> weighted = {{&shapes[0], 0}, {&shapes[1], 1}, {&shapes[2], 0}};
  BlendedShape blended;
  ASSERT_TRUE(Blend(weighted, mesh_, everything_, blended).ok());
  const ConsistentShape exact = Unpack(shapes[1]);
  for (Eigen::Index i = 0; i < exact.nodes.size(); ++i) {
    EXPECT_NEAR(blended.positions[static_cast<std::size_t>(i)], exact.nodes.data()[i],
                6e-7 * LargestOf(exact.nodes));
  }
}

TEST_F(Blending, GivesTheSurfaceAsTheBeginningOfAll) {
  const std::vector<PackedShape> shapes = RandomShapes(8, 30);
  const std::vector<WeightedShape> weighted = Weighted(shapes, 31);
  BlendedShape all, surface;
  ASSERT_TRUE(Blend(weighted, mesh_, everything_, all).ok());
  ASSERT_TRUE(Blend(weighted, mesh_, {true, {kDisplacement}}, surface).ok());
  ASSERT_EQ(surface.node_count(), mesh_.surface_nodes);
  EXPECT_TRUE(
      std::equal(surface.positions.begin(), surface.positions.end(), all.positions.begin()));
  ASSERT_EQ(surface.field_numbers, std::vector<int>{kDisplacement});
  ASSERT_EQ(std::ssize(surface.fields[0]), 3 * mesh_.surface_nodes);
  EXPECT_TRUE(std::equal(surface.fields[0].begin(), surface.fields[0].end(),
                         all.fields[kDisplacement].begin()));
}

TEST_F(Blending, TakesNoMemoryAnewWhereItIsReused) {
  const std::vector<PackedShape> shapes = RandomShapes(8, 40);
  BlendedShape out;
  ASSERT_TRUE(Blend(Weighted(shapes, 41), mesh_, everything_, out).ok());
  const float* const positions = out.positions.data();
  const float* const field = out.fields[2].data();
  const BlendedShape before = out;
  ASSERT_TRUE(Blend(Weighted(shapes, 42), mesh_, everything_, out).ok());
  EXPECT_EQ(out.positions.data(), positions);
  EXPECT_EQ(out.fields[2].data(), field);
  EXPECT_NE(out.positions, before.positions);
  ASSERT_TRUE(Blend(Weighted(shapes, 41), mesh_, everything_, out).ok());
  EXPECT_EQ(out.positions, before.positions);
  EXPECT_EQ(out.fields, before.fields);
}

TEST_F(Blending, LeavesOutWhatHasNoWeight) {
  const std::vector<PackedShape> shapes = RandomShapes(10, 50);
  std::vector<WeightedShape> weighted = Weighted(shapes, 51);
  weighted[3].weight = weighted[8].weight = 0;
  BlendedShape with, without;
  ASSERT_TRUE(Blend(weighted, mesh_, everything_, with).ok());
  weighted.erase(weighted.begin() + 8);
  weighted.erase(weighted.begin() + 3);
  ASSERT_TRUE(Blend(weighted, mesh_, everything_, without).ok());
  EXPECT_EQ(with.positions, without.positions);
  EXPECT_EQ(with.fields, without.fields);
}

TEST_F(Blending, RefusesWhatDoesNotFit) {
  const std::vector<PackedShape> shapes = RandomShapes(2, 60);
  std::vector<WeightedShape> weighted = Weighted(shapes, 61);
  BlendedShape out;
  const auto field_of = [](const absl::Status& status) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return DetailOf(status).field;
  };
  EXPECT_EQ(field_of(Blend({}, mesh_, {}, out)), "shapes");
  EXPECT_EQ(field_of(Blend(weighted, mesh_, {false, {kTemperature, 4}}, out)), "fields[1]");
  EXPECT_EQ(field_of(Blend(weighted, mesh_, {true, {kHeatFlux}}, out)), "fields[0]");
  weighted[1].weight = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(field_of(Blend(weighted, mesh_, {}, out)), "shapes[1].weight");
  weighted[1].weight = 1;
  PackedShape other = shapes[1];
  other.positions.pop_back();
  weighted[1].shape = &other;
  EXPECT_EQ(field_of(Blend(weighted, mesh_, {}, out)), "shapes[1].positions");
}

}  // namespace
}  // namespace mortise::interpolator
