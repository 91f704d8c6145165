// Models of features at two parameters, from their names to the map between their meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/cad/solid_surface.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/mesh/tetrahedra/curved_elements.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "common/templates/features/codec/cad_template_codec.h"
#include "common/templates/features/edge_samples.h"
#include "services/interpolator/mapping/control_points.h"
#include "services/interpolator/mapping/mesh_mapper.h"
#include "services/interpolator/mapping/nearest_place.h"
#include "services/interpolator/mapping/surface_map.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/templates/features/feature_texts.h"
#include "tests/unit/common/templates/shipped_collection.h"

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

// A model that ships, meshed as evaluations mesh it.
absl::StatusOr<ModelMesh> Meshed(const cad::FeatureModel& features, const Eigen::VectorXd& q) {
  auto model = features.Regenerate(q);
  if (!model.ok()) return model.status();
  auto surface = cad::FuseAssembly({model->solid}, {.element_size = 0});
  if (!surface.ok()) return surface.status();
  auto mesh = mesh::MeshAssembly(*surface);
  if (!mesh.ok()) return mesh.status();
  const double size = (mesh->nodes.rowwise().maxCoeff() - mesh->nodes.rowwise().minCoeff()).norm();
  auto variables = cad::FindControlVariables(*model, size / 4);
  if (!variables.ok()) return variables.status();
  return ModelMesh{mesh::WithCurvedElements(*surface, *std::move(mesh)), *std::move(variables)};
}

// How far places all over each of two surfaces are from the other at most, m.
double FarthestApart(const mesh::SurfaceMesh& a, const mesh::SurfaceMesh& b) {
  double farthest = 0;
  for (const auto& [from, to] : {std::pair{&a, &b}, std::pair{&b, &a}}) {
    const NearestPlaces nearest = NearestPlaces::Create(*to).value();
    for (const auto& corners : from->triangles.colwise()) {
      const Eigen::Vector3d middle = from->vertices(Eigen::all, corners).rowwise().mean();
      farthest = std::max({farthest, nearest.Distance(middle).value(),
                           nearest.Distance(from->vertices.col(corners[0])).value()});
    }
  }
  return farthest;
}

class ShippedModelTest : public ::testing::TestWithParam<const char*> {};

// From the middle of the parameters to halfway to a corner of their box.
TEST_P(ShippedModelTest, IsMappedFromOneDesignToAnother) {
  const auto definition = cad::FromProto(templates::ShippedTemplate(GetParam()).template_().cad());
  ASSERT_OK(definition);
  ASSERT_OK_AND_ASSIGN(const auto features, cad::FeatureModel::Create(*definition));
  Eigen::VectorXd middle = features.Defaults(), other = middle;
  for (Eigen::Index i = 0; i < middle.size(); ++i) {
    const auto& parameter = features.definition().parameters[static_cast<std::size_t>(i)];
    middle[i] = (parameter.minimum + parameter.maximum) / 2;
    other[i] = middle[i] + 0.25 * (parameter.maximum - parameter.minimum);
  }
  ASSERT_OK_AND_ASSIGN(const ModelMesh target, Meshed(features, middle));
  ASSERT_OK_AND_ASSIGN(const ModelMesh source, Meshed(features, other));
  ASSERT_OK_AND_ASSIGN(const auto mapper, MeshMapper::Create(target));
  ASSERT_OK_AND_ASSIGN(const MeshMap map, mapper->Map(source));
  ASSERT_OK_AND_ASSIGN(const MeshMap again, mapper->Map(source));
  EXPECT_EQ(map.nodes, again.nodes);
  EXPECT_GE(map.surface.points, 0.9 * static_cast<double>(target.variables.points.size()));
  EXPECT_LT(map.volume.inverted.size(), 0.01 * static_cast<double>(target.mesh.tetrahedra.cols()));
  const OuterSurface truth = OuterSurfaceOf(source.mesh);
  mesh::SurfaceMesh mapped = mapper->outer().marked.surface;
  mapped.vertices = map.surface.positions;
  const Eigen::Vector3d size =
      source.mesh.nodes.rowwise().maxCoeff() - source.mesh.nodes.rowwise().minCoeff();
  EXPECT_LT(FarthestApart(mapped, truth.marked.surface), 0.005 * size.norm());
}

INSTANTIATE_TEST_SUITE_P(Templates, ShippedModelTest,
                         ::testing::Values("templates/wrench", "templates/drum-brake"),
                         [](const auto& model) {
                           std::string name = model.param;
                           name.erase(0, name.find('/') + 1);
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace mortise::interpolator
