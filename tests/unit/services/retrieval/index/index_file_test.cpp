// Index files: round trips, and everything that can be wrong with them.
#include "services/retrieval/index/index_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/services/retrieval/index/random_covers.h"

namespace mortise::retrieval {
namespace {

using testing::RandomCovers;
using testing::RandomDescriptor;

class IndexFile : public ::testing::Test {
 protected:
  static PrimitiveIndex SmallIndex() {
    Random random(21);
    return *PrimitiveIndex::Build(
        RandomCovers({.families = 3, .primitives = 5, .dimension = 6}, &random));
  }

  // The bytes of an index file.
  std::string Written() {
    EXPECT_OK(WriteIndex(SmallIndex(), "d2/1", "three families", path_));
    return *ReadFile(path_);
  }

  // Reads `bytes` as an index of "d2/1"; a fresh file each time, as mapped ones must not change.
  absl::Status StatusOf(const std::string& bytes) {
    EXPECT_OK(WriteFile(path_, bytes));
    return ReadIndex(path_, "d2/1").status();
  }

  mortise::testing::TemporaryFolder folder_;
  const std::filesystem::path path_ = folder_.path() / "d2.index";
};

TEST_F(IndexFile, AnswersAsTheIndexThatWasWritten) {
  Random random(22);
  ASSERT_OK_AND_ASSIGN(const PrimitiveIndex index,
                       PrimitiveIndex::Build(RandomCovers({}, &random)));
  ASSERT_OK(WriteIndex(index, "d2/1", "about it", path_));
  ASSERT_OK_AND_ASSIGN(const StoredIndex stored, ReadIndex(path_, "d2/1"));
  EXPECT_EQ(stored.about, "about it");
  EXPECT_EQ(stored.index.families(), index.families());
  for (int i = 0; i < 50; ++i) {
    const IndexQuery query{.descriptors = {RandomDescriptor(24, &random)}, .count = 7};
    ASSERT_OK_AND_ASSIGN(const auto expected, index.Nearest(query));
    ASSERT_OK_AND_ASSIGN(const auto found, stored.index.Nearest(query));
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].family, expected[k].family);
      EXPECT_EQ(found[k].distance, expected[k].distance);
      EXPECT_EQ(stored.index.PrimitiveOf(found[k]).parameters,
                index.PrimitiveOf(expected[k]).parameters);
    }
  }
}

TEST_F(IndexFile, HasTheSameBytesForTheSameContentInAnyOrder) {
  Random random(23);
  auto covers = RandomCovers({}, &random);
  ASSERT_OK(WriteIndex(*PrimitiveIndex::Build(covers), "d2/1", "x", path_));
  std::reverse(covers.begin(), covers.end());
  const auto other = folder_.path() / "other.index";
  ASSERT_OK(WriteIndex(*PrimitiveIndex::Build(covers), "d2/1", "x", other));
  EXPECT_EQ(*ReadFile(path_), *ReadFile(other));
}

TEST_F(IndexFile, IsReadOnAfterItWasReplaced) {
  Random random(24);
  Written();
  ASSERT_OK_AND_ASSIGN(const StoredIndex stored, ReadIndex(path_, "d2/1"));
  ASSERT_OK(WriteIndex(*PrimitiveIndex::Build(RandomCovers({}, &random)), "d2/1", "new", path_));
  const IndexQuery query{.descriptors = {RandomDescriptor(6, &random)}};
  ASSERT_OK_AND_ASSIGN(const auto found, stored.index.Nearest(query));
  ASSERT_OK_AND_ASSIGN(const auto expected, SmallIndex().Nearest(query));
  EXPECT_EQ(found[0].distance, expected[0].distance);
  EXPECT_EQ(ReadIndex(path_, "d2/1")->about, "new");
  // Nothing is left beside it.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()),
                          std::filesystem::directory_iterator()),
            1);
}

TEST_F(IndexFile, OutlivesWhatItWasReadInto) {
  Written();
  auto stored = std::make_unique<StoredIndex>(*ReadIndex(path_, "d2/1"));
  const PrimitiveIndex copy = stored->index;
  stored.reset();
  Random random(25);
  EXPECT_OK(copy.Nearest({.descriptors = {RandomDescriptor(6, &random)}}));
}

TEST_F(IndexFile, IsRefusedWithAnyByteChanged) {
  Random random(26);
  ASSERT_OK(WriteIndex(*PrimitiveIndex::Build(
                           RandomCovers({.families = 2, .primitives = 2, .dimension = 3}, &random)),
                       "d2/1", "two families", path_));
  const std::string good = *ReadFile(path_);
  ASSERT_LT(good.size(), 6'000u);
  for (std::size_t i = 0; i < good.size(); ++i) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    std::ofstream(path_, std::ios::binary | std::ios::trunc) << bad;
    const absl::Status status = ReadIndex(path_, "d2/1").status();
    ASSERT_FALSE(status.ok()) << "byte " << i;
    ASSERT_NE(DetailOf(status).reason, "") << "byte " << i;
  }
}

TEST_F(IndexFile, IsRefusedWhereItIsCutOffOrTooLong) {
  const std::string good = Written();
  for (const std::size_t size : {std::size_t{0}, std::size_t{7}, std::size_t{200}, good.size() / 2,
                                 good.size() - 8, good.size() - 1}) {
    const absl::Status status = StatusOf(good.substr(0, size));
    EXPECT_EQ(status.code(), absl::StatusCode::kDataLoss) << size;
    EXPECT_EQ(DetailOf(status).reason, "INDEX_DAMAGED");
  }
  EXPECT_EQ(StatusOf(good + std::string(8, '\0')).code(), absl::StatusCode::kDataLoss);
  EXPECT_OK(StatusOf(good));
}

TEST_F(IndexFile, OfAnotherVersionIsRefusedBySayingSo) {
  std::string other = Written();
  other[8] = 77;
  const absl::Status status = StatusOf(other);
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "INDEX_OF_ANOTHER_VERSION");
  EXPECT_NE(status.message().find("version 77"), std::string::npos);
}

TEST_F(IndexFile, OfAnotherDescriptorIsRefusedBySayingSo) {
  Written();
  const absl::Status status = ReadIndex(path_, "light-field/1").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "INDEX_OF_ANOTHER_DESCRIPTOR");
  EXPECT_NE(status.message().find("'d2/1'"), std::string::npos);
}

TEST_F(IndexFile, ThatIsMissingOrAFolderIsSaidToBe) {
  EXPECT_EQ(ReadIndex(path_, "d2/1").status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(ReadIndex(folder_.path(), "d2/1").status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(IndexFile, NeedsAShortNameOfItsDescriptor) {
  for (const std::string& name : {std::string(), std::string(64, 'x'), std::string("a\0b", 3)}) {
    EXPECT_EQ(WriteIndex(SmallIndex(), name, "", path_).code(), absl::StatusCode::kInvalidArgument);
  }
  EXPECT_OK(WriteIndex(SmallIndex(), std::string(63, 'x'), "", path_));
  EXPECT_OK(ReadIndex(path_, std::string(63, 'x')));
}

}  // namespace
}  // namespace mortise::retrieval
