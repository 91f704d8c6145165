#include "common/resources/resource_tags.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "mortise/v1/item.pb.h"

namespace mortise::resources {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<std::string> FieldsOf(const std::vector<FieldViolation>& violations) {
  std::vector<std::string> fields;
  for (const FieldViolation& violation : violations) fields.push_back(violation.field);
  return fields;
}

TEST(ResourceTagsTest, TakesNumbersOfOtherSystems) {
  v1::Item item;
  for (const char* id : {"100-4711/A", "SAP:0000123", "Zeichnung 7 (neu)", "部品-1"}) {
    item.add_external_ids(id);
  }
  (*item.mutable_labels())["line"] = "A";
  (*item.mutable_labels())["example.com/cost-centre"] = "";
  (*item.mutable_labels())["7"] = "Größe L";
  EXPECT_THAT(CheckTags(item), IsEmpty());
  EXPECT_TRUE(ValidateTags(item).ok());
}

TEST(ResourceTagsTest, NamesEachExternalIdThatIsWrong) {
  v1::Item item;
  item.add_external_ids("a");
  item.add_external_ids("");
  item.add_external_ids("a");
  item.add_external_ids("tab\tin it");
  item.add_external_ids(std::string(kMaxExternalIdBytes + 1, 'x'));
  EXPECT_THAT(FieldsOf(CheckTags(item)), ElementsAre("external_ids[1]", "external_ids[2]",
                                                     "external_ids[3]", "external_ids[4]"));
}

TEST(ResourceTagsTest, NamesEachLabelThatIsWrong) {
  v1::Item item;
  auto& labels = *item.mutable_labels();
  labels[""] = "x";
  labels["-a"] = "x";
  labels["b c"] = "x";
  labels["c"] = std::string(kMaxLabelValueBytes + 1, 'x');
  labels["d"] = "line\nbreak";
  labels["good"] = "x";
  const std::vector<FieldViolation> violations = CheckTags(item);
  ASSERT_EQ(violations.size(), 5u);
  EXPECT_THAT(violations[1].message, HasSubstr("'-a'"));
  EXPECT_THAT(violations[3].message, HasSubstr("'c'"));
  EXPECT_THAT(violations[4].message, HasSubstr("'d'"));
}

TEST(ResourceTagsTest, LimitsHowManyThereAre) {
  v1::Item item;
  for (int i = 0; i <= kMaxExternalIds; ++i) item.add_external_ids(std::to_string(i));
  for (int i = 0; i <= kMaxLabels; ++i) (*item.mutable_labels())[std::to_string(i)] = "x";
  EXPECT_THAT(FieldsOf(CheckTags(item)), ElementsAre("external_ids", "labels"));
}

TEST(ResourceTagsTest, ComparesTagsWhateverTheOrderOfLabels) {
  v1::Item one;
  v1::Item other;
  for (int i = 0; i < 20; ++i) {
    (*one.mutable_labels())[std::to_string(i)] = "x";
    (*other.mutable_labels())[std::to_string(19 - i)] = "x";
  }
  EXPECT_TRUE(HaveSameTags(one, other));
  other.add_external_ids("a");
  EXPECT_FALSE(HaveSameTags(one, other));
  one.add_external_ids("a");
  (*one.mutable_labels())["3"] = "y";
  EXPECT_FALSE(HaveSameTags(one, other));
}

TEST(ResourceTagsTest, ChangesWhatTheMaskNames) {
  v1::Item changes;
  changes.add_external_ids("new");
  (*changes.mutable_labels())["new"] = "1";
  v1::Item present;
  present.set_title("Board");
  present.add_external_ids("old");
  (*present.mutable_labels())["old"] = "1";

  google::protobuf::FieldMask mask;
  mask.add_paths("labels");
  ASSERT_TRUE(CheckTagMask(mask).ok());
  v1::Item labelled = present;
  UpdateTags(changes, mask, &labelled);
  EXPECT_THAT(labelled.external_ids(), ElementsAre("old"));
  EXPECT_EQ(labelled.labels().size(), 1u);
  EXPECT_TRUE(labelled.labels().contains("new"));

  UpdateTags(changes, google::protobuf::FieldMask(), &present);
  EXPECT_TRUE(HaveSameTags(present, changes));
  EXPECT_EQ(present.title(), "Board");
}

TEST(ResourceTagsTest, RefusesMasksOfOtherFields) {
  google::protobuf::FieldMask mask;
  mask.add_paths("labels");
  mask.add_paths("name");
  EXPECT_THAT(std::string(CheckTagMask(mask).message()), HasSubstr("'name' cannot be changed"));
}

}  // namespace
}  // namespace mortise::resources
