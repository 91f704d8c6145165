#include "services/interpolator/mapping/patch_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "common/base/errors.h"
#include "common/mesh/surface_check.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/round_solids.h"
#include "tests/unit/services/interpolator/mapping/block_shapes.h"

namespace mortise::interpolator {
namespace {

double AreaOf(const mesh::SurfaceMesh& surface) {
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    const Eigen::Vector3d a = surface.vertices.col(surface.triangles(0, t));
    const Eigen::Vector3d b = surface.vertices.col(surface.triangles(1, t));
    const Eigen::Vector3d c = surface.vertices.col(surface.triangles(2, t));
    area += (b - a).cross(c - a).norm() / 2;
  }
  return area;
}

// Every patch is a disk, all triangles are in one, and paths meet in points only.
void ExpectSound(const PatchLayout& layout, const LaidSurface& laid,
                 const mesh::SurfaceMesh& given) {
  EXPECT_TRUE(mesh::IsWatertight(laid.surface));
  EXPECT_NEAR(AreaOf(laid.surface), AreaOf(given), 1e-9 * AreaOf(given));
  EXPECT_EQ(laid.surface.vertices.leftCols(given.vertices.cols()), given.vertices);
  std::size_t triangles = 0;
  ASSERT_EQ(laid.patches.size(), layout.walks.size());
  for (std::size_t p = 0; p < laid.patches.size(); ++p) {
    const LaidSurface::Patch& patch = laid.patches[p];
    triangles += patch.triangles.size();
    // V − E + F = 1 of a disk, with 2E = 3F + boundary.
    const auto faces = static_cast<long>(patch.triangles.size());
    const auto boundary = static_cast<long>(patch.boundary.size());
    EXPECT_EQ(static_cast<long>(patch.vertices.size()) - (3 * faces + boundary) / 2 + faces, 1);
    std::size_t around = 0;
    for (const int directed : layout.walks[p]) {
      around += laid.paths[static_cast<std::size_t>(directed / 2)].size() - 1;
    }
    EXPECT_EQ(around, patch.boundary.size());
  }
  EXPECT_EQ(static_cast<Eigen::Index>(triangles), laid.surface.triangles.cols());
  std::set<int> inner;
  for (const std::vector<int>& path : laid.paths) {
    for (std::size_t i = 1; i + 1 < path.size(); ++i) EXPECT_TRUE(inner.insert(path[i]).second);
  }
  for (const std::vector<int>& path : laid.paths) {
    EXPECT_EQ(inner.count(path.front()) + inner.count(path.back()), 0U);
  }
}

// Returns the numbers of patches that both sides of each path belong to: each directed path is on
// the boundary of one.
void ExpectClosed(const PatchLayout& layout) {
  std::set<int> seen;
  for (const std::vector<int>& walk : layout.walks) {
    for (const int directed : walk) EXPECT_TRUE(seen.insert(directed).second);
  }
  EXPECT_EQ(seen.size(), 2 * layout.paths.size());
}

// Returns the paths that leave each point, counter-clockwise on a surface, from the lowest on.
std::map<int, std::vector<int>> OrderAround(const PatchLayout& layout, const LaidSurface& laid) {
  std::map<std::pair<int, int>, int> third;  // behind each directed edge
  const mesh::SurfaceMesh& surface = laid.surface;
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      third[{surface.triangles(k, t), surface.triangles((k + 1) % 3, t)}] =
          surface.triangles((k + 2) % 3, t);
    }
  }
  std::map<std::pair<int, int>, int> leaving;  // directed path by its first edge
  for (std::size_t p = 0; p < laid.paths.size(); ++p) {
    const std::vector<int>& way = laid.paths[p];
    leaving[{way[0], way[1]}] = static_cast<int>(2 * p);
    leaving[{way.back(), way[way.size() - 2]}] = static_cast<int>(2 * p + 1);
  }
  std::map<int, std::vector<int>> order;
  for (std::size_t p = 0; p < laid.paths.size(); ++p) {
    for (const auto& [point, way] :
         {std::pair{layout.paths[p].from, std::pair{laid.paths[p][0], laid.paths[p][1]}},
          std::pair{layout.paths[p].to,
                    std::pair{laid.paths[p].back(), laid.paths[p][laid.paths[p].size() - 2]}}}) {
      if (order.count(point) > 0) continue;
      std::vector<int> around;
      int next = way.second;
      do {
        const auto found = leaving.find({way.first, next});
        if (found != leaving.end()) around.push_back(found->second);
        next = third.at({way.first, next});
      } while (next != way.second);
      std::rotate(around.begin(), std::min_element(around.begin(), around.end()), around.end());
      order[point] = around;
    }
  }
  return order;
}

