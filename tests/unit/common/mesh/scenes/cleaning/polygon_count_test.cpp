// Polygons that take too long to divide into triangles are refused before anybody tries.
#include "common/mesh/scenes/cleaning/polygon_count.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/mesh/scenes/cleaning/scene_limits.h"
#include "common/mesh/scenes/scene_import.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/mesh/scenes/refusals.h"

namespace mortise::mesh {
namespace {

using ::testing::HasSubstr;

// A regular polygon as the corners of one face, behind a triangle.
struct RoundFace {
  explicit RoundFace(std::int64_t corners) {
    for (std::int64_t i = 0; i < corners; ++i) {
      const double angle =
          2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(corners);
      absl::StrAppend(&places, std::cos(angle), " ", std::sin(angle), " 0\n");
      absl::StrAppend(&corner_list, " ", i);
    }
    count = corners;
  }

  std::string Obj() const {
    std::string text;
    for (std::size_t begin = 0; begin < places.size();) {
      const std::size_t end = places.find('\n', begin) + 1;
      absl::StrAppend(&text, "v ", places.substr(begin, end - begin));
      begin = end;
    }
    text += "f 1 2 3\nf";
    for (std::int64_t i = 1; i <= count; ++i) absl::StrAppend(&text, " ", i);
    return text + "\n";
  }

  std::string Off() const {
    return absl::StrCat("OFF\n", count, " 2 0\n", places, "3 0 1 2\n", count, corner_list, "\n");
  }

  std::string BinaryPly() const {
    std::string bytes =
        absl::StrCat("ply\nformat binary_little_endian 1.0\nelement vertex ", count,
                     "\nproperty float x\nproperty float y\nproperty float z\n"
                     "element face 2\nproperty list uint int vertex_indices\nend_header\n");
    const auto add = [&](auto number) {
      bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
    };
    for (std::int64_t i = 0; i < 3 * count; ++i) add(static_cast<float>(i % 17));
    add(std::uint32_t{3});
    for (const std::int32_t corner : {0, 1, 2}) add(corner);
    add(static_cast<std::uint32_t>(count));
    for (std::int64_t i = 0; i < count; ++i) add(static_cast<std::int32_t>(i));
    return bytes;
  }

  std::int64_t count = 0;
  std::string places, corner_list;
};

TEST(PolygonCount, RefusesAFaceOfTooManyCornersByItsNumber) {
  const RoundFace million(1'000'000);
  for (const std::string& file : {million.Obj(), million.Off(), million.BinaryPly()}) {
    const std::string refusal = Refusal(file, "", absl::StatusCode::kResourceExhausted);
    EXPECT_THAT(refusal, HasSubstr("face 2"));
    EXPECT_THAT(refusal, HasSubstr("has 1000000 corners, more than"));
  }
}

TEST(PolygonCount, ReadsAFaceOfAsManyCornersAsOneMayHave) {
  const RoundFace most(kMaxPolygonCorners);
  ASSERT_OK_AND_ASSIGN(const Scene scene, ImportScene(most.Obj(), ""));
  double area = 0;
  for (const auto& corners : scene.components[0].triangles.colwise()) {
    const Eigen::Matrix3d at = scene.components[0].vertices(Eigen::all, corners);
    area += 0.5 * (at.col(1) - at.col(0)).cross(at.col(2) - at.col(0)).norm();
  }
  EXPECT_NEAR(area, std::numbers::pi, 1e-5);
}

TEST(PolygonCount, CountsWhatFacesTakeTogether) {
  PolygonCount count;
  absl::Status status;
  while (status.ok()) status = count.Add(kMaxPolygonCorners, "line 7");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(count.faces(), kMaxCornerPairs / (kMaxPolygonCorners * kMaxPolygonCorners) + 1);
  EXPECT_THAT(std::string(status.message()), HasSubstr(absl::StrCat("face ", count.faces())));
  EXPECT_THAT(std::string(status.message()), HasSubstr("line 7"));
  // As many triangles as a file may have, and the quadrangles of as many, are no trouble.
  PolygonCount triangles, quadrangles;
  for (std::int64_t i = 0; i < kMaxSceneTriangles; ++i) ASSERT_OK(triangles.Add(3, ""));
  for (std::int64_t i = 0; i < kMaxSceneTriangles / 2; ++i) ASSERT_OK(quadrangles.Add(4, ""));
  EXPECT_THAT(std::string(triangles.Add(3, "").message()), HasSubstr("2,000,000 triangles"));
}

}  // namespace
}  // namespace mortise::mesh
