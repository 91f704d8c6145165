// What searches came to is what makes a design the same again, at once.
#include "common/assembly/trial/search_outcome.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/assembly/parametric_assembly.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/expect_same.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

// A board with a row of tiles.
Assembly TiledBoard() {
  Assembly board;
  board.name = "board";
  board.groups = {{"board", -1}};
  board.parts = {ResizablePart("board", {0, 0, 0}, {0.5, 0.3, 0.02})};
  for (int i = 0; i < 4; ++i) {
    board.parts.push_back(ResizablePart("tile " + std::to_string(i + 1),
                                        {0.05 + 0.13 * i, 0.05, 0.02},
                                        {0.1 + 0.13 * i, 0.1, 0.03}));
  }
  return board;
}

TEST(SearchOutcome, MakesTheSameDesignAgain) {
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly searched, ParametricAssembly::Create(TiledBoard()));
  SearchOptions known;
  known.outcome = &searched.search_outcome();
  std::vector<std::string> stages;
  known.progress = [&](const char* stage, std::int64_t, std::int64_t) { stages.push_back(stage); };
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly again,
                       ParametricAssembly::Create(
                           TiledBoard(), [] { return false; }, {}, LoosePolicy::kRefuse, known));
  ExpectSame(searched, again);
  EXPECT_EQ(stages, std::vector<std::string>()) << "nothing is searched";
  EXPECT_EQ(again.search_outcome().touching, searched.search_outcome().touching);
}

TEST(SearchOutcome, OfAnotherAssemblyIsNotTaken) {
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly searched, ParametricAssembly::Create(TiledBoard()));
  SearchOutcome damaged = searched.search_outcome();
  damaged.touching.emplace(2, 77);
  EXPECT_TRUE(NamesPartsOf(searched.search_outcome(), 5));
  EXPECT_FALSE(NamesPartsOf(searched.search_outcome(), 2));
  EXPECT_FALSE(NamesPartsOf(damaged, 5));
  SearchOptions known;
  known.outcome = &damaged;
  ASSERT_OK_AND_ASSIGN(const ParametricAssembly anew,
                       ParametricAssembly::Create(
                           TiledBoard(), [] { return false; }, {}, LoosePolicy::kRefuse, known));
  ExpectSame(searched, anew);
}

TEST(SearchOutcome, ProgressCountsParts) {
  SearchOptions watched;
  std::int64_t parts = 0;
  watched.progress = [&](const char* stage, std::int64_t done, std::int64_t total) {
    EXPECT_LE(done, total);
    if (std::string(stage) == "looking for contacts") parts = done;
  };
  ASSERT_OK(ParametricAssembly::Create(
                TiledBoard(), [] { return false; }, {}, LoosePolicy::kRefuse, watched)
                .status());
  EXPECT_EQ(parts, 5);
}

}  // namespace
}  // namespace mortise::parametric