void ExpectCommon(const MarkedSurface& source, const MarkedSurface& target, const char* name) {
  SCOPED_TRACE(name);
  ASSERT_OK_AND_ASSIGN(const PatchLayout layout, BuildPatchLayout(source, target));
  ExpectSound(layout, layout.source, source.surface);
  ExpectSound(layout, layout.target, target.surface);
  ExpectClosed(layout);
  EXPECT_EQ(OrderAround(layout, layout.source), OrderAround(layout, layout.target));
  for (std::size_t p = 0; p < layout.paths.size(); ++p) {
    EXPECT_EQ(layout.source.paths[p].size(), layout.target.paths[p].size());
  }
}

TEST(PatchLayoutTest, DividesBothSurfacesIntoCorrespondingDisks) {
  const BlockCells fine = {.along = 7, .across = 6, .high = 5, .unrest = 0.2};
  const BlockCells coarse = {.along = 4, .across = 3, .high = 2, .is_mirrored = true};
  ExpectCommon(MakeBlockMesh(BoxShape({3, 2, 1}), fine).marked,
               MakeBlockMesh(ArchShape(2, 1.5, 1, 0.5), coarse).marked, "box");
  ExpectCommon(MakeBlockMesh(PlateShape(3, 2, 0.3, 0.4), fine).marked,
               MakeBlockMesh(PlateShape(2, 2, 0.2, 0.6), coarse).marked, "plate");
  ExpectCommon(MakeBlockMesh(CylinderShape(1, 3), fine).marked,
               MakeBlockMesh(CylinderShape(2, 1), coarse).marked, "cylinder");
  ExpectCommon(MakeBlockMesh(BracketShape(2, 0.3, 0.2, 1), fine).marked,
               MakeBlockMesh(BracketShape(2, 0.3, 0.6, 1), coarse).marked, "bracket");
}

// Where no paths are given all are found: the graph is connected and every patch a disk.
TEST(PatchLayoutTest, NeedsNoMoreThanPoints) {
  MarkedSurface source = MakeBlockMesh(BoxShape({3, 2, 1}), {.along = 5, .unrest = 0.2}).marked;
  MarkedSurface target = MakeBlockMesh(ArchShape(2, 1.5, 1, 0.5), {.high = 3}).marked;
  source.paths.clear();
  ExpectCommon(source, target, "box without paths");
  ASSERT_OK_AND_ASSIGN(const PatchLayout layout, BuildPatchLayout(source, target));
  for (const PatchLayout::Path& path : layout.paths) EXPECT_EQ(path.name, "");
  EXPECT_GE(layout.paths.size(), layout.points.size() - 1);
}

TEST(PatchLayoutTest, KeepsTheGivenPathsAndConnectsWhatTheyLeaveApart) {
  const MarkedSurface plate = MakeBlockMesh(PlateShape(3, 2, 0.3, 0.4), {}).marked;
  ASSERT_OK_AND_ASSIGN(const PatchLayout layout, BuildPatchLayout(plate, plate));
  const auto given =
      std::count_if(layout.paths.begin(), layout.paths.end(),
                    [](const PatchLayout::Path& path) { return !path.name.empty(); });
  EXPECT_EQ(given, static_cast<long>(plate.paths.size()));
  // The ring faces above and below and the wall of the hole each have two pieces of boundary.
  EXPECT_GE(layout.paths.size() - plate.paths.size(), 3U);
}

// On the mirror image all paths lie the other way round their points: those at odds are left out,
// until what is left encloses the same.
TEST(PatchLayoutTest, LeavesOutPathsInAnotherOrder) {
  const MarkedSurface box = MakeBlockMesh(BoxShape({3, 2, 1}), {}).marked;
  MarkedSurface mirrored = box;
  mirrored.surface.vertices.row(0) *= -1;
  mirrored.surface.triangles.row(1).swap(mirrored.surface.triangles.row(2));
  const auto layout = BuildPatchLayout(box, mirrored);
  if (layout.ok()) {
    EXPECT_EQ(OrderAround(*layout, layout->source), OrderAround(*layout, layout->target));
  } else {
    EXPECT_EQ(DetailOf(layout.status()).reason, "TOPOLOGY_DIFFERS");
  }
}

