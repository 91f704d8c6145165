#include "common/base/names/offered_names.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

namespace mortise {
namespace {

TEST(OfferedNamesTest, OffersTheNameThatIsNearest) {
  EXPECT_EQ(NamesOffered("tabel", {"chair", "table", "stable"}), "; did you mean 'table'?");
  EXPECT_EQ(NamesOffered("TOP", {"leg", "top"}), "; did you mean 'top'?");
  EXPECT_EQ(NamesOffered("board-27x59", {"board-27x95", "board-38x89"}),
            "; did you mean 'board-27x95'?");
}

TEST(OfferedNamesTest, TellsWhatThereIsWhereNothingIsLike) {
  EXPECT_EQ(NamesOffered("nix", {"apron", "leg_section"}), "; there are 'apron', 'leg_section'");
  EXPECT_EQ(NamesOffered("nix", {}), "");
  const std::vector<std::string> many(30, "something");
  const std::string offered = NamesOffered("nix", many);
  EXPECT_TRUE(offered.ends_with("'something' and more")) << offered;
}

TEST(OfferedNamesTest, TakesThingsThatHaveNames) {
  struct Part {
    std::string name;
  };
  const std::vector<Part> parts = {{"leg"}, {"top"}};
  EXPECT_EQ(NamesOffered("tpo", parts, &Part::name), "; did you mean 'top'?");
}

TEST(OfferedNamesTest, OffersNothingOfManyWhereNothingIsLike) {
  const std::vector<std::string> names = {"board-27x95", "board-38x89"};
  EXPECT_EQ(NearestOffered("bord-27x95", names), "; did you mean 'board-27x95'?");
  EXPECT_EQ(NearestOffered("screw", names), "");
  EXPECT_EQ(NearestName("board-38x98", names), "board-38x89");
  EXPECT_EQ(NearestName("screw", names), std::nullopt);
}

TEST(OfferedNamesTest, TakesAnyTexts) {
  EXPECT_EQ(NamesOffered("", {"a"}), "; did you mean 'a'?");
  EXPECT_EQ(NamesOffered("a", {""}), "; did you mean ''?");
  EXPECT_EQ(NamesOffered("Stühle", {"stühle"}), "; did you mean 'stühle'?");
}

}  // namespace
}  // namespace mortise
