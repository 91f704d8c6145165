// Whether the parts of a model are one whole, and which of them can turn.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/composer/holding/joint_rules.h"
#include "tests/unit/services/composer/holding/holding_parts.h"

namespace mortise::composer {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// An arm that lies on a post, with these fasteners.
Joint ArmOnPost(std::vector<Fastener> fasteners) {
  Joint joint;
  joint.principals = {Joined("post", {0, 0, 0}, {0.1, 0.1, 1}),
                      Joined("arm", {0, 0, 1}, {0.8, 0.1, 1.02})};
  joint.fasteners = std::move(fasteners);
  return joint;
}

Fastener Screw(const std::string& name, double x) {
  return Pin(name, FastenerKind::kScrew, 0.004, x, 0.05, 0.98, 1.02);
}

TEST(JoinedWholeTest, WhatOneScrewHoldsCanTurn) {
  const auto found = JudgeWhole({"post", "arm"}, {ArmOnPost({Screw("screw", 0.05)})});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, "can-turn");
  EXPECT_EQ(found[0].severity, Severity::kWarning);
  EXPECT_THAT(found[0].parts, ElementsAre("arm"));
  EXPECT_THAT(found[0].text, HasSubstr("'screw'"));
}

TEST(JoinedWholeTest, WhatTwoScrewsOrABracketHoldCannot) {
  EXPECT_THAT(
      JudgeWhole({"post", "arm"}, {ArmOnPost({Screw("screw 1", 0.03), Screw("screw 2", 0.07)})}),
      IsEmpty());
  EXPECT_THAT(JudgeWhole({"post", "arm"},
                         {ArmOnPost({Bracket("bracket", {0.1, 0.03, 0.96}, {0.14, 0.07, 1})})}),
              IsEmpty());
}

// A shelf with one pin at either end, both on one axis, swings; with pins that are not it does not.
TEST(JoinedWholeTest, PinsOnOneAxisAreOne) {
  const auto joints = [](double offset) {
    std::vector<Joint> both;
    for (const bool upper : {false, true}) {
      Joint& joint = both.emplace_back();
      const double z = upper ? 1.0 : 0.0;
      joint.principals = {
          Joined("shelf", {0, 0, 0}, {0.3, 0.02, 1}),
          Joined("frame", {0, 0, upper ? 1.0 : -0.02}, {0.3, 0.1, upper ? 1.02 : 0})};
      joint.fasteners = {Pin(upper ? "upper" : "lower", FastenerKind::kDowel, 0.008,
                             0.1 + (upper ? offset : 0), 0.01, z - 0.015, z + 0.015)};
    }
    return both;
  };
  const std::vector<std::string> parts{"frame", "shelf"};
  const auto swings = JudgeWhole(parts, joints(0));
  ASSERT_THAT(swings, SizeIs(1));
  EXPECT_EQ(swings[0].rule, "can-turn");
  EXPECT_THAT(swings[0].parts, ElementsAre("shelf"));
  EXPECT_THAT(JudgeWhole(parts, joints(0.1)), IsEmpty());
}

TEST(JoinedWholeTest, WhatIsMeantToTurnMay) {
  Joint hinge = ArmOnPost({Screw("axle", 0.05)});
  hinge.moves = true;
  EXPECT_THAT(JudgeWhole({"post", "arm"}, {hinge}), IsEmpty());
  Joint wheel = ArmOnPost({Screw("axle", 0.05)});
  wheel.principals[1].turns = true;
  EXPECT_THAT(JudgeWhole({"post", "arm"}, {wheel}), IsEmpty());
}

TEST(JoinedWholeTest, WhatOnlyTouchesAndWhatDoesNotEvenTouch) {
  const auto found =
      JudgeWhole({"post", "arm", "vase", "lamp"},
                 {ArmOnPost({Screw("screw 1", 0.03), Screw("screw 2", 0.07)}), [] {
                    Joint touching;
                    touching.principals = {Joined("arm", {0, 0, 1}, {0.8, 0.1, 1.02}),
                                           Joined("vase", {0, 0, 1.02}, {0.1, 0.1, 1.2})};
                    return touching;
                  }()});
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_EQ(found[0].rule, "unconnected");
  EXPECT_EQ(found[0].severity, Severity::kFault);
  EXPECT_THAT(found[0].parts, ElementsAre("lamp"));
  EXPECT_EQ(found[1].rule, "only-touches");
  EXPECT_EQ(found[1].severity, Severity::kWarning);
  EXPECT_THAT(found[1].parts, ElementsAre("vase"));
}

// Three boards that are screwed together, and lie on a post that stands, are what nothing holds.
TEST(JoinedWholeTest, TheRestIsWhatStands) {
  const auto board = [](const std::string& name, double height) {
    return Joined(name, {0, 0, height}, {0.8, 0.1, height + 0.02});
  };
  Joint lies, lower, upper;
  lies.principals = {Joined("post", {0, 0, 0}, {0.1, 0.1, 1}), board("board 1", 1)};
  lower.principals = {board("board 1", 1), board("board 2", 1.02)};
  lower.fasteners = {Screw("screw 1", 0.03), Screw("screw 2", 0.07)};
  upper.principals = {board("board 2", 1.02), board("board 3", 1.04)};
  upper.fasteners = {Screw("screw 3", 0.03), Screw("screw 4", 0.07)};
  for (Joint* const joint : {&lower, &upper}) {
    for (Fastener& fastener : joint->fasteners) {
      fastener.box.minimum.z() = joint->principals[0].box.minimum.z();
      fastener.box.maximum.z() = joint->principals[1].box.maximum.z();
    }
  }
  const auto found = JudgeWhole({"board 1", "board 2", "board 3", "post"}, {lies, lower, upper});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, kOnlyTouches);
  EXPECT_THAT(found[0].parts, ElementsAre("board 1", "board 2", "board 3"));
}

}  // namespace
}  // namespace mortise::composer
