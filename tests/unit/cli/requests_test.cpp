// What people write for requests, and what they read of results.
#include "cli/requests.h"

#include <gtest/gtest.h>

#include <string>

#include "common/base/errors.h"

namespace mortise::cli {
namespace {

TEST(Requests, VectorsAreThreeNumbers) {
  const auto vector = ParseVector("-10, 0,2.5e-1", "--wind");
  ASSERT_TRUE(vector.ok()) << vector.status();
  EXPECT_EQ(vector->x(), -10);
  EXPECT_EQ(vector->y(), 0);
  EXPECT_EQ(vector->z(), 0.25);
  for (const char* const text :
       {"", "1", "1, 2", "1, 2, 3, 4", "1, 2, x", "1, , 3", "1, 2, nan", "inf, 0, 0", "1 2 3"}) {
    const absl::Status status = ParseVector(text, "--wind").status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_EQ(DetailOf(status).field, "--wind") << text;
  }
}

std::string TextOf(double value, const std::string& unit) {
  v1::Metric metric;
  metric.set_value(value);
  metric.set_unit(unit);
  return MetricText(metric);
}

TEST(Requests, MetricsHaveUnitsThatPeopleUse) {
  EXPECT_EQ(TextOf(0.0125, "m"), "12.5 mm");
  EXPECT_EQ(TextOf(3.5e7, "Pa"), "35 MPa");
  EXPECT_EQ(TextOf(-3.5e7, "Pa"), "-35 MPa");
  EXPECT_EQ(TextOf(59.75, "Pa"), "59.75 Pa");
  EXPECT_EQ(TextOf(-81.2, "Pa"), "-81.2 Pa");
  EXPECT_EQ(TextOf(2.25, "kg"), "2.25 kg");
}

}  // namespace
}  // namespace mortise::cli
