// Pressures that are read from faces of cells and carried over to a surface.
#include "services/simulator/airflow/wall_pressure.h"

#include <gtest/gtest.h>

#include <string>

#include "absl/strings/str_replace.h"
#include "common/mesh/mass_properties.h"
#include "tests/unit/services/simulator/airflow/bodies_in_air.h"

namespace mortise::simulator {
namespace {

// A square of edge 2 at z = 1 and a triangle, as OpenFOAM 1912 writes them.
constexpr char kTwoFaces[] = R"(# vtk DataFile Version 2.0
body
ASCII
DATASET POLYDATA
POINTS 5 float
0 0 1 2 0 1 2 2 1
0 2 1 4 0 1
POLYGONS 2 9
4 0 1 2 3
3 1 4 2

CELL_DATA 2
FIELD attributes 1
coefficient 1 2 float
-0.25 1.5e0
)";

TEST(WallPressure, ReadsFacesAndTheirValues) {
  const auto faces = ReadWallFaces(kTwoFaces);
  ASSERT_TRUE(faces.ok()) << faces.status();
  ASSERT_EQ(faces->values.size(), 2);
  EXPECT_EQ(faces->values[0], -0.25);
  EXPECT_EQ(faces->values[1], 1.5);
  EXPECT_TRUE(faces->centers.col(0).isApprox(Eigen::Vector3d(1, 1, 1)));
  // Out of the body: against the way in which the cells' faces look.
  EXPECT_TRUE(faces->areas.col(0).isApprox(Eigen::Vector3d(0, 0, -4)));
  EXPECT_TRUE(faces->areas.col(1).isApprox(Eigen::Vector3d(0, 0, -2)));
}

TEST(WallPressure, RefusesBrokenFiles) {
  const std::string whole = kTwoFaces;
  for (std::size_t length = 0; length + 8 < whole.size(); length += 5) {
    const auto faces = ReadWallFaces(whole.substr(0, length));
    EXPECT_EQ(faces.status().code(), absl::StatusCode::kInternal) << whole.substr(0, length);
  }
  for (const auto& [from, to] : {std::pair{"3 1 4 2", "3 1 5 2"},
                                 {"3 1 4 2", "3 1 -4 2"},
                                 {"4 0 1 2 3", "2 0 1 2 3"},
                                 {"POINTS 5", "POINTS 99999999999"},
                                 {"POLYGONS 2", "POLYGONS 3"},
                                 {"POLYGONS 2", "POLYGONS -1"},
                                 {"1.5e0", "nan"},
                                 {"coefficient 1", "coefficient 3"}}) {
    const auto faces = ReadWallFaces(absl::StrReplaceAll(whole, {{from, to}}));
    EXPECT_EQ(faces.status().code(), absl::StatusCode::kInternal) << to;
  }
}

TEST(WallPressure, DividesTrianglesUntilTheyAreShort) {
  const mesh::SurfaceMesh brick = Brick({1, 0.3, 0.002});
  const mesh::SurfaceMesh divided = DividedTriangles(brick, 0.05);
  EXPECT_NEAR(mesh::SurfaceArea(divided), mesh::SurfaceArea(brick), 1e-12);
  EXPECT_NEAR(mesh::ComputeMassProperties(divided).volume,
              mesh::ComputeMassProperties(brick).volume, 1e-15);
  EXPECT_EQ(divided.vertices.cols(), 3 * divided.triangles.cols());
  for (const auto& triangle : divided.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(
          (divided.vertices.col(triangle[k]) - divided.vertices.col(triangle[(k + 1) % 3])).norm(),
          0.05);
    }
  }
  // No more than the area and the narrow sides ask for.
  EXPECT_LT(divided.triangles.cols(), 8000);
  EXPECT_EQ(DividedTriangles(brick, 10).triangles.cols(), 12);
}

// Faces of cells on a plate of 1 m x 1 m x 1 mm: above with 2 and below with -3, on a grid.
WallFaces FacesOfPlate() {
  constexpr int kAlong = 20;
  WallFaces faces;
  faces.centers.resize(3, 2 * kAlong * kAlong);
  faces.areas.setZero(3, 2 * kAlong * kAlong);
  faces.values.resize(2 * kAlong * kAlong);
  Eigen::Index f = 0;
  for (int i = 0; i < kAlong; ++i) {
    for (int j = 0; j < kAlong; ++j) {
      for (const double side : {1.0, -1.0}) {
        faces.centers.col(f) << (i + 0.5) / kAlong - 0.5, (j + 0.5) / kAlong - 0.5, 0.0005 * side;
        faces.areas(2, f) = side / (kAlong * kAlong);
        faces.values[f++] = side > 0 ? 2 : -3;
      }
    }
  }
  return faces;
}

TEST(WallPressure, SidesOfAThinPlateKeepTheirOwn) {
  const mesh::SurfaceMesh plate = DividedTriangles(Brick({1, 1, 0.001}), 0.1);
  const WallFaces faces = FacesOfPlate();
  const Eigen::VectorXd values = ValuesAtVertices(faces, plate);
  for (const auto& triangle : plate.triangles.colwise()) {
    const Eigen::Vector3d a = plate.vertices.col(triangle[0]), b = plate.vertices.col(triangle[1]),
                          c = plate.vertices.col(triangle[2]);
    const double upright = (b - a).cross(c - a).normalized().z();
    for (const int v : triangle) {
      EXPECT_GE(values[v], upright > 0.9 ? 2 - 1e-12 : -3 - 1e-12);
      EXPECT_LE(values[v], upright < -0.9 ? -3 + 1e-12 : 2 + 1e-12);
    }
  }
}

// Nodes above and below a plate have their side's value, whether they are corners or middles; at
// its edges the sides' areas tell how much they count, and nodes of no triangle have none.
TEST(WallPressure, NodesHaveTheMeanOfTheirTriangles) {
  const WallFaces faces = FacesOfPlate();
  Eigen::Matrix3Xd nodes(3, 11);
  nodes << -0.4, 0.4, 0, 0, 0.2, -0.2, -0.4, 0.4, 0, 0.3, 0,  //
      -0.4, -0.4, 0.4, -0.4, 0, 0, -0.4, -0.4, 0.4, 0.3, 0,   //
      1, 1, 1, 1, 1, 1, -1, -1, -1, 1, 0;
  nodes.row(2) *= 0.0005;
  Eigen::MatrixXi curved(6, 1), flat(3, 2);
  curved << 0, 1, 2, 3, 4, 5;
  flat << 6, 0, 8, 1, 7, 2;
  const Eigen::VectorXd of_curved = ValuesAtNodes(faces, nodes, curved);
  EXPECT_LT((of_curved.head(6).array() - 2).abs().maxCoeff(), 1e-12);
  EXPECT_EQ(of_curved.tail(5), Eigen::VectorXd::Zero(5));
  const Eigen::VectorXd of_flat = ValuesAtNodes(faces, nodes, flat);
  EXPECT_NEAR(of_flat[0], 2, 1e-12);
  EXPECT_NEAR(of_flat[6], -3, 1e-12);
  // A node that both sides share, as that of a plate without thickness.
  flat(0, 0) = 0;
  EXPECT_NEAR(ValuesAtNodes(faces, nodes, flat)[0], -0.5, 1e-3);
}

}  // namespace
}  // namespace mortise::simulator
