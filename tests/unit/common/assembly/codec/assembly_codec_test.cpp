// Assemblies out of text: what is read, and where faults are said to be.
#include "common/assembly/codec/assembly_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "common/assembly/model/element.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/files/collection.h"

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;

// A board cut to length, a sheet cut to outline, a screw as it is.
std::vector<Item> Items() {
  Item board;
  board.name = "items/board";
  board.kind = ItemKind::kBoard;
  board.dimensions = {{{2.4, Process::kChopSaw, 0.04, 2.4}, {0.09}, {0.04}}};
  Item sheet;
  sheet.name = "items/sheet";
  sheet.kind = ItemKind::kSheet;
  sheet.dimensions = {
      {{2.5, Process::kJigsaw, 0.05, 2.5}, {1.25, Process::kJigsaw, 0.05, 1.25}, {0.018}}};
  Item screw;
  screw.name = "items/screw";
  screw.kind = ItemKind::kScrew;
  screw.dimensions = {{{0.05}, {0.004}, {0.004}}};
  return {board, sheet, screw};
}

constexpr char kRack[] = R"pb(
  name: "assemblies/rack"
  groups { name: "shelf" parent: "frame" }
  groups { name: "frame" }
  groups { name: "flap" }
  parts {
    name: "post"
    item: "items/board"
    group: "frame"
    length_axis: Z
    thickness_axis: X
    position { x: 0 y: 0 z: 0 }
    size { z: 1.5 }
    repeat {
      count: 2
      offset { x: 0.96 }
    }
    repeat {
      count: 2
      offset { y: 0.31 }
    }
  }
  parts {
    name: "board"
    item: "items/sheet"
    group: "shelf"
    position { x: 0.04 y: 0 z: 0.2 }
    size { x: 0.92 y: 0.4 }
    prominent_planes { name: "middle" axis: Z position: 0.209 }
    repeat {
      count: 3
      offset { z: 0.5 }
    }
  }
  parts {
    name: "screw"
    item: "items/screw"
    role: CONNECTING
    position { x: 0 y: 0.02 z: 0.207 }
  }
  parts {
    name: "door"
    item: "items/sheet"
    group: "flap"
    length_axis: Z
    thickness_axis: Y
    position { x: 0 y: -0.018 z: 0 }
    size { x: 1 z: 1.5 }
  }
  joints {
    name: "hinge"
    kind: HINGE
    group: "flap"
    center { y: -0.018 }
    axis { z: 1 }
    lower: -1.6
    upper: 0
    rest_poses { name: "open" amount: -1.5 }
  }
)pb";

v1::Assembly Rack() { return *ParseAssemblyText(kRack, "rack"); }

std::vector<std::string> FieldsAtFault(const v1::Assembly& message) {
  const absl::Status status = FromProto(message, Items()).status();
  std::vector<std::string> fields;
  for (const FieldViolation& violation : ViolationsOf(status)) fields.push_back(violation.field);
  if (fields.empty() && !status.ok()) fields.push_back(DetailOf(status).field);
  return fields;
}

TEST(AssemblyCodec, DigestDoesNotDependOnTags) {
  const auto tag = [](auto& message) {
    message.add_external_ids("100-4711/A");
    (*message.mutable_labels())["site"] = "Hamburg";
    message.set_creator("users/ada");
    message.mutable_create_time()->set_seconds(12345);
  };
  v1::AssemblyBundle bundle;
  *bundle.mutable_assembly() = Rack();
  bundle.add_items()->set_title("Board");
  bundle.add_materials()->set_title("Oak");
  const std::string digest = BundleDigest(bundle);
  tag(*bundle.mutable_assembly());
  tag(*bundle.mutable_items(0));
  tag(*bundle.mutable_materials(0));
  EXPECT_EQ(BundleDigest(bundle), digest);
  bundle.mutable_items(0)->set_title("Plank");
  EXPECT_NE(BundleDigest(bundle), digest);
}

