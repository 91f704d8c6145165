#include "common/resources/resource_filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "common/base/violation_lists.h"
#include "mortise/v1/item.pb.h"

namespace mortise::resources {
namespace {

using testing::ElementsAre;

v1::Item Board() {
  v1::Item item;
  item.add_external_ids("100-4711/A");
  item.add_external_ids("B-2");
  (*item.mutable_labels())["line"] = "A";
  (*item.mutable_labels())["customer"] = "North";
  item.set_creator("users/ada");
  item.mutable_create_time()->set_seconds(1'000);
  return item;
}

bool Matches(const v1::ResourceFilter& filter, const v1::Item& item = Board()) {
  const absl::StatusOr<ResourceFilter> made = ResourceFilter::Create(filter);
  EXPECT_TRUE(made.ok()) << made.status();
  return made.ok() && made->Matches(item);
}

TEST(ResourceFilterTest, TakesEverythingWhereNothingIsAsked) {
  EXPECT_TRUE(Matches({}));
  EXPECT_TRUE(Matches({}, v1::Item()));
}

TEST(ResourceFilterTest, FindsExternalIdsLetterByLetter) {
  v1::ResourceFilter filter;
  filter.set_external_id("B-2");
  EXPECT_TRUE(Matches(filter));
  filter.set_external_id("b-2");
  EXPECT_FALSE(Matches(filter));
  filter.set_external_id("100-4711");
  EXPECT_FALSE(Matches(filter));
}

TEST(ResourceFilterTest, WantsEachLabel) {
  v1::ResourceFilter filter;
  (*filter.mutable_labels())["line"] = "A";
  (*filter.mutable_labels())["customer"] = "";
  EXPECT_TRUE(Matches(filter));
  (*filter.mutable_labels())["customer"] = "South";
  EXPECT_FALSE(Matches(filter));
  filter.mutable_labels()->erase("customer");
  (*filter.mutable_labels())["shift"] = "";
  EXPECT_FALSE(Matches(filter));
}

TEST(ResourceFilterTest, TellsCreatorsApart) {
  v1::ResourceFilter filter;
  filter.set_creator("users/ada");
  EXPECT_TRUE(Matches(filter));
  filter.set_creator("users/bob");
  EXPECT_FALSE(Matches(filter));
}

TEST(ResourceFilterTest, TakesFromATimeUntilBeforeAnother) {
  v1::ResourceFilter filter;
  filter.mutable_created_from()->set_seconds(1'000);
  filter.mutable_created_before()->set_seconds(1'001);
  EXPECT_TRUE(Matches(filter));
  EXPECT_FALSE(Matches(filter, v1::Item())) << "what has no time was created at none";
  filter.mutable_created_from()->set_nanos(1);
  EXPECT_FALSE(Matches(filter));
  filter.mutable_created_from()->set_seconds(900);
  filter.mutable_created_before()->set_seconds(1'000);
  EXPECT_FALSE(Matches(filter));
}

TEST(ResourceFilterTest, NamesWhatIsWrongWithIt) {
  v1::ResourceFilter filter;
  filter.set_external_id("tab\t");
  (*filter.mutable_labels())["a b"] = "";
  filter.set_creator(std::string(500, 'x'));
  filter.mutable_created_from()->set_seconds(2'000);
  filter.mutable_created_before()->set_seconds(1'000);
  const auto made = ResourceFilter::Create(filter);
  std::vector<std::string> fields;
  for (const FieldViolation& violation : AllViolationsOf(made.status())) {
    fields.push_back(violation.field);
  }
  EXPECT_THAT(fields, ElementsAre("filter.external_id", "filter.labels", "filter.creator",
                                  "filter.created_before"));
}

TEST(ResourceFilterTest, RefusesWhatIsNoTime) {
  v1::ResourceFilter filter;
  filter.mutable_created_from()->set_nanos(-1);
  EXPECT_FALSE(ResourceFilter::Create(filter).ok());
  filter.mutable_created_from()->set_nanos(0);
  filter.mutable_created_from()->set_seconds(std::int64_t{1} << 60);
  EXPECT_FALSE(ResourceFilter::Create(filter).ok());
}

}  // namespace
}  // namespace mortise::resources
