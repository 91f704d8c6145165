// Ground in files, by their extension: units, origins, and messages as they are.
#include "cli/files/ground_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/files.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class GroundFile : public ::testing::Test {
 protected:
  absl::StatusOr<v1::HeightField> Read(const std::string& name, const std::string& text,
                                       const GroundUnits& units = {}) {
    const std::filesystem::path file = folder_.path() / name;
    EXPECT_OK(WriteFile(file, text));
    return ReadGround(file, units);
  }

  const mortise::testing::TemporaryFolder folder_;
};

TEST_F(GroundFile, IsScaledAndMoved) {
  const GroundUnits units = {.unit = 0.001, .origin = {1, 2}};
  ASSERT_OK_AND_ASSIGN(
      const v1::HeightField points,
      Read("points.CSV", "x,y,z\n1000,2000,100\n2000,2000,200\n1000,3000,300\n2000,3000,0\n",
           units));
  EXPECT_NEAR(points.grid().x(), 0, 1e-12);
  EXPECT_NEAR(points.grid().y(), 0, 1e-12);
  EXPECT_NEAR(points.grid().x_spacing(), 1, 1e-12);
  EXPECT_THAT(points.grid().heights(), ElementsAre(0.1, 0.2, 0.3, 0));
  ASSERT_OK_AND_ASSIGN(
      const v1::HeightField scan,
      Read("scan.obj", "v 1000 2000 100\nv 2000 2000 100\nv 1000 4000 300\nf 1 2 3\n", units));
  EXPECT_THAT(scan.triangles().vertices(),
              ElementsAre(0, 0, ::testing::DoubleEq(0.1), 1, 0, ::testing::DoubleEq(0.1), 0, 2,
                          ::testing::DoubleEq(0.3)));
}

TEST_F(GroundFile, MayBeAMessage) {
  const std::string text =
      "name: 'x' title: 'Bank' datum: 3 triangles { vertices: [0, 0, 1, 1, 0, 1, 0, 1, 1] "
      "triangles: [0, 1, 2] }";
  ASSERT_OK_AND_ASSIGN(const v1::HeightField field, Read("bank.textproto", text));
  EXPECT_EQ(field.title(), "Bank");
  EXPECT_EQ(field.datum(), 3);
  EXPECT_THAT(Read("bank.textproto", text, {.unit = 0.001}).status().message(),
              HasSubstr("--unit"));
  EXPECT_THAT(Read("odd.textproto", "grid {\n  colums: 3\n}").status().message(),
              HasSubstr("odd.textproto: line 2"));
}

TEST_F(GroundFile, IsToldByItsExtension) {
  EXPECT_THAT(Read("bank.xyz", "0 0 0").status().message(),
              HasSubstr("is no .csv with points, .asc, .obj, .stl or .textproto"));
  EXPECT_TRUE(absl::IsNotFound(ReadGround(folder_.path() / "none.csv", {}).status()));
}

}  // namespace
}  // namespace mortise::cli
