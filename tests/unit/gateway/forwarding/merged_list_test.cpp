// Lists of several services as one: nothing lost, nothing twice, whatever the page size.
#include "gateway/forwarding/merged_list.h"

#include <gtest/gtest.h>

#include <random>

namespace mortise::gateway {
namespace {

struct Item {
  std::string source;
  int time = 0;
  int number = 0;         // in its source, for items of the same time
  std::size_t bytes = 1;  // that it takes on a page
  bool operator==(const Item& other) const {
    return source == other.source && number == other.number;
  }
};

using Lists = std::map<std::string, std::vector<Item>>;

// Pages of at most `largest` items, tokens are offsets.
auto Fetcher(const Lists& lists, int largest) {
  return [&lists, largest](const std::string& source, int page_size,
                           const std::string& token) -> absl::StatusOr<ListPage<Item>> {
    const auto& all = lists.at(source);
    const std::size_t begin = token.empty() ? 0 : std::stoul(token);
    const std::size_t end =
        std::min(all.size(), begin + static_cast<std::size_t>(std::min(page_size, largest)));
    ListPage<Item> page;
    page.items.assign(all.begin() + static_cast<std::ptrdiff_t>(begin),
                      all.begin() + static_cast<std::ptrdiff_t>(end));
    if (end < all.size()) page.next_page_token = std::to_string(end);
    return page;
  };
}

bool Newer(const Item& a, const Item& b) { return a.time > b.time; }

std::string Identify(const Item& item) { return std::to_string(item.number); }

std::size_t SizeOf(const Item& item) { return item.bytes; }

// Pages as services make them: a token names the item before the page, and new items stand in
// front.
auto NewestFirst(const Lists& lists) {
  return [&lists](const std::string& source, int page_size,
                  const std::string& token) -> absl::StatusOr<ListPage<Item>> {
    ListPage<Item> page;
    for (const Item& item : lists.at(source)) {
      if (!token.empty() && item.number >= std::stoi(token)) continue;
      if (page.items.size() == static_cast<std::size_t>(page_size)) {
        page.next_page_token = Identify(page.items.back());
        break;
      }
      page.items.push_back(item);
    }
    return page;
  };
}

TEST(MergedList, GivesEveryItemOnceInOrder) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    Lists lists;
    std::vector<std::string> sources;
    std::size_t total = 0;
    for (int s = 0; s < 1 + round % 4; ++s) {
      const std::string name = "s" + std::to_string(s);
      sources.push_back(name);
      auto& list = lists[name];
      for (int i = 0; i < static_cast<int>(random() % 30); ++i) {
        list.push_back({name, static_cast<int>(random() % 50), i});
      }
      std::stable_sort(list.begin(), list.end(), Newer);
      total += list.size();
    }
    const int page_size = 1 + static_cast<int>(random() % 7);
    const int largest = 1 + static_cast<int>(random() % 12);
    std::vector<Item> seen;
    std::string token;
    int pages = 0;
    do {
      const auto page = MergeLists<Item>(sources, page_size, token, Fetcher(lists, largest), Newer,
                                         Identify, SizeOf);
      ASSERT_TRUE(page.ok()) << page.status();
      ASSERT_LE(page->items.size(), static_cast<std::size_t>(page_size));
      seen.insert(seen.end(), page->items.begin(), page->items.end());
      token = page->next_page_token;
      ASSERT_LT(++pages, 500) << "the list does not end";
    } while (!token.empty());
    ASSERT_EQ(seen.size(), total);
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end(), Newer));
    for (const auto& [name, list] : lists) {
      std::vector<Item> own;
      std::copy_if(seen.begin(), seen.end(), std::back_inserter(own),
                   [&](const Item& item) { return item.source == name; });
      EXPECT_EQ(own, list);
    }
  }
}

TEST(MergedList, GivesTheLargestPagesAndAsksSourcesForNoLarger) {
  Lists lists;
  for (int i = 0; i < 2500; ++i) {
    lists["a"].push_back({"a", -2 * i, i});
    lists["b"].push_back({"b", -2 * i - 1, i});
  }
  const auto whole = Fetcher(lists, 5000);
  const auto fetch = [&](const std::string& source, int page_size, const std::string& token) {
    EXPECT_LE(page_size, resources::kMaxPageSize);
    return whole(source, page_size, token);
  };
  std::vector<Item> seen;
  std::string token;
  do {
    const auto page = MergeLists<Item>({"a", "b"}, resources::kMaxPageSize, token, fetch, Newer,
                                       Identify, SizeOf);
    ASSERT_TRUE(page.ok()) << page.status();
    seen.insert(seen.end(), page->items.begin(), page->items.end());
    token = page->next_page_token;
    ASSERT_LE(seen.size(), 5000U);
  } while (!token.empty());
  EXPECT_EQ(seen.size(), 5000U);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end(), Newer));
}

