// What stands on labels.
#include "services/fabplanner/documents/part_labels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "services/fabplanner/planning/planning.h"
#include "tests/unit/services/fabplanner/example_table.h"

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;
using ::testing::SizeIs;

std::vector<LabelContents> Labels(const Design& design, int quantity) {
  const FabricationPlan plan = MakePlan(design, ExampleItems(), quantity).value();
  return LabelsOf(plan, design, ExampleItems(), {"Table", "plans/0198c1"});
}

TEST(PartLabelsTest, EachPartOfEachCopyHasOne) {
  std::set<std::string> parts;
  for (const LabelContents& label : Labels(ExampleTable(), 2)) {
    EXPECT_TRUE(parts.insert(label.part).second) << label.part;
  }
  EXPECT_THAT(parts, SizeIs(18));
  EXPECT_TRUE(parts.contains("leg_1.2"));
}

TEST(PartLabelsTest, SaysWhereAPartComesFromAndWhereItGoes) {
  const auto labels = Labels(ExampleTable(), 1);
  ASSERT_THAT(labels, SizeIs(9));
  for (const LabelContents& label : labels) {
    if (label.part == "top") {
      EXPECT_EQ(label.step, 3);
      EXPECT_EQ(label.size, "1300 × 800 × 18 mm");
      EXPECT_EQ(label.stock, "sheet-1 at 10, 10 mm");
      EXPECT_EQ(label.item, "Birch plywood 18");
      EXPECT_EQ(label.code, "plans/0198c1/parts/top?step=3");
    }
    if (label.part == "leg_1") {
      EXPECT_EQ(label.step, 1);
      EXPECT_THAT(label.stock, HasSubstr("board-"));
      EXPECT_THAT(label.stock, HasSubstr(" mm"));
    }
  }
  // In the order in which they are cut.
  EXPECT_EQ(labels.front().stock, "board-1 at 10 mm");
  EXPECT_EQ(labels.back().part, "top");
}

TEST(PartLabelsTest, ScrewsHaveNone) { EXPECT_THAT(Labels(ExampleRack(), 1), SizeIs(4)); }

TEST(PartLabelsTest, CodesAreTheEndsOfLinks) {
  PlanNames names = {"Rack", "plans/0198c1"};
  EXPECT_EQ(CodeText(names, "side 1/ä", 4), "plans/0198c1/parts/side%201%2F%C3%A4?step=4");
  EXPECT_EQ(CodeText(names, "lid", 0), "plans/0198c1/parts/lid");
  names.address = "https://example.com/shop";
  EXPECT_EQ(CodeText(names, "lid", 0), "https://example.com/shop/plans/0198c1/parts/lid");
  names.address += "/";
  EXPECT_EQ(CodeText(names, "lid", 0), "https://example.com/shop/plans/0198c1/parts/lid");
}

TEST(PartLabelsTest, AddressesThatLeadNowhereAreRefused) {
  for (const char* good : {"", "https://example.com", "http://10.0.0.2:8080/shop/"}) {
    EXPECT_TRUE(CheckLabelAddress(good, "label_address").ok()) << good;
  }
  const std::vector<std::pair<std::string, std::string>> bad = {
      {"example.com/shop", "https://"},
      {"javascript:alert(1)", "https://"},
      {"https://", "host"},
      {"https:///shop", "host"},
      {"https://example.com/a b", "%20"},
      {"https://example.com/\xc3\xa4", "%20"},
      {"https://example.com/?part=", "\"?\""},
      {"https://example.com/#", "\"#\""},
      {"https://me@example.com/", "\"@\""},
      {"https://example.com/" + std::string(500, 'x'), "500"}};
  for (const auto& [address, why] : bad) {
    const absl::Status status = CheckLabelAddress(address, "label_address");
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << address;
    EXPECT_THAT(status.message(), HasSubstr("label_address")) << address;
    EXPECT_THAT(status.message(), HasSubstr(why)) << address;
  }
}

}  // namespace
}  // namespace mortise::fabplanner
