#include "common/mesh/distinct_names.h"

#include <gtest/gtest.h>

#include <set>

namespace mortise::mesh {
namespace {

TEST(DistinctNamesTest, LeavesWhatIsDistinct) {
  const std::vector<std::string> names = {"a", "b", "c"};
  EXPECT_EQ(DistinctNames(names, {{1, 2}, {0}, {0}}), names);
}

TEST(DistinctNamesTest, AddsWhatLiesBesideWhereNamesAreTheSame) {
  // A fillet along two edges of a top, on either side a wall.
  const std::vector<std::string> told =
      DistinctNames({"top", "left", "right", "round", "round"}, {{3, 4}, {3}, {4}, {0, 1}, {0, 2}});
  EXPECT_EQ(told, (std::vector<std::string>{"top", "left", "right", "round beside (left, top)",
                                            "round beside (right, top)"}));
}

TEST(DistinctNamesTest, GoesOnFromThoseThatItTold) {
  // A chain of five of one name, of which the first two ends are known.
  const std::vector<std::string> told =
      DistinctNames({"start", "x", "x", "x", "x", "x"}, {{1}, {0, 2}, {1, 3}, {2, 4}, {3, 5}, {4}});
  EXPECT_EQ(std::set<std::string>(told.begin(), told.end()).size(), told.size());
}

TEST(DistinctNamesTest, LeavesWhatLiesBesideTheSame) {
  const std::vector<std::string> names = {"a", "x", "x", "y", "y"};
  EXPECT_EQ(DistinctNames(names, {{1, 2}, {0}, {0}, {4}, {3}}), names);
}

TEST(DistinctNamesTest, KeepsNamesShort) {
  std::vector<std::string> names = {"x", "x"};
  std::vector<std::vector<int>> beside = {{}, {}};
  for (int i = 0; i < 100; ++i) {
    beside[static_cast<std::size_t>(i % 2)].push_back(static_cast<int>(names.size()));
    names.push_back("a rather long name of a face " + std::to_string(i));
    beside.push_back({i % 2});
  }
  const std::vector<std::string> told = DistinctNames(names, beside);
  EXPECT_NE(told[0], told[1]);
  EXPECT_LT(told[0].size(), 100U);
}

}  // namespace
}  // namespace mortise::mesh
