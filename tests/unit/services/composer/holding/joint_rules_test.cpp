// Joints by the numbers: where the rules begin to complain.
#include "services/composer/holding/joint_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/services/composer/holding/holding_parts.h"

namespace mortise::composer {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

// A plate of 18 mm that lies on a post of 0.1 x 0.1 m.
Joint PlateOnPost(std::vector<Fastener> fasteners) {
  Joint joint;
  joint.principals = {Joined("plate", {0, 0, 0.1}, {0.1, 0.1, 0.118}),
                      Joined("post", {0, 0, 0}, {0.1, 0.1, 0.1})};
  joint.fasteners = std::move(fasteners);
  joint.length = 0.1;
  return joint;
}

// A screw of 4 x 45 mm from the plate's upper side, so far from its edge: 27 mm are in the post.
Joint ScrewAt(double from_edge) {
  return PlateOnPost({Pin("screw", FastenerKind::kScrew, 0.004, 0.05, from_edge, 0.073, 0.118)});
}

TEST(JointRulesTest, AScrewAndTheEdge) {
  EXPECT_THAT(JudgeJoints({ScrewAt(0.012)}), IsEmpty());
  const auto at_two = JudgeJoints({ScrewAt(0.008)});  // 2 d
  ASSERT_THAT(at_two, SizeIs(2));                     // in both parts
  EXPECT_EQ(at_two[0].severity, Severity::kNotice);
  EXPECT_EQ(at_two[0].rule, "edge-distance");
  EXPECT_THAT(at_two[0].parts, ElementsAre("screw"));
  EXPECT_NEAR(at_two[0].found, 2, 1e-9);
  EXPECT_EQ(at_two[0].wanted, 3);
  EXPECT_EQ(at_two[0].unit, "d");
  EXPECT_THAT(at_two[0].source, HasSubstr("EN 1995-1-1"));
  EXPECT_THAT(at_two[0].text, HasSubstr("'plate'"));
  EXPECT_EQ(JudgeJoints({ScrewAt(0.0075)})[0].severity, Severity::kWarning);
  EXPECT_EQ(JudgeJoints({ScrewAt(0.0015)})[0].severity, Severity::kFault);
}

TEST(JointRulesTest, MetalAndPartsThatDoNotFillTheirBoxes) {
  Joint joint = ScrewAt(0.005);
  joint.principals[0].is_metal = true;  // 1.25 d are enough there
  joint.principals[1].is_box = false;
  EXPECT_THAT(JudgeJoints({joint}), IsEmpty());
  joint.principals[0].box.minimum.y() = 0.001;
  EXPECT_THAT(JudgeJoints({joint}), SizeIs(1));
}

// The same of each part of a row is told of the row.
TEST(JointRulesTest, PartsOfARowAreToldOfOnce) {
  Joint first = ScrewAt(0.008), second = ScrewAt(0.008);
  first.principals[0].name = "slat 1";
  second.principals[0].name = "slat 2";
  second.fasteners[0].name = "screw 2";
  const auto found = Ordered(JudgeJoints({first, second}));
  ASSERT_THAT(found, SizeIs(2));
  EXPECT_THAT(found[0].parts, ElementsAre("screw", "screw 2"));
  EXPECT_THAT(found[0].text, HasSubstr("'slat'"));
}

TEST(JointRulesTest, HowDeepAScrewIs) {
  const auto with_depth = [](double depth) {
    return JudgeJoints(
        {PlateOnPost({Pin("screw", FastenerKind::kScrew, 0.004, 0.05, 0.05, 0.1 - depth, 0.118)})});
  };
  EXPECT_THAT(with_depth(0.024), IsEmpty());
  const auto five = with_depth(0.020);
  ASSERT_THAT(five, SizeIs(1));
  EXPECT_EQ(five[0].severity, Severity::kNotice);
  EXPECT_EQ(five[0].rule, "thread-depth");
  EXPECT_NEAR(five[0].found, 5, 1e-9);
  EXPECT_EQ(five[0].wanted, 6);
  EXPECT_EQ(with_depth(0.012)[0].severity, Severity::kWarning);
}

TEST(JointRulesTest, HowDeepADowelIs) {
  const auto with_depth = [](double depth) {
    return JudgeJoints(
        {PlateOnPost({Pin("dowel", FastenerKind::kDowel, 0.008, 0.05, 0.05, 0.1 - depth, 0.112)})});
  };
  EXPECT_THAT(with_depth(0.018), IsEmpty());
  const auto shallow = with_depth(0.008);
  ASSERT_THAT(shallow, SizeIs(1));
  EXPECT_EQ(shallow[0].rule, "dowel-depth");
  EXPECT_NEAR(shallow[0].found, 1, 1e-9);
  EXPECT_THAT(shallow[0].text, HasSubstr("'post'"));
}

TEST(JointRulesTest, ABracketNeedsAScrewInEachPart) {
  const Fastener bracket = Bracket("bracket", {0.1, 0.04, 0.06}, {0.14, 0.06, 0.1});
  Joint joint;
  joint.principals = {Joined("top", {0, 0, 0.1}, {0.5, 0.1, 0.13}),
                      Joined("post", {0, 0, 0}, {0.1, 0.1, 0.1})};
  joint.fasteners = {bracket, Pin("screw", FastenerKind::kScrew, 0.004, 0.12, 0.05, 0.098, 0.128)};
  joint.length = 0.1;
  const auto found = JudgeJoints({joint});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, "bracket-not-fastened");
  EXPECT_THAT(found[0].parts, ElementsAre("bracket"));
  EXPECT_THAT(found[0].text, HasSubstr("'post'"));
}

TEST(JointRulesTest, ALongJointNeedsMoreFasteners) {
  Joint joint = ScrewAt(0.05);
  joint.length = 0.6;
  const auto found = JudgeJoints({joint});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].rule, "fastener-spacing");
  EXPECT_EQ(found[0].found, 1);
  EXPECT_EQ(found[0].wanted, 2);
  joint.fasteners.push_back(joint.fasteners.front());
  EXPECT_THAT(JudgeJoints({joint}), IsEmpty());
}

}  // namespace
}  // namespace mortise::composer