TEST(AssemblyCodec, ResolvesGroupsItemsAndRepetitions) {
  const auto rack = FromProto(Rack(), Items());
  ASSERT_TRUE(rack.ok()) << rack.status();
  ASSERT_EQ(rack->groups.size(), 4U);
  EXPECT_EQ(rack->groups[0].parent, -1);
  for (std::size_t i = 1; i < rack->groups.size(); ++i) {
    EXPECT_LT(rack->groups[i].parent, static_cast<int>(i)) << "parents come first";
  }
  std::vector<std::string> names;
  for (const AssemblyPart& part : rack->parts) names.push_back(part.name);
  EXPECT_THAT(names, UnorderedElementsAre("post 1.1", "post 1.2", "post 2.1", "post 2.2", "board 1",
                                          "board 2", "board 3", "screw", "door"));
  const AssemblyPart& post = rack->parts[3];
  EXPECT_EQ(post.name, "post 2.2");
  EXPECT_TRUE(post.box.minimum.isApprox(Eigen::Vector3d(0.96, 0.31, 0)));
  EXPECT_TRUE(post.box.size().isApprox(Eigen::Vector3d(0.04, 0.09, 1.5))) << post.box.size();
  EXPECT_EQ(post.limits[2].minimum, 0.04);
  EXPECT_EQ(post.limits[2].maximum, 2.4);
  EXPECT_EQ(post.limits[0].minimum, post.limits[0].maximum);
  EXPECT_FALSE(post.connecting);
  EXPECT_DOUBLE_EQ(rack->parts[6].prominent_planes[0].position, 1.209);
  EXPECT_TRUE(rack->parts[7].connecting);
  ASSERT_EQ(rack->joints.size(), 1U);
  EXPECT_EQ(rack->groups[static_cast<std::size_t>(rack->joints[0].group)].name, "flap");
  EXPECT_TRUE(rack->joints[0].rest_poses[0].motion.isApprox(Eigen::Vector3d(0, 0, -1.5)));
}

// Elements come out the same whichever way the file lists groups.
TEST(AssemblyCodec, TheOrderOfGroupsDoesNotMatter) {
  const auto one = FromProto(Rack(), Items());
  v1::Assembly turned = Rack();
  turned.mutable_groups()->SwapElements(0, 2);
  const auto other = FromProto(turned, Items());
  ASSERT_TRUE(one.ok() && other.ok());
  const auto elements = MakeElements(*one, 1e-6);
  const auto turned_elements = MakeElements(*other, 1e-6);
  ASSERT_EQ(elements.size(), turned_elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i) {
    EXPECT_EQ(elements[i].name, turned_elements[i].name);
    EXPECT_EQ(one->groups[static_cast<std::size_t>(elements[i].group)].name,
              other->groups[static_cast<std::size_t>(turned_elements[i].group)].name);
  }
}

TEST(AssemblyCodec, EveryFaultIsFoundAtOnceWhereItStands) {
  v1::Assembly rack = Rack();
  rack.set_name("rack");
  rack.mutable_groups(1)->set_parent("shelf");             // shelf and frame in a circle
  rack.mutable_parts(0)->set_item("items/beam");           // no such item
  rack.mutable_parts(1)->mutable_repeat(0)->set_count(1);  // no repetition
  rack.mutable_parts(1)->mutable_prominent_planes(0)->set_axis(v1::AXIS_UNSPECIFIED);
  rack.mutable_parts(2)->mutable_size()->set_x(0.06);  // not the screw's length
  rack.mutable_parts(3)->set_length_axis(v1::Y);       // the thickness_axis
  rack.mutable_joints(0)->set_upper(-2);               // below lower
  EXPECT_THAT(
      FieldsAtFault(rack),
      UnorderedElementsAre("name", "groups[0].parent", "groups[1].parent", "parts[0].item",
                           "parts[1].repeat[0].count", "parts[1].prominent_planes[0].axis",
                           "parts[2].size.x", "parts[3].thickness_axis", "joints[0].lower"));
}

// Nor does one fault hide what else is wrong with the same thing.
TEST(AssemblyCodec, OneFaultHidesNoOther) {
  v1::Assembly rack = Rack();
  rack.mutable_parts(0)->set_group("cellar");
  rack.mutable_parts(0)->mutable_repeat(1)->set_count(1);
  rack.mutable_parts(2)->set_item("items/none");
  *rack.add_parts() = rack.parts(2);
  rack.mutable_parts(4)->set_item("items/screw");
  v1::Joint& hinge = *rack.mutable_joints(0);
  hinge.mutable_axis()->set_z(2);
  hinge.set_lower(1);
  hinge.set_upper(-1);
  hinge.mutable_rest_poses(0)->set_amount(std::nan(""));
  EXPECT_THAT(FieldsAtFault(rack),
              UnorderedElementsAre("parts[0].group", "parts[0].repeat[1].count", "parts[2].item",
                                   "parts[4].name", "joints[0].axis", "joints[0].lower",
                                   "joints[0].rest_poses[0]"));
  // Without a name there is no name for the root either, which nobody gave.
  rack = Rack();
  rack.clear_name();
  EXPECT_THAT(FieldsAtFault(rack), UnorderedElementsAre("name"));
}

