// QR codes by their structure; that readers read them, labels_pdf_test says.
#include "services/fabplanner/paper/qr_code.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace mortise::fabplanner {
namespace {

using ::testing::HasSubstr;

TEST(QrCodeTest, HasAFinderInThreeCorners) {
  const auto code = QrCodeOf("plans/0198c1/parts/leg_1?step=2");
  ASSERT_TRUE(code.ok()) << code.status();
  EXPECT_EQ(code->side % 4, 1);  // 21, 25, 29 …
  ASSERT_EQ(code->dark.size(), static_cast<std::size_t>(code->side * code->side));
  const auto dark = [&](int column, int row) {
    return code->dark[static_cast<std::size_t>(row * code->side + column)];
  };
  const int far = code->side - 7;
  for (const auto& [left, top] : {std::pair(0, 0), {far, 0}, {0, far}}) {
    for (int i = 0; i < 7; ++i) {
      EXPECT_TRUE(dark(left + i, top) && dark(left, top + i));
    }
    EXPECT_FALSE(dark(left + 1, top + 1));
    EXPECT_TRUE(dark(left + 3, top + 3));
  }
}

TEST(QrCodeTest, HoldsAsMuchAsItSaysAndNoMore) {
  EXPECT_TRUE(QrCodeOf(std::string(2331, 'x')).ok());
  const auto more = QrCodeOf(std::string(2332, 'x'));
  EXPECT_EQ(more.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(more.status().message(), HasSubstr("2332 bytes"));
  EXPECT_THAT(QrCodeOf("").status().message(), HasSubstr("code"));
}

}  // namespace
}  // namespace mortise::fabplanner
