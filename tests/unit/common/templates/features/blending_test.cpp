// Fillets and chamfers that run into bores, grooves and other faces. Over some of these the kernel
// ends its process; here that is an error like any other.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "tests/unit/common/templates/features/feature_texts.h"

namespace mortise::cad {
namespace {

using testing::HasSubstr;

// A bar of 0.4 × 0.04 × 0.04 m along X, of which y and z begin at 0: "bar.section.top", …
std::string BarText() {
  return "features { name: 'bar_sketch' sketch { plane { normal { x: '1' } } profiles { name: "
         "'section' rectangle { center { x: '0.02' y: '0.02' } width: '0.04' height: '0.04' } } } "
         "} features { name: 'bar' extrude { sketch: 'bar_sketch' to: '0.4' } } ";
}

std::string BoredText(double x, double y, double diameter) {
  return absl::StrCat("features { name: 'bore' hole { face: 'bar.section.top' position { x: '", x,
                      "' y: '", y, "' z: '0.04' } diameter: '", diameter, "' } } ");
}

std::string RoundedText(const std::string& edges, double radius) {
  return absl::StrCat("features { name: 'round' fillet { edges: '", edges, "' radius: '", radius,
                      "' } } ");
}

std::string BevelledText(const std::string& edges, double distance) {
  return absl::StrCat("features { name: 'bevel' chamfer { edges: '", edges, "' distance: '",
                      distance, "' } } ");
}

constexpr const char* kCrossed = "bar.section.bottom & bar.section.left";

// The bore lies across the edge, as deep as the fillet is wide.
TEST(Blends, ThatTheKernelCrashesOverAreRefused) {
  const auto model =
      SolidOf("", BarText() + BoredText(0.2, 0, 0.008) + RoundedText(kCrossed, 0.004));
  ASSERT_FALSE(model.ok());
  EXPECT_TRUE(absl::IsInvalidArgument(model.status())) << model.status();
  EXPECT_EQ(DetailOf(model.status()).field, "features[3].fillet.radius");
  const std::string message(model.status().message());
  EXPECT_THAT(message, HasSubstr("edges cannot be rounded with 0.004 m: 'round' meets another"));
  EXPECT_THAT(message, HasSubstr(kCrossed));
  EXPECT_THAT(message, HasSubstr("; a radius of 0.00"));
}

// What the message says can be made is.
TEST(Blends, CanBeMadeAsTheirRefusalSays) {
  const auto refused =
      SolidOf("", BarText() + BoredText(0.2, 0, 0.008) + RoundedText(kCrossed, 0.004));
  const std::string message(refused.status().message());
  const std::string before = "a radius of ";
  const std::size_t at = message.find(before);
  ASSERT_NE(at, std::string::npos) << message;
  const double radius = std::stod(message.substr(at + before.size()));
  EXPECT_LT(radius, 0.004);
  const auto made =
      SolidOf("", BarText() + BoredText(0.2, 0, 0.008) + RoundedText(kCrossed, radius));
  EXPECT_TRUE(made.ok()) << made.status();
}

TEST(Blends, ThatTouchNothingAreMade) {
  const auto model =
      SolidOf("", BarText() + BoredText(0.2, 0.02, 0.008) + RoundedText(kCrossed, 0.004));
  ASSERT_TRUE(model.ok()) << model.status();
}

TEST(Blends, TooLargeForTheirFacesAreRefused) {
  const auto model = SolidOf("", BarText() + RoundedText(kCrossed, 0.05));
  ASSERT_FALSE(model.ok());
  EXPECT_EQ(DetailOf(model.status()).field, "features[2].fillet.radius");
  EXPECT_THAT(std::string(model.status().message()), HasSubstr("cannot be rounded with 0.05 m"));
}

// Bores anywhere, through and over the edges, and blends of any size: each design is made or
// refused, and the process goes on.
TEST(Blends, NeverEndTheProcess) {
  std::mt19937 bits(7);
  const auto between = [&bits](double from, double to) {
    return from + (to - from) * static_cast<double>(bits() % 1000) / 999;
  };
  const std::vector<std::string> edges = {kCrossed,
                                          "bar.section.top & bar.section.left",
                                          "bar.section.top & bar.end",
                                          "bore.wall & bar.section.top",
                                          "bar.section.left",
                                          "bar.section.top"};
  int made = 0, refused = 0;
  for (int i = 0; i < 200; ++i) {
    // Sizes in half millimetres, so that some just meet.
    const double diameter = 0.001 * std::floor(between(3, 16));
    const double y = 0.0005 * std::floor(between(-10, 50));
    const double x = bits() % 3 == 0 ? 0.4 - 0.0005 * std::floor(between(0, 20)) : 0.2;
    const double size = 0.0005 * std::floor(between(1, 20));
    const std::string& edge = edges[bits() % edges.size()];
    const bool round = bits() % 3 != 0;
    const auto model =
        SolidOf("", BarText() + BoredText(x, y, diameter) +
                        (round ? RoundedText(edge, size) : BevelledText(edge, size)));
    if (model.ok()) {
      ++made;
      EXPECT_GT(model->solid.Volume(), 0);
    } else {
      ++refused;
      EXPECT_TRUE(absl::IsInvalidArgument(model.status())) << model.status();
    }
  }
  EXPECT_GT(made, 50);
  EXPECT_GT(refused, 5);
}

}  // namespace
}  // namespace mortise::cad
