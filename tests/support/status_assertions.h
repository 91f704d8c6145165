// EXPECT_OK(status) and ASSERT_OK(status), which show the status when it is a failure.
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
