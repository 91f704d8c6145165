// Tables and flags of what there is to build from.
#include "cli/files/available_items.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "tests/support/status_assertions.h"

namespace mortise::cli {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<std::string> FieldsOf(const absl::Status& status) {
  std::vector<std::string> fields;
  for (const FieldViolation& each : AllViolationsOf(status)) fields.push_back(each.field);
  return fields;
}

TEST(AvailableItems, AreReadFromATable) {
  ASSERT_OK_AND_ASSIGN(const auto items, ParseAvailableItems("item,where,quantity\n"
                                                             "board,shed,4\n"
                                                             "items/screw,\"box, red\",\n"
                                                             "sheet,shed,0.5\n",
                                                             "stock.csv"));
  ASSERT_EQ(items.size(), 3u);
  EXPECT_EQ(items[0].item(), "items/board");
  EXPECT_EQ(items[0].quantity(), 4);
  EXPECT_EQ(items[1].item(), "items/screw");
  EXPECT_FALSE(items[1].has_quantity()) << "as many as it takes";
  EXPECT_EQ(items[2].quantity(), 0.5);
}

TEST(AvailableItems, MayBeATableOfItemsWithoutQuantities) {
  ASSERT_OK_AND_ASSIGN(const auto items,
                       ParseAvailableItems("name,title\nboard,A board\n", "items.csv"));
  ASSERT_EQ(items.size(), 1u);
  EXPECT_EQ(items[0].item(), "items/board");
  EXPECT_FALSE(items[0].has_quantity());
}

TEST(AvailableItems, HaveQuantitiesHoweverTheHeadingIsWritten) {
  ASSERT_OK_AND_ASSIGN(const auto items,
                       ParseAvailableItems("Item , Quantity \n board , 4 \n", "s.csv"));
  ASSERT_EQ(items.size(), 1u);
  EXPECT_EQ(items[0].item(), "items/board");
  EXPECT_EQ(items[0].quantity(), 4);
}

TEST(AvailableItems, AreNotWithoutLimitUnderAHeadingThatIsNotKnown) {
  for (const char* const heading : {"qty", "pieces", "Menge"}) {
    const absl::Status refused =
        ParseAvailableItems(std::string("item,") + heading + "\nboard,0\n", "s.csv").status();
    EXPECT_THAT(FieldsOf(refused), ElementsAre("s.csv: line 1, column 2")) << heading;
    EXPECT_THAT(refused.message(), HasSubstr(heading));
    EXPECT_THAT(refused.message(), HasSubstr("'quantity'"));
  }
  EXPECT_TRUE(ParseAvailableItems("name,kind,price\nboard,LUMBER,3\n", "items.csv").ok());
}

TEST(AvailableItems, TellOfAnotherSeparator) {
  const absl::Status refused = ParseAvailableItems("item;quantity\nboard;4\n", "s.csv").status();
  EXPECT_THAT(refused.message(), HasSubstr("semicolons"));
}

TEST(AvailableItems, AreAddedUpWhereTheyStandInSeveralLines) {
  std::vector<std::string> places;
  ASSERT_OK_AND_ASSIGN(
      auto items,
      ParseAvailableItems("item,quantity\nboard,4\nscrew,\nboard,2\nscrew,8\n", "s.csv", &places));
  ASSERT_EQ(items.size(), 2u);
  EXPECT_EQ(items[0].quantity(), 6);
  EXPECT_FALSE(items[1].has_quantity()) << "as many as it takes";
  EXPECT_THAT(places, ElementsAre("s.csv: line 2, column 1", "s.csv: line 3, column 1"));
  std::vector<std::string> more_places;
  ASSERT_OK_AND_ASSIGN(
      auto more, ParseAvailableItems("item,quantity\nnut,9\nboard,1\n", "b.csv", &more_places));
  AddAvailable(std::move(more), more_places, &items, &places);
  ASSERT_EQ(items.size(), 3u);
  EXPECT_EQ(items[0].quantity(), 7);
  EXPECT_EQ(places[2], "b.csv: line 2, column 1");
}

TEST(AvailableItems, MayBeTheBillOfAPlan) {
  ASSERT_OK_AND_ASSIGN(const auto items,
                       ParseAvailableItems("item,title,quantity,size_to_order,price,currency\n"
                                           "items/board,Board,2,2.4 m,8.00,EUR\n"
                                           "items/board,Board,1,3 m,5.00,EUR\n"
                                           "total,,,,13.00,EUR\n",
                                           "bill-of-materials.csv"));
  ASSERT_EQ(items.size(), 1u);
  EXPECT_EQ(items[0].item(), "items/board");
  EXPECT_EQ(items[0].quantity(), 3);
}

TEST(AvailableItems, SayWhereATableIsWrong) {
  EXPECT_THAT(
      FieldsOf(
          ParseAvailableItems("item,quantity\nboard,four\nscrew,8\nnut,-1\n", "s.csv").status()),
      ElementsAre("s.csv: line 2, column 2", "s.csv: line 4, column 2"));
  EXPECT_THAT(FieldsOf(ParseAvailableItems("thing,quantity\nboard,4\n", "s.csv").status()),
              ElementsAre("s.csv: line 1"));
  EXPECT_THAT(FieldsOf(ParseAvailableItems("", "s.csv").status()), ElementsAre("s.csv: line 1"));
  EXPECT_TRUE(ReadAvailableItems("/no/such/table.csv").status().code() != absl::StatusCode::kOk);
}

TEST(AvailableItems, AreReadFromFlags) {
  ASSERT_OK_AND_ASSIGN(const v1::AvailableItem any, ParseAvailableItem("board"));
  EXPECT_EQ(any.item(), "items/board");
  EXPECT_FALSE(any.has_quantity());
  ASSERT_OK_AND_ASSIGN(const v1::AvailableItem four, ParseAvailableItem("items/board=4"));
  EXPECT_EQ(four.item(), "items/board");
  EXPECT_EQ(four.quantity(), 4);
  for (const char* wrong : {"board=", "board=four", "board=-1"}) {
    const absl::Status status = ParseAvailableItem(wrong).status();
    EXPECT_EQ(DetailOf(status).field, "--item board") << wrong;
  }
}

}  // namespace
}  // namespace mortise::cli
