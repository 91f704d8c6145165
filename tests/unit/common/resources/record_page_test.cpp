// Pages of records: every one once, in either order, never larger than clients take.
#include "common/resources/record_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_format.h"
#include "tests/support/temporary_folder.h"

namespace mortise::resources {
namespace {

// What lists show, for this test: a text that says of itself how large it is.
struct Text {
  std::string value;
  std::size_t ByteSizeLong() const { return value.size(); }
  bool ParseFromString(const std::string& bytes) {
    value = bytes;
    return bytes != "damaged";
  }
};

class RecordPageTest : public ::testing::Test {
 protected:
  void Put(const std::string& key, const std::string& payload) {
    const absl::Status stored = store_->Transact([&](store::Transaction& transaction) {
      return transaction.Put("texts", key, payload).status();
    });
    ASSERT_TRUE(stored.ok()) << stored;
  }

  absl::StatusOr<Page<Text>> Read(const RecordList& list, const PageQuery& query) {
    Page<Text> page;
    const absl::Status read =
        store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(page, ReadPage<Text>(transaction, list, query));
          return absl::OkStatus();
        });
    if (!read.ok()) return read;
    return page;
  }

  // The sizes of all pages, in entries; each must stay below the rule's bytes.
  std::vector<std::size_t> PageSizes(const RecordList& list, int size) {
    std::vector<std::size_t> sizes;
    seen_.clear();
    PageQuery query{size, ""};
    do {
      const auto page = Read(list, query);
      EXPECT_TRUE(page.ok()) << page.status();
      if (!page.ok()) return sizes;
      std::size_t bytes = 0;
      for (const Text& text : page->entries) {
        bytes += text.value.size();
        seen_.push_back(text.value.substr(0, 4));
      }
      EXPECT_TRUE(bytes <= kMaxPageBytes || page->entries.size() == 1);
      sizes.push_back(page->entries.size());
      query.after = page->next_page_token;
    } while (!query.after.empty());
    return sizes;
  }

  void PutMany(int count, std::size_t size) {
    for (int i = 0; i < count; ++i) {
      const std::string key = absl::StrFormat("t%03d", i);
      Put(key, key + std::string(size, '.'));
    }
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = "sqlite:" + (folder_.path() / "store.db").string()}).value();
  std::vector<std::string> seen_;  // keys, of the last PageSizes
};

TEST_F(RecordPageTest, HasAsManyEntriesAsAskedForAndKnowsTheLast) {
  PutMany(120, 1);
  for (const int size : {1, 7, 49, 50, 51, 60, 119, 120, 121, 1000}) {
    for (const bool newest_first : {false, true}) {
      const auto sizes = PageSizes({.kind = "texts", .newest_first = newest_first}, size);
      EXPECT_EQ(sizes.size(), static_cast<std::size_t>((120 + size - 1) / size)) << size;
      EXPECT_EQ(seen_.size(), 120u);
      if (newest_first) std::reverse(seen_.begin(), seen_.end());
      EXPECT_TRUE(std::is_sorted(seen_.begin(), seen_.end()));
    }
  }
}

TEST_F(RecordPageTest, EndsBeforeItIsTooLarge) {
  PutMany(100, 90'000);
  const auto sizes = PageSizes({.kind = "texts", .newest_first = true}, 1000);
  EXPECT_EQ(sizes, (std::vector<std::size_t>{22, 22, 22, 22, 12}));
  EXPECT_EQ(seen_.size(), 100u);
}

TEST_F(RecordPageTest, GivesALargeEntryByItself) {
  PutMany(3, 3'000'000);
  EXPECT_EQ(PageSizes({.kind = "texts"}, 0 + kDefaultPageSize),
            (std::vector<std::size_t>{1, 1, 1}));
}

TEST_F(RecordPageTest, IsOfThePrefixAsked) {
  Put("a/1", "a1");
  Put("b/1", "b1");
  Put("b/2", "b2");
  PageSizes({.kind = "texts", .key_prefix = "b/"}, 1);
  EXPECT_EQ(seen_, (std::vector<std::string>{"b1", "b2"}));
}

TEST_F(RecordPageTest, NamesARecordThatIsDamaged) {
  Put("good", "good");
  Put("bad", "damaged");
  const auto page = Read({.kind = "texts"}, {});
  EXPECT_EQ(DetailOf(page.status()).reason, "STORAGE_FAILED");
  EXPECT_NE(page.status().message().find("texts/bad"), absl::string_view::npos) << page.status();
}

}  // namespace
}  // namespace mortise::resources
