// Counts of calls by subject and service, and budgets.
#include "gateway/admission/open_calls.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/base/errors.h"
#include "gateway/admission/budget.h"

namespace mortise::gateway {
namespace {

using testing::HasSubstr;

TEST(OpenCalls, CountsEachKindSubjectAndServiceApart) {
  OpenCallLimits limits;
  limits.streams = {1, 2};
  limits.calls = {1, 1};
  OpenCalls calls(limits);
  auto ada = calls.Enter(CallKind::kStream, "users/ada");
  ASSERT_TRUE(ada.ok());
  EXPECT_TRUE((*ada)->EnterService("pareto").ok());
  EXPECT_TRUE(calls.Enter(CallKind::kCall, "users/ada").ok()) << "another kind";
  const absl::Status second = calls.Enter(CallKind::kStream, "users/ada").status();
  EXPECT_EQ(second.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(DetailOf(second).reason, "TOO_MANY_STREAMS");
  EXPECT_THAT(std::string(second.message()), HasSubstr("users/ada has 1 streams open"));

  auto bob = calls.Enter(CallKind::kStream, "users/bob");
  EXPECT_TRUE((*bob)->EnterService("pareto").ok());
  auto eve = calls.Enter(CallKind::kStream, "users/eve");
  const absl::Status third = (*eve)->EnterService("pareto");
  EXPECT_THAT(std::string(third.message()), HasSubstr("the pareto service has 2 streams open"));
  EXPECT_TRUE((*eve)->EnterService("catalog").ok()) << "another service";

  ada->reset();
  EXPECT_TRUE(calls.Enter(CallKind::kStream, "users/ada").ok()) << "counted until it goes";
}

TEST(OpenCalls, HasAPassOfItsOwn) {
  const OpenCalls first({});
  const OpenCalls second({});
  EXPECT_EQ(first.pass().size(), 32u);
  EXPECT_NE(first.pass(), second.pass());
}

TEST(Budget, IsForAllAndLessForEach) {
  Budget budget(10, 6);
  auto ada = budget.Take("ada", 6);
  EXPECT_NE(ada, nullptr);
  EXPECT_EQ(budget.Take("ada", 1), nullptr);
  auto bob = budget.Take("bob", 4);
  EXPECT_NE(bob, nullptr);
  EXPECT_EQ(budget.Take("eve", 1), nullptr);
  ada.reset();
  EXPECT_NE(budget.Take("eve", 6), nullptr);
}

}  // namespace
}  // namespace mortise::gateway
