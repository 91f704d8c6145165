#include "common/fields/design_fields.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "tests/unit/common/fields/two_tetrahedra.h"

namespace mortise::fields {
namespace {

using Faults = std::vector<std::pair<std::string, std::function<void(DesignFields&)>>>;

// Each, made in a sound design, is refused by the name of its place.
void ExpectNamed(const Faults& faults) {
  for (const auto& [field, make] : faults) {
    DesignFields design = TwoTetrahedra();
    make(design);
    const absl::Status status = Check(design);
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << field;
    EXPECT_EQ(DetailOf(status).field, field) << status;
  }
}

TEST(DesignFieldsTest, ASoundDesignPasses) {
  EXPECT_EQ(Check(TwoTetrahedra()), absl::OkStatus());
  DesignFields surface = TwoTetrahedra();
  surface.tetrahedra.resize(4, 0);
  surface.tetrahedron_part.resize(0);
  surface.fields.pop_back();  // that of the elements
  EXPECT_EQ(Check(surface), absl::OkStatus());
}

TEST(DesignFieldsTest, AsManyControlsPassAsThereMayBe) {
  DesignFields design = TwoTetrahedra();
  while (std::ssize(design.control_points) < kMaximumControls) {
    design.control_points.push_back({"more " + std::to_string(design.control_points.size())});
  }
  design.ways[1].positions.setZero(3, kMaximumPositions - 3);
  design.paths.push_back({"E2", std::vector<int>(kMaximumPositions - 4, 0)});
  EXPECT_EQ(Check(design), absl::OkStatus());
}

TEST(DesignFieldsTest, EveryFaultIsNamed) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const Faults faults = {
      {"nodes", [](auto& design) { design.nodes(1, 2) = kNan; }},
      {"parts[1]", [](auto& design) { design.parts[1] = "leg"; }},
      {"parts[0]", [](auto& design) { design.parts[0].clear(); }},
      {"tetrahedra[1]", [](auto& design) { design.tetrahedra(2, 1) = 5; }},
      {"tetrahedra[0]", [](auto& design) { design.tetrahedra(0, 0) = -1; }},
      {"tetrahedra", [](auto& design) { design.tetrahedra.setZero(5, 2); }},
      {"tetrahedron_part", [](auto& design) { design.tetrahedron_part[1] = 2; }},
      {"tetrahedron_part", [](auto& design) { design.tetrahedron_part.setZero(3); }},
      {"triangles", [](auto& design) { design.triangles.setZero(3, 0); }},
      {"triangles", [](auto& design) { design.triangles.setZero(4, 7); }},
      {"triangles[6]", [](auto& design) { design.triangles(0, 6) = 5; }},
      {"triangle_back", [](auto& design) { design.triangle_back[3] = -2; }},
      {"triangle_front", [](auto& design) { design.triangle_front.setZero(6); }},
      {"regions[1].name", [](auto& design) { design.regions[1].name = "held"; }},
      {"regions[0].triangles",
       [](auto& design) {
         design.regions[0].triangles = {2, 0};
       }},
      {"regions[0].triangles", [](auto& design) { design.regions[0].triangles = {7}; }},
      {"control_points[1].id", [](auto& design) { design.control_points[1].id = "V1"; }},
      {"control_points[1].position",
       [](auto& design) { design.control_points[1].position.x() = kNan; }},
      {"control_points[0].node", [](auto& design) { design.control_points[0].node = 5; }},
      {"paths[0].nodes", [](auto& design) { design.paths[0].nodes = {1}; }},
      {"paths[0].nodes", [](auto& design) { design.paths[0].nodes[2] = 5; }},
      {"paths[0].id", [](auto& design) { design.paths[0].id = std::string(5000, 'e'); }},
      {"ways[1].edge", [](auto& design) { design.ways[1].edge.clear(); }},
      {"ways[0].edge", [](auto& design) { design.ways[0].edge = std::string(5000, 'e'); }},
      {"ways[0].from", [](auto& design) { design.ways[0].from = 2; }},
      {"ways[1].to", [](auto& design) { design.ways[1].to = -1; }},
      {"ways[0].positions", [](auto& design) { design.ways[0].positions.resize(3, 1); }},
      {"ways[0].positions", [](auto& design) { design.ways[0].positions(2, 1) = kNan; }},
      {"fields[0].name", [](auto& design) { design.fields[0].name.clear(); }},
      {"fields[1]", [](auto& design) { design.fields[1].load_case = "own weight"; }},
      {"fields[2].values", [](auto& design) { design.fields[2].place = FieldPlace::kNodes; }},
      {"fields[0].values", [](auto& design) { design.fields[0].values.setZero(0, 5); }},
      {"fields[0].values", [](auto& design) { design.fields[0].values(2, 4) = kNan; }},
  };
  ExpectNamed(faults);
}

TEST(DesignFieldsTest, TooManyControlsAreNamed) {
  const Faults faults = {
      {"control_points",
       [](auto& design) {
         for (int i = 0; i < kMaximumControls; ++i) {
           design.control_points.push_back({"more " + std::to_string(i)});
         }
       }},
      {"paths",
       [](auto& design) {
         for (int i = 0; i < kMaximumControls; ++i) {
           design.paths.push_back({"more " + std::to_string(i), {0, 1}});
         }
       }},
      {"paths[1].nodes",
       [](auto& design) {
         design.paths.push_back({"E2", std::vector<int>(kMaximumPositions - 3, 0)});
       }},
      {"ways", [](auto& design) { design.ways.resize(kMaximumControls + 1, design.ways.front()); }},
      {"ways[1].positions",
       [](auto& design) { design.ways[1].positions.setZero(3, kMaximumPositions - 2); }},
  };
  ExpectNamed(faults);
}

}  // namespace
}  // namespace mortise::fields
