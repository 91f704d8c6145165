#include "services/interpolator/mapping/marked_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "common/base/errors.h"
#include "common/mesh/joined_surface.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/round_solids.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

MarkedSurface Box(int cells = 3) {
  return MakeBlockMesh(BoxShape({1, 1, 1}), {.along = cells, .across = cells, .high = cells})
      .marked;
}

std::string ReasonOf(const MarkedSurface& source, const MarkedSurface& target) {
  const auto both = FindCorrespondence(source, target);
  EXPECT_EQ(both.status().code(), absl::StatusCode::kFailedPrecondition) << both.status();
  return DetailOf(both.status()).reason;
}

TEST(MarkedSurfaceTest, CountsShellsAndHandles) {
  const mesh::SurfaceMesh sphere = mesh::Sphere(1, 8), torus = mesh::Torus(3, 1, 9);
  const std::vector<Shell> shells = ShellsOf(mesh::Joined({sphere, torus}));
  ASSERT_EQ(shells.size(), 2U);
  EXPECT_EQ(shells[0].genus, 0);
  EXPECT_EQ(shells[1].genus, 1);
  const BlockMesh plate = MakeBlockMesh(PlateShape(3, 2, 1, 0.5), {});
  EXPECT_EQ(ShellsOf(plate.marked.surface).front().genus, 1);
}

TEST(MarkedSurfaceTest, FindsWhatBothHave) {
  MarkedSurface source = Box(3), target = Box(4);
  ASSERT_OK(CheckMarkedSurface(source, "source"));
  source.points[2].name = "only here";
  ASSERT_OK_AND_ASSIGN(const Correspondence both, FindCorrespondence(source, target));
  EXPECT_EQ(both.points.size(), 7U);
  EXPECT_EQ(both.paths.size(), 9U);  // three edges meet at each corner
  for (const Correspondence::Path& path : both.paths) {
    const auto ends_at = [&](int vertex, bool is_source) {
      return std::any_of(both.points.begin(), both.points.end(), [&](const auto& point) {
        return (is_source ? point.source : point.target) == vertex;
      });
    };
    EXPECT_TRUE(ends_at(path.source.front(), true) && ends_at(path.source.back(), true));
    EXPECT_TRUE(ends_at(path.target.front(), false) && ends_at(path.target.back(), false));
  }
}

// An edge that is divided more often on one surface corresponds to the undivided one.
TEST(MarkedSurfaceTest, JoinsPiecesOfOneEdge) {
  MarkedSurface source = Box(4), target = Box(4);
  ControlPath& path = source.paths[0];
  const std::vector<int> whole = path.vertices;
  for (const std::size_t i : {1U, 2U}) {
    source.points.push_back({"division " + std::to_string(i), whole[i]});
  }
  path.vertices = {whole[1], whole[0]};
  source.paths.push_back({path.name, {whole[1], whole[2]}});
  source.paths.push_back({source.paths[0].name, {whole[4], whole[3], whole[2]}});
  ASSERT_OK(CheckMarkedSurface(source, "source"));
  ASSERT_OK_AND_ASSIGN(const Correspondence both, FindCorrespondence(source, target));
  EXPECT_EQ(both.paths.size(), 12U);
  const bool is_joined =
      std::any_of(both.paths.begin(), both.paths.end(), [&](const Correspondence::Path& of) {
        return of.name == target.paths[0].name &&
               (of.source == whole ||
                std::vector<int>(of.source.rbegin(), of.source.rend()) == whole);
      });
  EXPECT_TRUE(is_joined);
}

TEST(MarkedSurfaceTest, SaysWhatDiffers) {
  const MarkedSurface plate = MakeBlockMesh(PlateShape(3, 2, 1, 0.5), {}).marked;
  MarkedSurface box = Box();
  EXPECT_EQ(ReasonOf(plate, box), "TOPOLOGY_DIFFERS");
  MarkedSurface two = box;
  two.surface = mesh::Joined({box.surface, mesh::Moved(mesh::Sphere(1, 8), {5, 0, 0})});
  EXPECT_EQ(ReasonOf(two, box), "TOPOLOGY_DIFFERS");
  EXPECT_EQ(ReasonOf(two, two), "TOO_FEW_POINTS");
  MarkedSurface few = box;
  few.points.resize(2);
  few.paths.clear();
  EXPECT_EQ(ReasonOf(few, box), "TOO_FEW_POINTS");
}

TEST(MarkedSurfaceTest, NamesWhatIsWrong) {
  const auto field_of = [](const auto& change) {
    MarkedSurface box = Box();
    change(box);
    const absl::Status status = CheckMarkedSurface(box, "source");
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
    return DetailOf(status).field;
  };
  EXPECT_EQ(field_of([](MarkedSurface& box) { box.surface.triangles.resize(3, 0); }),
            "source.surface");
  EXPECT_EQ(field_of([](MarkedSurface& box) {
              box.surface.triangles.conservativeResize(3, box.surface.triangles.cols() - 1);
            }),
            "source.surface");
  EXPECT_EQ(field_of([](MarkedSurface& box) { box.points[1].name = box.points[0].name; }),
            "source.points[1].name");
  EXPECT_EQ(field_of([](MarkedSurface& box) { box.points[3].vertex = 100000; }),
            "source.points[3].vertex");
  EXPECT_EQ(field_of([](MarkedSurface& box) { box.points[3].vertex = box.points[2].vertex; }),
            "source.points[3].vertex");
  EXPECT_EQ(field_of([](MarkedSurface& box) { box.paths[2].vertices.pop_back(); }),
            "source.paths[2]");
  EXPECT_EQ(field_of([](MarkedSurface& box) {
              std::swap(box.paths[2].vertices[1], box.paths[2].vertices[2]);
            }),
            "source.paths[2].vertices[0]");
  EXPECT_EQ(field_of([](MarkedSurface& box) { box.paths[4] = box.paths[1]; }),
            "source.paths[4].vertices[0]");
}

}  // namespace
}  // namespace mortise::interpolator