// A number that is none is one fault beside the others, and what follows from it is none.
TEST(AssemblyCodec, NumbersThatAreNoneHideNothing) {
  v1::Assembly rack = Rack();
  rack.mutable_parts(0)->clear_repeat();
  rack.mutable_parts(0)->mutable_position()->set_x(std::nan(""));
  rack.mutable_parts(0)->mutable_size()->set_z(9);  // longer than its item
  rack.mutable_parts(1)->mutable_size()->set_x(-std::numeric_limits<double>::infinity());
  rack.mutable_parts(1)->mutable_repeat(0)->set_count(1);
  rack.mutable_parts(2)->mutable_size()->set_x(0.06);  // not the screw's length
  v1::Joint& hinge = *rack.mutable_joints(0);
  hinge.mutable_axis()->set_z(std::nan(""));  // of which the motions are made
  hinge.set_upper(std::nan(""));
  hinge.mutable_rest_poses(0)->clear_name();
  EXPECT_THAT(
      FieldsAtFault(rack),
      UnorderedElementsAre("parts[0].position", "parts[0].size.z", "parts[1].repeat[0].count",
                           "parts[1].size", "parts[2].size.x", "joints[0].axis", "joints[0].upper",
                           "joints[0].rest_poses[0].name"));
  // Nor is one taken that nothing is made of.
  rack = Rack();
  rack.mutable_joints(0)->set_kind(v1::Joint::BALL);
  rack.mutable_joints(0)->set_lower(0);
  rack.mutable_joints(0)->set_upper(1.6);
  rack.mutable_joints(0)->mutable_rest_poses(0)->set_amount(0);
  EXPECT_THAT(FieldsAtFault(rack), UnorderedElementsAre());
  rack.mutable_joints(0)->mutable_axis()->set_z(std::nan(""));
  EXPECT_THAT(FieldsAtFault(rack), UnorderedElementsAre("joints[0].axis"));
}

TEST(AssemblyCodec, RefusesPartsInOnePlace) {
  v1::Assembly rack = Rack();
  *rack.add_parts() = rack.parts(3);
  rack.mutable_parts(4)->set_name("second door");
  EXPECT_THAT(FieldsAtFault(rack), UnorderedElementsAre("parts[4].position"));
  EXPECT_THAT(std::string(FromProto(rack, Items()).status().message()),
              HasSubstr("'second door': lies in the same place as 'door'"));
  rack.mutable_parts(4)->mutable_position()->set_y(-0.036);
  EXPECT_THAT(FieldsAtFault(rack), UnorderedElementsAre());
}

TEST(AssemblyCodec, RefusesPlanesFarFromTheirPart) {
  v1::Assembly rack = Rack();
  auto& plane = *rack.mutable_parts(3)->add_prominent_planes();  // of the door, 1 by 1.5 m
  plane.set_name("hinge line");
  plane.set_axis(v1::Y);
  plane.set_position(1.4);
  EXPECT_THAT(FieldsAtFault(rack), UnorderedElementsAre());
  plane.set_position(1.6);
  EXPECT_THAT(FieldsAtFault(rack), UnorderedElementsAre("parts[3].prominent_planes[0].position"));
  plane.set_position(-1.6);
  EXPECT_THAT(FieldsAtFault(rack), UnorderedElementsAre("parts[3].prominent_planes[0].position"));
}

TEST(AssemblyCodec, RefusesWhatCannotBe) {
  const auto faults = [](const std::function<void(v1::Assembly&)>& change) {
    v1::Assembly rack = Rack();
    change(rack);
    return FieldsAtFault(rack);
  };
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_parts(2)->set_name("post 1.1"); }),
              UnorderedElementsAre("parts[2].name"))
      << "a name that a repetition has";
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_parts(1)->set_name("a\nb"); }),
              UnorderedElementsAre("parts[1].name"));
  EXPECT_THAT(faults([](auto& rack) { *rack.add_groups() = rack.groups(0); }),
              UnorderedElementsAre("groups[3].name"));
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_parts(3)->mutable_size()->set_x(0); }),
              UnorderedElementsAre("parts[3].size"));
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_parts(3)->mutable_size()->set_x(1.3); }),
              UnorderedElementsAre("parts[3].size.x"))
      << "wider than the sheet";
  EXPECT_THAT(
      faults([](auto& rack) { rack.mutable_parts(3)->mutable_position()->set_x(std::nan("")); }),
      UnorderedElementsAre("parts[3].position"));
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_joints(0)->clear_group(); }),
              UnorderedElementsAre("joints[0].group"));
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_joints(0)->set_group("door"); }),
              UnorderedElementsAre("joints[0].group"));
  EXPECT_THAT(faults([](auto& rack) { rack.clear_parts(); }), UnorderedElementsAre("parts"));
  EXPECT_THAT(faults([](auto& rack) {
                rack.mutable_parts(0)->mutable_repeat(0)->set_count(1000);
                rack.mutable_parts(0)->mutable_repeat(1)->set_count(1000);
              }),
              UnorderedElementsAre("parts"));
}

