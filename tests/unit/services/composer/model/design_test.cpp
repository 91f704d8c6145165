// Designs drawn anew: whatever ships, at random parameters and anywhere in space, is a valid
// assembly again, and looks as it did.
#include "services/composer/model/design.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "common/mesh/mass_properties.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/codec/shipped_assemblies.h"

namespace mortise::composer {
namespace {

using ::testing::IsEmpty;

std::vector<std::string> GroupsAndJoints(const parametric::Assembly& assembly) {
  std::vector<std::string> names;
  for (const auto& group : assembly.groups) names.push_back(group.name);
  for (const auto& joint : assembly.joints) names.push_back(joint.name);
  return names;
}

class ShippedDesignTest : public ::testing::TestWithParam<std::string> {};

TEST_P(ShippedDesignTest, IsAValidAssemblyWhereverItIsDrawnAnew) {
  ASSERT_OK_AND_ASSIGN(parametric::Assembly assembly, parametric::ReadShippedAssembly(GetParam()));
  ASSERT_OK_AND_ASSIGN(Design design, AsDrawn(std::move(assembly)));
  ASSERT_OK_AND_ASSIGN(const auto samples, design.assembly->Sample(2, 11));
  for (const Eigen::VectorXd& q : samples) {
    design.q = q;
    design.shift = {0.25, -1.5, 0.125};
    ASSERT_OK_AND_ASSIGN(const Redrawn redrawn, Redraw(design));
    EXPECT_THAT(parametric::ValidateAssembly(redrawn.assembly), IsEmpty());
    EXPECT_EQ(GroupsAndJoints(redrawn.assembly), GroupsAndJoints(design.assembly->assembly()));
    ASSERT_EQ(redrawn.drawn_as.size(), redrawn.assembly.parts.size());
    const std::vector<parametric::PlacedPart> placed = PartsOf(design);
    ASSERT_EQ(placed.size(), redrawn.assembly.parts.size());
    for (std::size_t i = 0; i < placed.size(); ++i) {
      EXPECT_EQ(redrawn.assembly.parts[i].name, placed[i].name);
      EXPECT_LE((redrawn.assembly.parts[i].box.minimum - placed[i].box.minimum).norm(), 1e-8);
      EXPECT_LE((redrawn.assembly.parts[i].box.maximum - placed[i].box.maximum).norm(), 1e-8);
    }
  }
}

TEST_P(ShippedDesignTest, HasTheSamePartsWhenItIsParametrisedAnew) {
  ASSERT_OK_AND_ASSIGN(parametric::Assembly assembly, parametric::ReadShippedAssembly(GetParam()));
  ASSERT_OK_AND_ASSIGN(Design design, AsDrawn(std::move(assembly)));
  ASSERT_OK_AND_ASSIGN(const auto samples, design.assembly->Sample(1, 5));
  design.q = samples.front();
  ASSERT_OK_AND_ASSIGN(parametric::Assembly redrawn, DrawnAt(design));
  ASSERT_OK_AND_ASSIGN(const Design again, AsDrawn(std::move(redrawn)));
  std::multiset<std::string> before, after;
  for (const auto& part : PartsOf(design)) before.insert(part.name);
  for (const auto& part : PartsOf(again)) after.insert(part.name);
  EXPECT_EQ(before, after);
}

INSTANTIATE_TEST_SUITE_P(Collection, ShippedDesignTest,
                         ::testing::ValuesIn(parametric::ShippedAssemblyIds()),
                         [](const auto& shipped) { return shipped.param; });

TEST(DesignTest, AsDrawnItIsTheSame) {
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly assembly,
                       parametric::ReadShippedAssembly("cabinet"));
  ASSERT_OK_AND_ASSIGN(const Design design, AsDrawn(assembly));
  ASSERT_OK_AND_ASSIGN(const Redrawn redrawn, Redraw(design));
  ASSERT_EQ(redrawn.assembly.parts.size(), assembly.parts.size());
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    const parametric::AssemblyPart& made = redrawn.assembly.parts[i];
    const auto drawn =
        std::find_if(assembly.parts.begin(), assembly.parts.end(),
                     [&](const parametric::AssemblyPart& part) { return part.name == made.name; });
    ASSERT_NE(drawn, assembly.parts.end()) << made.name;
    EXPECT_EQ(redrawn.drawn_as[i], made.name);
    EXPECT_LE((made.box.minimum - drawn->box.minimum).norm(), 1e-12) << made.name;
    EXPECT_LE((made.box.maximum - drawn->box.maximum).norm(), 1e-12) << made.name;
    EXPECT_EQ(made.shape, drawn->shape) << made.name;
    EXPECT_EQ(made.group, drawn->group) << made.name;
    ASSERT_EQ(made.prominent_planes.size(), drawn->prominent_planes.size());
    for (std::size_t k = 0; k < made.prominent_planes.size(); ++k) {
      EXPECT_NEAR(made.prominent_planes[k].position, drawn->prominent_planes[k].position, 1e-12);
    }
  }
}