TEST(PatchLayoutTest, SaysWhatIsEnclosedDifferently) {
  // A ring of paths round the middle of a ball, and a point that is above it or below.
  const auto ball = [](double height) {
    MarkedSurface marked;
    marked.surface = mesh::Turned({{0.4, -0.9}, {0.8, -0.6}, {1, 0}, {0.8, 0.6}, {0.4, 0.9}}, 12);
    const auto nearest = [&](const Eigen::Vector3d& place) {
      Eigen::Index vertex = 0;
      (marked.surface.vertices.colwise() - place).colwise().norm().minCoeff(&vertex);
      return static_cast<int>(vertex);
    };
    std::vector<int> ring;
    for (int k = 0; k < 12; ++k) {
      const double angle = 2 * M_PI * k / 12;
      ring.push_back(nearest({std::cos(angle), std::sin(angle), 0}));
    }
    for (const int k : {0, 4, 8}) {
      marked.points.push_back({"ring" + std::to_string(k), ring[static_cast<std::size_t>(k)]});
      ControlPath path{"edge" + std::to_string(k), {}};
      for (int i = k; i <= k + 4; ++i)
        path.vertices.push_back(ring[static_cast<std::size_t>(i % 12)]);
      marked.paths.push_back(path);
    }
    marked.points.push_back({"aside", nearest({0.1, 0.2, height})});
    return marked;
  };
  ASSERT_OK(BuildPatchLayout(ball(0.9), ball(0.5)));
  const auto layout = BuildPatchLayout(ball(0.9), ball(-0.9));
  EXPECT_EQ(layout.status().code(), absl::StatusCode::kFailedPrecondition) << layout.status();
  EXPECT_EQ(DetailOf(layout.status()).reason, "TOPOLOGY_DIFFERS");
}

TEST(PatchLayoutTest, SaysWhereAHandleHasNoPathAroundIt) {
  MarkedSurface torus;
  torus.surface = mesh::Torus(3, 1, 12);
  for (const int vertex : {0, 30, 70, 100}) {
    torus.points.push_back({"point" + std::to_string(vertex), vertex});
  }
  const auto layout = BuildPatchLayout(torus, torus);
  EXPECT_EQ(DetailOf(layout.status()).reason, "PATCH_NOT_SIMPLE") << layout.status();
}

TEST(PatchLayoutTest, NamesTheSurfaceAtFault) {
  const MarkedSurface box = MakeBlockMesh(BoxShape({3, 2, 1}), {}).marked;
  MarkedSurface open = box;
  open.surface.triangles.conservativeResize(3, open.surface.triangles.cols() - 1);
  EXPECT_EQ(DetailOf(BuildPatchLayout(open, box).status()).field, "source.surface");
  EXPECT_EQ(DetailOf(BuildPatchLayout(box, open).status()).field, "target.surface");
}

TEST(PatchLayoutTest, DividesLongPatches) {
  const MarkedSurface beam = MakeBlockMesh(BoxShape({10, 1, 1}), {.along = 30}).marked;
  ASSERT_OK_AND_ASSIGN(const PatchLayout whole, BuildPatchLayout(beam, beam, {.large_patch = 1.0}));
  EXPECT_EQ(whole.walks.size(), 6U);
  // With points in the middle of its edges a beam is divided there: the way around is far longer.
  MarkedSurface marked = beam;
  int named = 0;
  std::vector<ControlPath> halves;
  for (const ControlPath& path : beam.paths) {
    const std::size_t middle = path.vertices.size() / 2;
    if (path.vertices.size() < 20) {
      halves.push_back(path);
      continue;
    }
    marked.points.push_back({"middle" + std::to_string(named++), path.vertices[middle]});
    const auto at = path.vertices.begin() + static_cast<std::ptrdiff_t>(middle);
    halves.push_back({path.name, {path.vertices.begin(), at + 1}});
    halves.push_back({path.name, {at, path.vertices.end()}});
  }
  marked.paths = halves;
  ASSERT_OK_AND_ASSIGN(const PatchLayout divided, BuildPatchLayout(marked, marked));
  EXPECT_EQ(divided.walks.size(), 10U);
}

}  // namespace
}  // namespace mortise::interpolator
