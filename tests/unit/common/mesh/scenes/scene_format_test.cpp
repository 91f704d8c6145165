#include "common/mesh/scenes/scene_format.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>

#include "common/base/errors.h"
#include "tests/support/scene_files.h"

namespace mortise::mesh {
namespace {

using ::testing::HasSubstr;
using testing::Tetrahedron;

TEST(SceneFormat, IsToldByContent) {
  const auto mesh = Tetrahedron();
  const std::string buffer = testing::GltfBuffer(mesh);
  EXPECT_EQ(*DetectSceneFormat(testing::WriteObj(mesh)), SceneFormat::kObj);
  EXPECT_EQ(*DetectSceneFormat(testing::WriteOff(mesh)), SceneFormat::kOff);
  EXPECT_EQ(*DetectSceneFormat(testing::WriteTextPly(mesh)), SceneFormat::kPly);
  EXPECT_EQ(*DetectSceneFormat(testing::WriteBinaryPly(mesh)), SceneFormat::kPly);
  EXPECT_EQ(*DetectSceneFormat(testing::WriteTextStl(mesh, "a")), SceneFormat::kStl);
  EXPECT_EQ(*DetectSceneFormat(testing::WriteBinaryStl(mesh)), SceneFormat::kStl);
  EXPECT_EQ(*DetectSceneFormat(testing::WriteGlb(mesh)), SceneFormat::kGlb);
  EXPECT_EQ(*DetectSceneFormat(testing::PackGltf(testing::GltfDocument(mesh), buffer)),
            SceneFormat::kGltf);
}

TEST(SceneFormat, IsToldBehindCommentsAndAByteOrderMark) {
  EXPECT_EQ(
      *DetectSceneFormat("\xEF\xBB\xBF# made by hand\r\n\r\nmtllib a.mtl\r\no x\r\nv 0 0 0\r\n"),
      SceneFormat::kObj);
  EXPECT_EQ(*DetectSceneFormat("# comment\nCOFF\n"), SceneFormat::kOff);
}

TEST(SceneFormat, OfABinaryStlIsToldWhereItsHeaderSaysSolid) {
  std::string bytes = testing::WriteBinaryStl(Tetrahedron());
  bytes.replace(0, 9, "solid cad");
  EXPECT_EQ(*DetectSceneFormat(bytes), SceneFormat::kStl);
}

TEST(SceneFormat, IsSaidWhereItIsNotRead) {
  for (const auto& [bytes, what] :
       {std::pair<std::string, std::string>{"", "is empty"},
        {"  \n ", "empty"},
        {"ISO-10303-21;\nHEADER;", "STEP"},
        {"PK\3\4junk", "ZIP"},
        {"\x1f\x8b\x08\x08junk", "gzip"},
        {"Kaydara FBX Binary  ", "FBX"},
        {"<?xml version=\"1.0\"?><COLLADA/>", "COLLADA"},
        {"\x89PNG\r\n", "PNG"},
        {"%PDF-1.4", "PDF"},
        {"dear all,\nplease find a chair", "neither vertices nor faces"}}) {
    const auto format = DetectSceneFormat(bytes);
    EXPECT_EQ(format.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_EQ(DetailOf(format.status()).field, "file");
    EXPECT_THAT(std::string(format.status().message()), HasSubstr(what));
  }
}

TEST(SceneFormat, IsKnownByNamesOfFiles) {
  EXPECT_EQ(FormatOfName("Chair.OBJ"), SceneFormat::kObj);
  EXPECT_EQ(FormatOfName("ply"), SceneFormat::kPly);
  EXPECT_EQ(FormatOfName("a.b.glb"), SceneFormat::kGlb);
  EXPECT_FALSE(FormatOfName("chair.step"));
  EXPECT_FALSE(FormatOfName(""));
  EXPECT_EQ(NameOf(SceneFormat::kGltf), "glTF");
}

TEST(CheckFileName, RefusesWhatNoFileIsCalled) {
  EXPECT_TRUE(CheckFileName("").ok());
  EXPECT_TRUE(CheckFileName("große Stühle (2).obj").ok());
  EXPECT_FALSE(CheckFileName(std::string(256, 'a')).ok());
  EXPECT_FALSE(CheckFileName(std::string("a\0b", 3)).ok());
}

}  // namespace
}  // namespace mortise::mesh
