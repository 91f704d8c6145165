#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/mesh/scenes/scene_import.h"
#include "tests/support/scene_files.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/scenes/refusals.h"

namespace mortise::mesh {
namespace {

using ::testing::HasSubstr;

constexpr const char* kTriangle = "0 0 0\n1 0 0\n0 1 0\n";

TEST(OffFile, IsRead) {
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene(testing::WriteOff(testing::Sheet(4)), "a.off"));
  EXPECT_EQ(scene.components[0].triangles.cols(), 32);
  EXPECT_EQ(scene.components[0].vertices.cols(), 25);
}

TEST(OffFile, IsReadInItsDialects) {
  for (const std::string head :
       {"OFF 3 1 0\n", "OFF3 1 0\n", "# chair\r\n\r\nOFF\r\n3 1 0 # counts\n", "COFF\n3 1\n",
        "STCNOFF\n3 1 0\n"}) {
    ASSERT_OK_AND_ASSIGN(const Scene scene,
                         ImportScene(absl::StrCat(head,
                                                  "0 0 0 255 0 0\n\n1 0 0 255 0 0\n"
                                                  "0 1 0 0 0 0\n3 0 1 2 0.5 0.5 0.5\n"),
                                     "a.off"));
    EXPECT_EQ(BoxOf(scene).sizes(), Eigen::Vector3d(1, 1, 0)) << head;
  }
  ASSERT_OK_AND_ASSIGN(const Scene weighted,
                       ImportScene("4OFF\n3 1 0\n0 0 0 1\n4 0 0 2\n0 3 0 1\n3 0 1 2\n", ""));
  EXPECT_EQ(BoxOf(weighted).sizes(), Eigen::Vector3d(2, 3, 0));
}

TEST(OffFile, MayHaveFacesOfManyCorners) {
  std::string text = "OFF\n12 1 0\n";
  for (int i = 0; i < 12; ++i) {
    absl::StrAppend(&text, std::cos(i * M_PI / 6), " ", std::sin(i * M_PI / 6), " 0\n");
  }
  ASSERT_OK_AND_ASSIGN(const Scene scene,
                       ImportScene(text + "12 0 1 2 3 4 5 6 7 8 9 10 11\n", "a.off"));
  EXPECT_EQ(scene.components[0].triangles.cols(), 10);
}

TEST(OffFile, IsRefusedWithWhatIsWrong) {
  EXPECT_THAT(Refusal(absl::StrCat("OFF\n4 1 0\n", kTriangle)),
              HasSubstr("declares 4 vertices, but ends after 3"));
  EXPECT_THAT(Refusal(absl::StrCat("OFF\n3 2 0\n", kTriangle, "3 0 1 2\n")),
              HasSubstr("declares 2 faces, but ends after 1"));
  EXPECT_THAT(Refusal("OFF\n4000000000 4000000000 0\n0 0 0\n"), HasSubstr("ends after 1"));
  EXPECT_THAT(Refusal(absl::StrCat("OFF\n3 1 0\n", kTriangle, "3 0 1 3\n")),
              HasSubstr("line 6: a face names vertex 4 of 3"));
  EXPECT_THAT(Refusal(absl::StrCat("OFF\n3 1 0\n", kTriangle, "3 0 1 -1\n")), HasSubstr("line 6"));
  EXPECT_THAT(Refusal(absl::StrCat("OFF\n3 1 0\n", kTriangle, "1000000000 0 1 2\n")),
              HasSubstr("names 3 vertices"));
  EXPECT_THAT(Refusal("OFF\n3 1 0\n0 0 0\n1 0\n0 1 0\n3 0 1 2\n"), HasSubstr("line 4"));
  EXPECT_THAT(Refusal("OFF\n3 1 0\n0 0 0\ninf 0 0\n0 1 0\n3 0 1 2\n"), HasSubstr("line 4"));
  EXPECT_THAT(Refusal("OFF BINARY\n"), HasSubstr("binary OFF"));
  EXPECT_THAT(Refusal("OFF\n"), HasSubstr("ends before the numbers"));
  EXPECT_THAT(Refusal("OFF\nthree one\n"), HasSubstr("numbers of vertices and faces"));
  EXPECT_THAT(Refusal("4nOFF\n4\n3 1 0\n"), HasSubstr("dimensions"));
}

}  // namespace
}  // namespace mortise::mesh
