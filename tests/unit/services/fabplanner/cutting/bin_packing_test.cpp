// Bin packing against published instances with known optima, and against exhaustive search.
#include "services/fabplanner/cutting/bin_packing.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tests/unit/services/fabplanner/cutting/cutting_data.h"

namespace mortise::fabplanner {
namespace {

// Every item once, no bin overfull, the cost as stated and not below the bound.
void ExpectValid(const std::vector<int64_t>& sizes, const std::vector<BinType>& types,
                 const Packing& packing) {
  std::vector<int> seen(sizes.size(), 0);
  int64_t cost = 0;
  for (const PackedBin& bin : packing.bins) {
    ASSERT_FALSE(bin.items.empty());
    int64_t filled = 0;
    for (int item : bin.items) {
      ++seen[item];
      filled += sizes[item];
    }
    EXPECT_LE(filled, types[bin.type].capacity);
    cost += types[bin.type].cost;
  }
  EXPECT_THAT(seen, testing::Each(1));
  EXPECT_EQ(cost, packing.cost);
  EXPECT_LE(packing.lower_bound, packing.cost);
  EXPECT_TRUE(!packing.optimal || packing.lower_bound == packing.cost);
}

struct PublishedInstance {
  std::string name;
  int64_t capacity = 0;
  int64_t proven_bound = 0;
  int64_t best_known = 0;
  int64_t first_fit = 0;
  std::vector<int64_t> sizes;
};

// Reads tests/data/cutting/bin_packing.txt, which says what is in it.
std::vector<PublishedInstance> ReadPublished() {
  std::ifstream file(DataFile("bin_packing.txt"));
  std::stringstream numbers;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with('#')) numbers << line << '\n';
  }
  std::vector<PublishedInstance> instances;
  PublishedInstance next;
  for (int kinds = 0; numbers >> next.name >> next.capacity >> next.proven_bound >>
                      next.best_known >> next.first_fit >> kinds;) {
    next.sizes.clear();
    char times = 0;
    for (int64_t size = 0, demand = 0; kinds > 0 && numbers >> size >> times >> demand; --kinds) {
      next.sizes.insert(next.sizes.end(), demand, size);
    }
    instances.push_back(next);
  }
  return instances;
}

TEST(BinPackingTest, SolvesPublishedInstances) {
  int at_best_known = 0;
  int instances = 0;
  for (const PublishedInstance& published : ReadPublished()) {
    SCOPED_TRACE(published.name);
    const std::vector<int64_t>& sizes = published.sizes;
    ASSERT_FALSE(sizes.empty());
    const std::vector<BinType> types = {{published.capacity, 1}};
    const Packing packing = PackBins(sizes, types, 3000000);
    ExpectValid(sizes, types, packing);
    EXPECT_LE(packing.lower_bound, published.best_known);
    EXPECT_GE(packing.cost, published.proven_bound);
    EXPECT_LE(packing.cost, published.first_fit);
    EXPECT_LE(packing.cost, published.best_known + 1);
    EXPECT_TRUE(!packing.optimal || packing.cost == published.best_known);
    ++instances;
    at_best_known += packing.cost == published.best_known ? 1 : 0;
    std::cout << published.name << ": " << packing.cost << " bins, bound " << packing.lower_bound
              << ", best known " << published.best_known << ", first fit " << published.first_fit
              << "\n";
  }
  EXPECT_EQ(instances, 10);
  EXPECT_GE(at_best_known, 5);
}

// The least number of bins by trying every partition.
int Exhaustive(const std::vector<int64_t>& sizes, int64_t capacity) {
  int best = static_cast<int>(sizes.size());
  std::vector<int64_t> bins;
  const std::function<void(std::size_t)> place = [&](std::size_t item) {
    if (static_cast<int>(bins.size()) >= best) return;
    if (item == sizes.size()) {
      best = static_cast<int>(bins.size());
      return;
    }
    for (std::size_t b = 0; b < bins.size(); ++b) {
      if (bins[b] + sizes[item] > capacity) continue;
      bins[b] += sizes[item];
      place(item + 1);
      bins[b] -= sizes[item];
    }
    bins.push_back(sizes[item]);
    place(item + 1);
    bins.pop_back();
  };
  place(0);
  return best;
}

TEST(BinPackingTest, AgreesWithExhaustiveSearch) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 300; ++trial) {
    const int64_t capacity = 20 + random() % 100;
    std::vector<int64_t> sizes(1 + random() % 10);
    for (int64_t& size : sizes) size = 1 + random() % capacity;
    const Packing packing = PackBins(sizes, {{capacity, 1}}, 1000000);
    ExpectValid(sizes, {{capacity, 1}}, packing);
    ASSERT_TRUE(packing.optimal);
    ASSERT_EQ(packing.cost, Exhaustive(sizes, capacity)) << "trial " << trial;
  }
}

TEST(BinPackingTest, MixesBinTypesForLeastCost) {
  // Two of 60 and one of 30: 120 + 30 (cost 15) beats 100 + 100 (cost 20).
  const std::vector<BinType> types = {{100, 10}, {120, 12}, {30, 3}};
  const Packing packing = PackBins({60, 60, 30}, types, 100000);
  ExpectValid({60, 60, 30}, types, packing);
  EXPECT_TRUE(packing.optimal);
  EXPECT_EQ(packing.cost, 15);
}

TEST(BinPackingTest, BoundIsNeverAboveTheOptimum) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 300; ++trial) {
    const int64_t capacity = 20 + random() % 50;
    std::vector<int64_t> sizes(1 + random() % 9);
    for (int64_t& size : sizes) size = 1 + random() % capacity;
    std::sort(sizes.rbegin(), sizes.rend());
    const std::vector<int> counts(sizes.size(), 1);
    EXPECT_LE(PackingBound(sizes, counts, capacity), Exhaustive(sizes, capacity));
  }
  // 60s leave 40 each, too little for a 41, and two 41s share a bin.
  EXPECT_EQ(PackingBound({60, 41}, {2, 2}, 100), 3);
}

TEST(BinPackingTest, ManyCopiesStayQuickAndTheSameTwice) {
  std::vector<int64_t> sizes;
  for (int copy = 0; copy < 1000; ++copy) {
    for (int64_t size : {713, 713, 713, 713, 911, 911, 511, 511}) sizes.push_back(size);
  }
  const Packing packing = PackBins(sizes, {{2983, 1}}, 3000000);
  ExpectValid(sizes, {{2983, 1}}, packing);
  EXPECT_LE(packing.cost, packing.lower_bound * 1.05);
  const Packing again = PackBins(sizes, {{2983, 1}}, 3000000);
  ASSERT_EQ(again.bins.size(), packing.bins.size());
  for (std::size_t b = 0; b < packing.bins.size(); ++b) {
    ASSERT_EQ(again.bins[b].items, packing.bins[b].items);
  }
}

TEST(BinPackingTest, NothingNeedsNoBin) {
  const Packing packing = PackBins({}, {{10, 1}}, 1000);
  EXPECT_TRUE(packing.bins.empty());
  EXPECT_TRUE(packing.optimal);
}

}  // namespace
}  // namespace mortise::fabplanner
