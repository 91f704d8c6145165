// Grids as surveys and rasters write them.
#include "cli/files/ground_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"

namespace mortise::cli {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsNan;

std::string PointsFault(const std::string& text) {
  return std::string(ParseGroundPoints(text, "p.csv").status().message());
}

std::string EsriFault(const std::string& text) {
  return std::string(ParseEsriGrid(text, "g.asc").status().message());
}

TEST(GroundPoints, FormAGridInAnyOrder) {
  ASSERT_OK_AND_ASSIGN(
      const v1::HeightGrid grid,
      ParseGroundPoints("0.5,2,5\n0,1,1\n1,2,6\n0.5,1,2\n0,2,4\n1,1,3\n", "p.csv"));
  EXPECT_EQ(grid.x(), 0);
  EXPECT_EQ(grid.y(), 1);
  EXPECT_EQ(grid.x_spacing(), 0.5);
  EXPECT_EQ(grid.y_spacing(), 1);
  EXPECT_EQ(grid.columns(), 3);
  EXPECT_THAT(grid.heights(), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(GroundPoints, MayHaveAHeadingAndMoreColumns) {
  ASSERT_OK_AND_ASSIGN(
      const v1::HeightGrid grid,
      ParseGroundPoints("code, Y ,X,Height\nG,0,0,1\nG,0,1,2\nG,1,0,3\nG,1,1,4\n", "p.csv"));
  EXPECT_THAT(grid.heights(), ElementsAre(1, 2, 3, 4));
}

TEST(GroundPoints, ThatAreMissingAreHoles) {
  ASSERT_OK_AND_ASSIGN(
      const v1::HeightGrid grid,
      ParseGroundPoints("0,0,1\n0.333,0,2\n1,0,3\n0,1,4\n0.667,1,5\n0.333,1,6\n1,1,7\n", "p.csv"));
  EXPECT_EQ(grid.columns(), 4);
  EXPECT_NEAR(grid.x_spacing(), 1.0 / 3, 1e-12);
  EXPECT_THAT(grid.heights(), ElementsAre(1, 2, IsNan(), 3, 4, 6, 5, 7));
}

TEST(GroundPoints, AreRefusedWithTheirLines) {
  EXPECT_THAT(PointsFault("x,y,z\n0,0,1\n0,1,high\n1,0,\n"),
              AllOf(HasSubstr("p.csv: line 3, column 3"), HasSubstr("p.csv: line 4, column 3")));
  EXPECT_THAT(PointsFault("0,0,1\n1,0,1\n0,1,1\n1,1,1\n0.4,0,2\n0.7,1,3\n"),
              AllOf(HasSubstr("line"), HasSubstr("lies on no grid"),
                    HasSubstr("as triangles, in an OBJ or STL file")));
  EXPECT_THAT(PointsFault("0,0,1\n1,0,1\n0,1,1\n1,0,2\n"),
              HasSubstr("p.csv: line 4: the point is there already, in line 2"));
  EXPECT_THAT(PointsFault("0,0,1\n1,0,1\n"), HasSubstr("has points at one y only"));
  EXPECT_THAT(PointsFault("east,north,up\n1,2,3\n"), HasSubstr("'x', 'y' and 'z'"));
  EXPECT_THAT(PointsFault(""), HasSubstr("has no points"));
  EXPECT_THAT(PointsFault("0,0,1\n0.001,0,1\n5000,3000,1\n0,1,1\n"), HasSubstr("are accepted"));
}

constexpr char kHeader[] = "ncols 3\nnrows 2\nxllcorner 10\nyllcenter 20\ncellsize 2\n";

TEST(EsriGrid, HasTheNorthernRowFirst) {
  ASSERT_OK_AND_ASSIGN(
      const v1::HeightGrid grid,
      ParseEsriGrid(std::string(kHeader) + "NODATA_value -1\r\n4 5 6\r\n1 -1 3\r\n", "g.asc"));
  EXPECT_EQ(grid.x(), 11) << "the middle of a cell";
  EXPECT_EQ(grid.y(), 20);
  EXPECT_EQ(grid.x_spacing(), 2);
  EXPECT_EQ(grid.columns(), 3);
  EXPECT_THAT(grid.heights(), ElementsAre(1, IsNan(), 3, 4, 5, 6));
}

TEST(EsriGrid, IsRefusedWithItsLines) {
  EXPECT_THAT(EsriFault(std::string(kHeader) + "1 2 3\n4 five 6\n"),
              HasSubstr("g.asc: line 7: 'five'"));
  EXPECT_THAT(EsriFault(std::string(kHeader) + "1 2 3\n4 5\n"),
              HasSubstr("there are 5 heights, where the grid has 6"));
  EXPECT_THAT(EsriFault(std::string(kHeader) + "1 2 3\n4 5 6\n7\n"), HasSubstr("g.asc: line 8"));
  EXPECT_THAT(EsriFault("ncols 3\nnrows 2\n1 2 3 4 5 6\n"), HasSubstr("has no 'cellsize'"));
  EXPECT_THAT(EsriFault("ncols 3\nnrows 2\ncellsize 1\nyllcorner 1\n1 2 3 4 5 6\n"),
              HasSubstr("neither 'xllcorner' nor 'xllcenter'"));
  EXPECT_THAT(EsriFault("ncols 9000\nnrows 9000\ncellsize 1\n"), HasSubstr("9000 x 9000"));
  EXPECT_THAT(EsriFault("ncols 2.5\nnrows 2\n"), HasSubstr("'ncols' must be a whole number"));
}

}  // namespace
}  // namespace mortise::cli
