// Pages of List methods: every record once, in order, in messages that clients take.
#include "services/catalog/records/record_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "services/catalog/records/assembly_records.h"
#include "tests/support/temporary_folder.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kClientTakes = 4 << 20;  // bytes

class RecordPageTest : public ::testing::Test {
 protected:
  template <typename Payload>
  void Put(const char* kind, const std::string& key, const Payload& payload) {
    const absl::Status stored = store_->Transact([&](store::Transaction& transaction) {
      return transaction.Put(kind, key, payload.SerializeAsString()).status();
    });
    ASSERT_TRUE(stored.ok()) << stored;
  }

  void PutMaterials(int count, std::size_t title) {
    for (int i = 0; i < count; ++i) {
      v1::Material material;
      const std::string key = absl::StrFormat("m%04d", i);
      material.set_name(absl::StrCat("materials/", key));
      material.set_title(std::string(title, 'x'));
      Put(kMaterials, key, material);
    }
  }

  template <typename Message>
  using List = std::function<absl::StatusOr<Page<Message>>(store::ReadTransaction&,
                                                           const std::string& token)>;

  // All pages; each must fit into a message.
  template <typename Message>
  std::vector<std::vector<std::string>> PagesOf(const List<Message>& list) {
    std::vector<std::vector<std::string>> pages;
    std::string token;
    do {
      absl::StatusOr<Page<Message>> page = absl::UnknownError("not read");
      const absl::Status read = store_->Read([&](store::ReadTransaction& transaction) {
        page = list(transaction, token);
        return page.status();
      });
      EXPECT_TRUE(read.ok()) << read;
      if (!read.ok()) return pages;
      std::size_t bytes = 0;
      pages.emplace_back();
      for (const Message& entry : page->entries) {
        pages.back().push_back(entry.name());
        bytes += entry.ByteSizeLong();
      }
      EXPECT_LT(bytes, kClientTakes / 2);
      token = page->next_page_token;
    } while (!token.empty());
    return pages;
  }

  std::vector<std::vector<std::string>> MaterialPages(int page_size) {
    return PagesOf<v1::Material>(
        [page_size](store::ReadTransaction& transaction, const std::string& token) {
          v1::ListMaterialsRequest request;
          request.set_page_size(page_size);
          request.set_page_token(token);
          return ListMaterials(transaction, request);
        });
  }

  testing::TemporaryFolder folder_;
  std::unique_ptr<store::Store> store_ =
      store::OpenStore({.url = absl::StrCat("sqlite:", (folder_.path() / "store.db").string())})
          .value();
};

void ExpectEachOnce(const std::vector<std::vector<std::string>>& pages, std::size_t count) {
  std::vector<std::string> names;
  for (const auto& page : pages) names.insert(names.end(), page.begin(), page.end());
  EXPECT_EQ(names.size(), count);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end()) << "none twice";
}

TEST_F(RecordPageTest, HasAsManyEntriesAsAskedFor) {
  PutMaterials(120, 1);
  for (const int size : {1, 7, 40, 50, 60, 119, 120, 121, 1000}) {
    const auto pages = MaterialPages(size);
    ExpectEachOnce(pages, 120);
    EXPECT_EQ(pages.size(), static_cast<std::size_t>((120 + size - 1) / size)) << size;
    for (std::size_t i = 0; i + 1 < pages.size(); ++i) {
      EXPECT_EQ(pages[i].size(), static_cast<std::size_t>(size));
    }
  }
  EXPECT_EQ(MaterialPages(0).front().size(), 100u);
}

TEST_F(RecordPageTest, EndsBeforeItIsTooLarge) {
  PutMaterials(100, 90'000);
  const auto pages = MaterialPages(1000);
  ExpectEachOnce(pages, 100);
  EXPECT_EQ(pages.size(), 5u);
}

TEST_F(RecordPageTest, GivesALargeEntryByItself) {
  PutMaterials(3, 1'500'000);
  const auto pages = MaterialPages(0);
  ExpectEachOnce(pages, 3);
  EXPECT_EQ(pages.size(), 3u);
}

TEST_F(RecordPageTest, CountsWhatIsShownAndNoMore) {
  for (int i = 0; i < 60; ++i) {
    v1::AssemblyBundle bundle;
    const std::string key = absl::StrFormat("a%02d", i);
    bundle.mutable_assembly()->set_name(absl::StrCat("assemblies/", key));
    bundle.mutable_assembly()->add_parts()->set_title(std::string(100'000, 'x'));
    Put(kAssemblies, key, bundle);
  }
  const auto pages =
      PagesOf<v1::Assembly>([](store::ReadTransaction& transaction, const std::string& token) {
        v1::ListAssembliesRequest request;
        request.set_page_token(token);
        return ListAssemblies(transaction, request);
      });
  ExpectEachOnce(pages, 60);
  EXPECT_EQ(pages.size(), 1u) << "parts are not shown";
}

}  // namespace
}  // namespace mortise::catalog