TEST(MergedList, RepeatsNothingWhenItemsArriveMeanwhile) {
  std::mt19937 random(11);
  for (int round = 0; round < 200; ++round) {
    Lists lists = {{"a", {}}, {"b", {}}};
    int time = 0;
    const auto arrive = [&] {
      const std::string source = random() % 2 == 0 ? "a" : "b";
      auto& list = lists[source];
      list.insert(list.begin(), Item{source, ++time, static_cast<int>(list.size()) + 1});
    };
    const int before = 1 + static_cast<int>(random() % 30);
    for (int i = 0; i < before; ++i) arrive();
    const Lists at_first = lists;
    const int page_size = 1 + static_cast<int>(random() % 7);
    std::vector<Item> seen;
    std::string token;
    int pages = 0;
    do {
      const auto page = MergeLists<Item>({"a", "b"}, page_size, token, NewestFirst(lists), Newer,
                                         Identify, SizeOf);
      ASSERT_TRUE(page.ok()) << page.status();
      seen.insert(seen.end(), page->items.begin(), page->items.end());
      token = page->next_page_token;
      // Fewer, as many and more than a page holds; in the end the list must come to its end.
      for (unsigned i = random() % 10; i > 0 && pages < 20; --i) arrive();
      ASSERT_LT(++pages, 500) << "the list does not end";
    } while (!token.empty());
    for (const auto& [name, list] : at_first) {
      for (const Item& item : list) {
        EXPECT_EQ(std::count(seen.begin(), seen.end(), item), 1) << name << " " << item.number;
      }
    }
    for (const Item& item : seen) EXPECT_EQ(std::count(seen.begin(), seen.end(), item), 1);
  }
}

// Each source keeps below the limit by itself; all of them together must, too.
TEST(MergedList, EndsBeforeItIsTooLarge) {
  constexpr std::size_t kClientTakes = 4 << 20;  // bytes
  std::mt19937 random(5);
  Lists lists;
  for (int i = 0; i < 300; ++i) {
    const std::string source = i % 3 == 0 ? "a" : i % 3 == 1 ? "b" : "c";
    lists[source].push_back({source, 300 - i, i, 1000 + random() % 300000});
  }
  lists["a"][20].bytes = 3'900'000;  // fits alone
  std::vector<Item> seen;
  std::string token;
  int pages = 0;
  do {
    const auto page =
        MergeLists<Item>({"a", "b", "c"}, 0, token, Fetcher(lists, 40), Newer, Identify, SizeOf);
    ASSERT_TRUE(page.ok()) << page.status();
    std::size_t bytes = 0;
    for (const Item& item : page->items) bytes += item.bytes;
    EXPECT_LT(bytes, kClientTakes);
    seen.insert(seen.end(), page->items.begin(), page->items.end());
    token = page->next_page_token;
    ASSERT_LT(++pages, 500) << "the list does not end";
  } while (!token.empty());
  EXPECT_EQ(seen.size(), 300u);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end(), Newer));
}

TEST(MergedList, RefusesForeignTokensAndSizes) {
  const Lists lists = {{"a", {}}};
  const auto fetch = Fetcher(lists, 10);
  for (const char* token : {"x", "!!", "e30x", "W10"}) {
    EXPECT_FALSE(MergeLists<Item>({"a"}, 10, token, fetch, Newer, Identify, SizeOf).ok()) << token;
  }
  EXPECT_FALSE(MergeLists<Item>({"a"}, 10, FormatMergeToken({{"b", {"", 0, ""}}}), fetch, Newer,
                                Identify, SizeOf)
                   .ok());
  EXPECT_FALSE(MergeLists<Item>({"a"}, 10, FormatMergeToken({{"a", {"", -1, ""}}}), fetch, Newer,
                                Identify, SizeOf)
                   .ok());
  EXPECT_FALSE(MergeLists<Item>({"a"}, -1, "", fetch, Newer, Identify, SizeOf).ok());
  EXPECT_FALSE(MergeLists<Item>({"a"}, 1001, "", fetch, Newer, Identify, SizeOf).ok());
}

TEST(MergedList, FailsWhenASourceDoes) {
  const auto fetch = [](const std::string&, int, const std::string&) {
    return absl::StatusOr<ListPage<Item>>(absl::UnavailableError("away"));
  };
  EXPECT_EQ(MergeLists<Item>({"a"}, 10, "", fetch, Newer, Identify, SizeOf).status().code(),
            absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace mortise::gateway
