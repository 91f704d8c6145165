// Findings as people get them.
#include "services/composer/holding/finding.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mortise::composer {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

TEST(FindingTest, TheWorstComesFirstAndTheSameOnce) {
  const auto found = Ordered({{Severity::kNotice, "edge", {"screw 1"}, 2, 3, "d", "near", ""},
                              {Severity::kFault, "edge", {"screw 2"}, 0, 3, "d", "out", ""},
                              {Severity::kNotice, "edge", {"screw 3"}, 2, 3, "d", "near", ""},
                              {Severity::kNotice, "edge", {"screw 1"}, 2, 3, "d", "near", ""},
                              {Severity::kNotice, "depth", {"screw 1"}, 2, 3, "d", "near", ""}});
  ASSERT_THAT(found, SizeIs(3));
  EXPECT_THAT(found[0].parts, ElementsAre("screw 2"));
  EXPECT_THAT(found[1].parts, ElementsAre("screw 1", "screw 3"));
  EXPECT_EQ(found[2].rule, "depth");
}

}  // namespace
}  // namespace mortise::composer
