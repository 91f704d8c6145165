#include "common/rpc/message_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "mortise/v1/template.pb.h"
#include "probe.pb.h"
#include "tests/support/status_assertions.h"

namespace mortise::rpc {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

void ExpectRefused(const testing::ReadRequest& request, const std::string& field,
                   const std::string& message) {
  const absl::Status status = CheckMessage(request);
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(status).field, field);
  EXPECT_EQ(status.message(), field + ": " + message);
}

TEST(MessageCheckTest, TakesGoodMessages) {
  testing::ReadRequest request;
  EXPECT_OK(CheckMessage(request));
  request.set_number(-1e308);
  request.add_parts()->add_numbers(3e38f);
  request.add_shades(testing::DARK);
  (*request.mutable_by_name())["a"].set_shade(testing::LIGHT);
  EXPECT_OK(CheckMessage(request));
}

TEST(MessageCheckTest, NamesTheNumberThatIsNotFinite) {
  testing::ReadRequest top;
  top.set_number(kNaN);
  ExpectRefused(top, "number", "must be a finite number");

  testing::ReadRequest nested;
  nested.add_parts();
  testing::Inner* part = nested.add_parts();
  part->add_numbers(1);
  part->add_numbers(2);
  part->add_numbers(-kInfinity);
  ExpectRefused(nested, "parts[1].numbers[2]", "must be a finite number");

  testing::ReadRequest chosen;
  chosen.mutable_inner()->set_number(kInfinity);
  ExpectRefused(chosen, "inner.number", "must be a finite number");

  testing::ReadRequest mapped;
  (*mapped.mutable_by_name())["left"].set_number(kNaN);
  ExpectRefused(mapped, "by_name[\"left\"].number", "must be a finite number");
}

// As mortise/v1/template.proto says.
TEST(MessageCheckTest, LetsHeightsBeUnknown) {
  v1::Template message;
  v1::HeightGrid& grid = *message.add_height_fields()->mutable_grid();
  grid.add_heights(kNaN);
  EXPECT_OK(CheckMessage(message));
  grid.add_heights(kInfinity);
  EXPECT_EQ(DetailOf(CheckMessage(message)).field, "height_fields[0].grid.heights[1]");
  grid.set_heights(1, 2);
  grid.set_x(kNaN);
  EXPECT_EQ(DetailOf(CheckMessage(message)).field, "height_fields[0].grid.x");
}

TEST(MessageCheckTest, NamesAllOfThemButNotThousands) {
  testing::ReadRequest request;
  request.set_number(kNaN);
  request.add_parts()->add_numbers(kInfinity);
  (*request.mutable_by_name())["left"].set_number(kNaN);
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(CheckMessage(request))) {
    fields.push_back(violation.field);
  }
  std::sort(fields.begin(), fields.end());
  EXPECT_EQ(fields, (std::vector<std::string>{"by_name[\"left\"].number", "number",
                                              "parts[0].numbers[0]"}));
  for (int i = 0; i < 10'000; ++i) request.mutable_parts(0)->add_numbers(kInfinity);
  EXPECT_LT(ViolationsOf(CheckMessage(request)).size(), 100U);
}

TEST(MessageCheckTest, NamesTheEnumThatIsUnknown) {
  testing::ReadRequest repeated;
  repeated.add_shades(testing::LIGHT);
  repeated.add_shades(static_cast<testing::Shade>(7));
  ExpectRefused(repeated, "shades[1]", "7 is not a value of Shade");

  testing::ReadRequest nested;
  nested.mutable_inner()->set_shade(static_cast<testing::Shade>(-1));
  ExpectRefused(nested, "inner.shade", "-1 is not a value of Shade");
}

}  // namespace
}  // namespace mortise::rpc