TEST(AssemblyCodec, RefusesWhatSaysNothing) {
  const auto faults = [](const std::function<void(v1::Assembly&)>& change) {
    v1::Assembly rack = Rack();
    change(rack);
    return FieldsAtFault(rack);
  };
  EXPECT_THAT(faults([](auto& rack) {
                auto& pose = *rack.mutable_joints(0)->add_rest_poses();
                pose.set_name("ajar");
                pose.mutable_rotation()->set_z(-1);
              }),
              UnorderedElementsAre("joints[0].rest_poses[1].rotation"))
      << "a hinge turns by an amount";
  EXPECT_THAT(faults([](auto& rack) {
                auto& joint = *rack.mutable_joints(0);
                joint.set_kind(v1::Joint::BALL);
                joint.set_lower(0);
                joint.set_upper(1.6);
                joint.mutable_rest_poses(0)->set_amount(1);
              }),
              UnorderedElementsAre("joints[0].rest_poses[0].amount"))
      << "a ball by a rotation";
  EXPECT_THAT(
      faults([](auto& rack) { *rack.mutable_parts(1)->add_repeat() = rack.parts(1).repeat(0); }),
      UnorderedElementsAre("parts[1].repeat[1].offset"));
  EXPECT_THAT(faults([](auto& rack) {
                auto& twice = *rack.mutable_parts(1)->add_repeat();
                twice.set_count(2);
                twice.mutable_offset()->set_z(-1);
              }),
              UnorderedElementsAre("parts[1].repeat[1].offset"))
      << "two steps of one are one of the other";
  EXPECT_THAT(faults([](auto& rack) {
                auto& beyond = *rack.mutable_parts(1)->add_repeat();
                beyond.set_count(2);
                beyond.mutable_offset()->set_z(1.5);
              }),
              UnorderedElementsAre())
      << "one step of one leads past all of the other";
}

TEST(AssemblyCodec, RefusesWhatIsTooFarTooSmallOrTooLong) {
  const auto faults = [](const std::function<void(v1::Assembly&)>& change) {
    v1::Assembly rack = Rack();
    change(rack);
    return FieldsAtFault(rack);
  };
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_joints(0)->mutable_center()->set_x(1e300); }),
              UnorderedElementsAre("joints[0].center"));
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_joints(0)->set_lower(-1e300); }),
              UnorderedElementsAre("joints[0].lower"));
  EXPECT_THAT(faults([](auto& rack) { rack.mutable_joints(0)->set_upper(101); }),
              UnorderedElementsAre("joints[0].upper"));
  EXPECT_THAT(faults([](auto& rack) {
                v1::Joint& ball = *rack.mutable_joints(0);
                ball.set_kind(v1::Joint::BALL);
                ball.set_lower(-0.1);
                ball.set_upper(3.2);
                ball.clear_rest_poses();
              }),
              UnorderedElementsAre("joints[0].lower", "joints[0].upper"))
      << "a ball turns by 0 to half a turn";
  EXPECT_THAT(faults([](auto& rack) {
                rack.mutable_joints(0)->set_kind(v1::Joint::PRISMATIC);
                rack.mutable_joints(0)->set_lower(-101);
              }),
              UnorderedElementsAre())
      << "101 m is not far";
  EXPECT_THAT(faults([](auto& rack) {
                rack.mutable_parts(3)->clear_item();
                rack.mutable_parts(3)->mutable_size()->set_y(5e-7);
              }),
              UnorderedElementsAre("parts[3].size"));
  EXPECT_THAT(faults([](auto& rack) {
                rack.set_title(std::string(201, 'x'));
                rack.set_description(std::string(10'001, 'x'));
                rack.mutable_parts(2)->set_title(std::string(201, 'x'));
              }),
              UnorderedElementsAre("title", "description", "parts[2].title"));
  EXPECT_THAT(faults([](auto& rack) {
                rack.mutable_parts(0)->set_priority(1000);
                rack.mutable_parts(1)->set_priority(1001);
                rack.mutable_parts(2)->set_priority(-1);
              }),
              UnorderedElementsAre("parts[1].priority", "parts[2].priority"));
}

TEST(AssemblyCodec, TextThatIsNoneIsRefusedWithItsPlace) {
  const auto read =
      ParseAssemblyText("name: 'assemblies/a'\nparts { colour: 3 }", "rack.textproto");
  EXPECT_TRUE(absl::IsInvalidArgument(read.status()));
  EXPECT_EQ(DetailOf(read.status()).field, "rack.textproto: line 2, column 9");
}

}  // namespace
}  // namespace mortise::parametric
