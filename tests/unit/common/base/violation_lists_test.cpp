// Refusals of one field and of several, read and joined alike.
#include "common/base/violation_lists.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.h"

namespace mortise {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> Told(const absl::Status& status) {
  std::vector<std::string> told;
  for (const FieldViolation& violation : AllViolationsOf(status)) {
    told.push_back(violation.field + " | " + violation.message);
  }
  return told;
}

TEST(ViolationLists, AreOfOneFieldOrSeveral) {
  EXPECT_THAT(Told(InvalidField("a.b", "is missing")), ElementsAre("a.b | is missing"));
  EXPECT_THAT(Told(InvalidFields({{"a", "is 1"}, {"b", "is 2"}})),
              ElementsAre("a | is 1", "b | is 2"));
  EXPECT_THAT(Told(absl::InvalidArgumentError("no")), ElementsAre(" | no"));
  EXPECT_THAT(Told(absl::OkStatus()), IsEmpty());
  EXPECT_THAT(Told(absl::InternalError("broken")), IsEmpty());
}

TEST(ViolationLists, AreJoined) {
  const absl::Status one = InvalidField("a", "is 1"), two = InvalidFields({{"b", "2"}, {"c", "3"}});
  EXPECT_THAT(Told(CombineViolations(one, two)), ElementsAre("a | is 1", "b | 2", "c | 3"));
  EXPECT_EQ(CombineViolations(absl::OkStatus(), one), one);
  EXPECT_EQ(CombineViolations(two, absl::OkStatus()), two);
  EXPECT_TRUE(CombineViolations(absl::OkStatus(), absl::OkStatus()).ok());
  EXPECT_TRUE(absl::IsInternal(CombineViolations(one, absl::InternalError("broken"))));
  EXPECT_TRUE(absl::IsInternal(CombineViolations(absl::InternalError("broken"), one)));
}

}  // namespace
}  // namespace mortise
