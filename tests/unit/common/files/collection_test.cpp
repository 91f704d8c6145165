// Collections on disk: their numbers, which say which of two is newer.
#include "common/files/collection.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "absl/strings/str_cat.h"
#include "common/base/files.h"
#include "tests/support/temporary_folder.h"

namespace mortise::parametric {
namespace {

class CollectionNumberTest : public ::testing::Test {
 protected:
  void WriteMaterials(const std::string& file, const std::string& materials) {
    ASSERT_TRUE(WriteFile(folder_.path() / file,
                          "# proto-file: mortise/v1/template.proto\n"
                          "# proto-message: mortise.v1.TemplateBundle\n" +
                              materials)
                    .ok());
  }

  void WriteVersions(const std::string& rows) {
    ASSERT_TRUE(WriteFile(folder_.path() / "versions.csv", "number,digest\n" + rows).ok());
  }

  Collection Read() { return ReadCollection(folder_.path()).value(); }

  testing::TemporaryFolder folder_;
  const std::string oak_ = "materials { name: 'materials/oak' density: 700 }\n";
  const std::string ash_ = "materials { name: 'materials/ash' density: 650 }\n";
};

// What ships has an order only if its number goes up with every change.
TEST(ShippedCollection, HasANumberForItsContent) {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  const auto collection =
      ReadCollection(std::filesystem::path(source == nullptr ? "." : source) / "collection");
  ASSERT_TRUE(collection.ok()) << collection.status();
  EXPECT_GT(collection->number, 0)
      << "The content of collection/ has changed. Add a line to collection/versions.csv with the "
         "next number, a comma and "
      << ContentDigest(*collection);
}

TEST(ShippedCollection, HasACategoryOfEachTemplate) {
  const char* source = std::getenv("MORTISE_SOURCE_DIR");
  const auto collection =
      ReadCollection(std::filesystem::path(source == nullptr ? "." : source) / "collection");
  ASSERT_TRUE(collection.ok()) << collection.status();
  for (const v1::Template& each : collection->templates) {
    EXPECT_EQ(each.labels().count("category"), 1u) << each.name();
  }
  for (const v1::Assembly& each : collection->assemblies) {
    EXPECT_EQ(each.labels().count("category"), 1u) << each.name();
  }
}

TEST_F(CollectionNumberTest, RefusesCategoriesThatAreNoTable) {
  const auto status_of = [this](const std::string& text) {
    EXPECT_TRUE(WriteFile(folder_.path() / "categories.csv", text).ok());
    return ReadCollection(folder_.path()).status();
  };
  EXPECT_TRUE(status_of("name,category\ntemplates/none,chair\n").ok());
  for (const char* wrong : {"template,category\ntemplates/none,chair\n",
                            "name,category\ntemplates/none,chair\ntemplates/none,table\n"}) {
    const absl::Status status = status_of(wrong);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << wrong;
    EXPECT_NE(status.message().find("categories.csv: line"), std::string::npos) << status;
  }
}

TEST_F(CollectionNumberTest, HaveTheNumberOfTheirContent) {
  WriteMaterials("materials.textproto", oak_);
  EXPECT_EQ(Read().number, 0);
  const std::string first = ContentDigest(Read());
  WriteVersions(absl::StrCat("1,", first, "\n"));
  EXPECT_EQ(Read().number, 1);
  WriteMaterials("materials.textproto", oak_ + ash_);
  EXPECT_EQ(Read().number, 0) << "changed without a number";
  WriteVersions(absl::StrCat("1,", first, "\n4,", ContentDigest(Read()), "\n"));
  EXPECT_EQ(Read().number, 4);
  WriteMaterials("materials.textproto", oak_);
  EXPECT_EQ(Read().number, 0) << "only the last number counts";
}

TEST_F(CollectionNumberTest, TheDigestIsOfTheContentAlone) {
  WriteMaterials("materials.textproto", oak_ + ash_);
  const std::string digest = ContentDigest(Read());
  WriteMaterials("materials.textproto", "# A remark.\n" + ash_ + "\n" + oak_);
  EXPECT_EQ(ContentDigest(Read()), digest);
  WriteMaterials("materials.textproto", oak_);
  WriteMaterials("items/more.textproto", ash_);
  EXPECT_EQ(ContentDigest(Read()), digest);
  WriteMaterials("items/more.textproto", "materials { name: 'materials/ash' density: 651 }");
  EXPECT_NE(ContentDigest(Read()), digest);
}

TEST_F(CollectionNumberTest, NumbersThatDoNotGoUpAreRefusedWithTheirPlace) {
  for (const std::string& rows :
       {std::string("2,a\n2,b\n"), std::string("2,a\n1,b\n"), std::string("1,a\n0,b\n"),
        std::string("1,a\nx,b\n"), std::string("1,a\n9223372036854775808,b\n")}) {
    WriteVersions(rows);
    const absl::Status status = ReadCollection(folder_.path()).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << rows;
    EXPECT_NE(status.message().find("versions.csv: line 3, column 1"), std::string::npos) << status;
  }
  ASSERT_TRUE(WriteFile(folder_.path() / "versions.csv", "version\n1\n").ok());
  EXPECT_EQ(ReadCollection(folder_.path()).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace mortise::parametric
