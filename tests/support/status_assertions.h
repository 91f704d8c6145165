// EXPECT_OK(status), ASSERT_OK(status) and ASSERT_OK_AND_ASSIGN(variable, status_or), which show
// the status when it is a failure.
#pragma once

#include <gtest/gtest.h>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::testing {

inline ::testing::AssertionResult IsOk(const absl::Status& status) {
  if (status.ok()) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << status;
}

template <typename T>
::testing::AssertionResult IsOk(const absl::StatusOr<T>& result) {
  return IsOk(result.status());
}

}  // namespace mortise::testing

#define EXPECT_OK(expression) EXPECT_TRUE(::mortise::testing::IsOk(expression))
#define ASSERT_OK(expression) ASSERT_TRUE(::mortise::testing::IsOk(expression))

#define MORTISE_TEST_JOIN_INNER(a, b) a##b
#define MORTISE_TEST_JOIN(a, b) MORTISE_TEST_JOIN_INNER(a, b)
#define MORTISE_TEST_ASSIGN(result, variable, expression) \
  auto result = (expression);                             \
  ASSERT_OK(result);                                      \
  variable = *std::move(result)

// Declares or sets `variable` to the value of a StatusOr; ends the test if there is none.
#define ASSERT_OK_AND_ASSIGN(variable, expression) \
  MORTISE_TEST_ASSIGN(MORTISE_TEST_JOIN(result_, __LINE__), variable, expression)
