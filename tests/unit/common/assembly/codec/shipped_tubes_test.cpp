// The round tubes that ship are hollow: cut to any length they keep their section and weigh what
// it does.
#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <gtest/gtest.h>

#include <numbers>
#include <string>
#include <vector>

#include "absl/strings/substitute.h"
#include "common/assembly/assembly_design.h"
#include "common/mesh/mass_properties.h"
#include "common/mesh/surface_check.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::parametric {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<Material> Materials() {
  std::vector<Material> materials;
  for (const auto& message : WhatShips().materials) materials.push_back(*FromProto(message));
  return materials;
}

bool IsRoundTube(const Item& item) {
  return item.kind == ItemKind::kTube && item.dimensions[1].name == "outside_diameter";
}

double WallOf(const Item& item) {
  for (const ItemMeasure& measure : item.measures) {
    if (measure.name == "wall_thickness") return measure.size;
  }
  ADD_FAILURE() << item.name << " has no wall_thickness";
  return 0;
}

// One tube, half a metre long, along Y.
absl::StatusOr<ParametricAssembly> TubeOf(const Item& item) {
  v1::Assembly message;
  EXPECT_TRUE(google::protobuf::TextFormat::ParseFromString(
      absl::Substitute("name: 'assemblies/tube' parts { name: 'tube' item: '$0' length_axis: Y "
                       "size { y: 0.5 } }",
                       item.name),
      &message));
  auto assembly = FromProto(message, ShippedItems(), ShippedShapes());
  if (!assembly.ok()) return assembly.status();
  return ParametricAssembly::Create(*std::move(assembly));
}

TEST(ShippedTubes, WeighWhatTheirWallDoesAtAnyLength) {
  const std::vector<Material> materials = Materials();
  int tubes = 0;
  for (const Item& item : ShippedItems()) {
    if (!IsRoundTube(item)) continue;
    ++tubes;
    SCOPED_TRACE(item.name);
    const auto tube = TubeOf(item);
    ASSERT_TRUE(tube.ok()) << tube.status();
    const auto sizes = tube->AdjustableSizes();
    ASSERT_TRUE(sizes.ok()) << sizes.status();
    ASSERT_EQ(sizes->size(), 1u) << "only its length";
    EXPECT_EQ(sizes->front().measure.axis, Axis::kY);
    const double outside = item.dimensions[1].size, inside = outside - 2 * WallOf(item);
    const double section = kPi / 4 * (outside * outside - inside * inside);
    const double density = FindMaterial(materials, item.material)->density;
    for (const double length : {sizes->front().minimum, 0.8, sizes->front().maximum}) {
      const auto cut =
          tube->Adjust(tube->drawn(), {{sizes->front().measure, length}}, DemandPolicy::kStrict);
      ASSERT_TRUE(cut.ok()) << cut.status();
      const EvaluatedDesign design = DesignAt(*tube, cut->q, ShippedItems(), materials);
      ASSERT_EQ(design.parts.size(), 1u);
      const EvaluatedPart& part = design.parts[0];
      EXPECT_LT((part.maximum - part.minimum - Eigen::Vector3d(outside, length, outside)).norm(),
                1e-9);
      EXPECT_NEAR(part.volume, section * length, 1e-6 * section * length);
      EXPECT_NEAR(part.mass, density * section * length, 1e-6 * part.mass);
      // What is drawn of it is hollow, too.
      ASSERT_TRUE(part.faceted.has_value());
      EXPECT_TRUE(mesh::IsWatertight(part.faceted->surface));
      EXPECT_LE(part.faceted->surface.triangles.cols(), 400);
      EXPECT_NEAR(mesh::ComputeMassProperties(part.faceted->surface).volume, part.volume,
                  0.011 * part.volume);
    }
  }
  EXPECT_EQ(tubes, 19);
}

}  // namespace
}  // namespace mortise::parametric
