#include "services/interpolator/mapping/model_surface_map.h"

#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/cad/surface/assembly_surface.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "services/interpolator/mapping/mesh_mapper.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/interpolator/mapping/board_assemblies.h"

namespace mortise::interpolator {
namespace {

// Every vertex of the target comes to lie on its faces of the source.
TEST(ModelSurfaceMapTest, KeepsTheFacesOfBoardsFlat) {
  for (const BoardAssembly& of : BoardAssemblies()) {
    ASSERT_OK_AND_ASSIGN(const BoardSurface source, Fused(of.source));
    ASSERT_OK_AND_ASSIGN(const BoardSurface target, Fused(of.target));
    ASSERT_OK_AND_ASSIGN(const auto mapper, ModelSurfaceMapper::Create(target.model));
    ASSERT_OK_AND_ASSIGN(const ModelSurfaceMap map, mapper->Map(source.model));
    EXPECT_GT(map.surface.points, 8) << of.name;
    if (of.meets_in_edges) continue;
    EXPECT_LT(FarthestOffFaces(of.source, target.assembly, map.positions), 1e-9) << of.name;
  }
}

TEST(ModelSurfaceMapTest, TellsPlacesBetweenTheVerticesOfTheSource) {
  const BoardAssembly of = BoardAssemblies().front();
  ASSERT_OK_AND_ASSIGN(const BoardSurface source, Fused(of.source));
  ASSERT_OK_AND_ASSIGN(const BoardSurface target, Fused(of.target));
  ASSERT_OK_AND_ASSIGN(const auto mapper, ModelSurfaceMapper::Create(target.model));
  ASSERT_OK_AND_ASSIGN(const ModelSurfaceMap map, mapper->Map(source.model));
  for (const int vertex : target.model.surface.triangles.reshaped()) {
    const NodePlace& place = map.places[static_cast<std::size_t>(vertex)];
    const Eigen::Vector3d found =
        source.model.surface.vertices(Eigen::all, place.nodes) * place.shares;
    EXPECT_LT((found - map.positions.col(vertex)).norm(), 1e-9);
  }
}

// With tetrahedra the outside stays as flat, and no element turns over.
TEST(ModelSurfaceMapTest, MapsBoardsOfTetrahedra) {
  for (const BoardAssembly& of : BoardAssemblies()) {
    ASSERT_OK_AND_ASSIGN(const BoardSurface source, Fused(of.source));
    ASSERT_OK_AND_ASSIGN(const BoardSurface target, Fused(of.target));
    ASSERT_OK_AND_ASSIGN(const auto source_mesh, mesh::MeshAssembly(source.assembly));
    ASSERT_OK_AND_ASSIGN(const auto target_mesh, mesh::MeshAssembly(target.assembly));
    ASSERT_OK_AND_ASSIGN(const auto mapper,
                         MeshMapper::Create({target_mesh, target.model.variables}));
    ASSERT_OK_AND_ASSIGN(const MeshMap map, mapper->Map({source_mesh, source.model.variables}));
    if (of.meets_in_edges) continue;
    EXPECT_TRUE(map.volume.inverted.empty()) << of.name << ": " << map.volume.inverted.size();
    EXPECT_LT(FarthestOffFaces(of.source, target_mesh, map.nodes), 1e-9) << of.name;
  }
}

TEST(ModelSurfaceMapTest, NamesWhatIsWrong) {
  const BoardAssembly of = BoardAssemblies().front();
  ASSERT_OK_AND_ASSIGN(const BoardSurface boards, Fused(of.source));
  ASSERT_OK_AND_ASSIGN(const auto mapper, ModelSurfaceMapper::Create(boards.model));
  ModelSurface wrong = boards.model;
  wrong.front.conservativeResize(3);
  EXPECT_EQ(DetailOf(mapper->Map(wrong).status()).field, "source.front");
  wrong = boards.model;
  wrong.surface.triangles(0, 0) = 100000;
  EXPECT_EQ(DetailOf(ModelSurfaceMapper::Create(wrong).status()).field, "target.surface");
  wrong = boards.model;
  wrong.surface.triangles.col(0) = wrong.surface.triangles.col(1);
  EXPECT_EQ(DetailOf(ModelSurfaceMapper::Create(wrong).status()).field, "target.surface");
}

}  // namespace
}  // namespace mortise::interpolator