TEST(DesignTest, WhatARowHasBeyondTheDrawingIsACopyOfItsFirst) {
  ASSERT_OK_AND_ASSIGN(parametric::Assembly assembly, parametric::ReadShippedAssembly("bookshelf"));
  ASSERT_OK_AND_ASSIGN(Design design, AsDrawn(std::move(assembly)));
  ASSERT_OK_AND_ASSIGN(const parametric::Adjustment higher,
                       design.assembly->Adjust(design.q, {{{"side 1", Axis::kZ}, 2.4}},
                                               parametric::DemandPolicy::kStrict));
  design.q = higher.q;
  ASSERT_OK_AND_ASSIGN(const Redrawn redrawn, Redraw(design));
  int shelves = 0;
  for (std::size_t i = 0; i < redrawn.assembly.parts.size(); ++i) {
    const std::string& name = redrawn.assembly.parts[i].name;
    if (!name.starts_with("shelf ")) continue;
    ++shelves;
    if (shelves > 6) {
      EXPECT_EQ(redrawn.drawn_as[i], "shelf 1");
    }
  }
  EXPECT_EQ(shelves, 8);
  ASSERT_OK_AND_ASSIGN(const Design again, AsDrawn(redrawn.assembly));
  EXPECT_EQ(PartsOf(again).size(), redrawn.assembly.parts.size());
}

TEST(DesignTest, PlacesInSpaceAndShiftsAreTheSame) {
  ASSERT_OK_AND_ASSIGN(parametric::Assembly assembly, parametric::ReadShippedAssembly("toy_chest"));
  ASSERT_OK_AND_ASSIGN(Design design, AsDrawn(std::move(assembly)));
  ASSERT_OK_AND_ASSIGN(const auto samples, design.assembly->Sample(1, 3));
  design.q = samples.front();
  design.shift = {1, 2, 3};
  const Design same = FromSpace(design.assembly, InSpace(design));
  EXPECT_LE((same.q - design.q).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LE((same.shift - design.shift).norm(), 1e-9);
  // The lid's hinge goes along.
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly moved, DrawnAt(design));
  design.shift.setZero();
  ASSERT_OK_AND_ASSIGN(const parametric::Assembly unmoved, DrawnAt(design));
  EXPECT_LE((moved.joints[0].center - unmoved.joints[0].center - Eigen::Vector3d(1, 2, 3)).norm(),
            1e-12);
}

TEST(DesignTest, FreeInSpaceEverythingMovesTogether) {
  ASSERT_OK_AND_ASSIGN(parametric::Assembly assembly, parametric::ReadShippedAssembly("toy_chest"));
  ASSERT_OK_AND_ASSIGN(Design design, AsDrawn(std::move(assembly)));
  const parametric::FeasibleSet free = design.assembly->FreeInSpace();
  EXPECT_EQ(free.degrees_of_freedom(), design.assembly->feasible_set().degrees_of_freedom() + 3);
  design.shift = {0.5, -2, 1};
  const Eigen::VectorXd wish = InSpace(design);
  ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd there, free.Nearest(wish));
  EXPECT_LE((there - wish).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace mortise::composer
