// Models of features at two parameters, from their names to the map between their meshes.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/cad/solid_surface.h"
#include "common/templates/features/edge_samples.h"
#include "services/interpolator/mapping/control_points.h"
#include "services/interpolator/mapping/surface_map.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/templates/features/feature_texts.h"

namespace mortise::interpolator {
namespace {

// A plate of this length with a bore through its middle.
std::string BoredPlate(double length, double bore) {
  return absl::StrCat(
      "features { name: 's' sketch { profiles { name: 'outline' rectangle { width: '", length,
      "' height: '0.06' } } profiles { name: 'bore' hole_of: 'outline' circle { radius: '", bore,
      "' } } } } features { name: 'plate' extrude { sketch: 's' to: '0.02' } }");
}

struct Marked {
  mesh::AssemblySurface assembly;
  MarkedSurface surface;
};

absl::StatusOr<Marked> MarkedModel(const std::string& features) {
  auto model = cad::SolidOf("", features);
  if (!model.ok()) return model.status();
  auto assembly = cad::SurfaceOf(model->solid);
  if (!assembly.ok()) return assembly.status();
  auto variables = cad::FindControlVariables(*model, 0.02);
  if (!variables.ok()) return variables.status();
  auto surface = PlaceControlVariables({assembly->vertices, assembly->triangles}, *variables);
  if (!surface.ok()) return surface.status();
  return Marked{*std::move(assembly), *std::move(surface)};
}

TEST(CadModelTest, FacesGoToTheFacesOfTheSameName) {
  const double length = 0.14, bore = 0.018;
  ASSERT_OK_AND_ASSIGN(const Marked source, MarkedModel(BoredPlate(length, bore)));
  ASSERT_OK_AND_ASSIGN(const Marked target, MarkedModel(BoredPlate(0.1, 0.01)));
  ASSERT_OK_AND_ASSIGN(const SurfaceMap map, MapSurface(source.surface, target.surface));
  EXPECT_GE(map.points, 8 + 2 * 4);
  const mesh::AssemblySurface& plate = target.assembly;
  for (Eigen::Index t = 0; t < plate.triangles.cols(); ++t) {
    const auto face = static_cast<std::size_t>(plate.triangle_face[t]);
    const std::string& name = plate.faces[face].origins.front().name;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d place = map.positions.col(plate.triangles(k, t));
      if (name == "plate.start") {
        EXPECT_NEAR(place.z(), 0, 1e-9);
      }
      if (name == "plate.end") {
        EXPECT_NEAR(place.z(), 0.02, 1e-9);
      }
      if (name == "plate.outline.right") {
        EXPECT_NEAR(place.x(), length / 2, 1e-9);
      }
      if (name == "plate.outline.top") {
        EXPECT_NEAR(place.y(), 0.03, 1e-9);
      }
      if (name.find("bore") != std::string::npos) {
        EXPECT_NEAR(place.head<2>().norm(), bore, 0.03 * bore) << name;
      }
    }
  }
}

}  // namespace
}  // namespace mortise::interpolator
