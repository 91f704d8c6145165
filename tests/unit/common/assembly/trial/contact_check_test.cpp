// Boxes that touch or not, and designs that hold together or not.
#include "common/assembly/trial/contact_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "common/assembly/parametric_assembly.h"
#include "common/assembly/relations/feasible_set.h"
#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/assembly/model/assemblies.h"

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using Kind = ContactFault::Kind;

constexpr double kTolerance = 1e-6;

// A design with its check.
struct Design {
  explicit Design(Assembly drawing)
      : assembly(std::move(drawing)),
        elements(MakeElements(assembly, kTolerance)),
        drawn(DrawnParameters(assembly, elements)),
        check(assembly, elements) {}

  absl::StatusOr<FeasibleSet> Set(int anchored) const {
    auto relationships = FindRelationships(assembly, elements, TouchingPairs(elements), kTolerance);
    if (anchored >= 0) {
      for (Relationship& held : Anchor(elements, anchored)) {
        relationships.push_back(std::move(held));
      }
    }
    return FeasibleSet::Create(std::move(relationships), drawn,
                               VariablesWithin(assembly, elements, 0));
  }

  std::vector<ContactFault> FaultsAt(const Eigen::VectorXd& q) const {
    return check.FaultsAt(q).value();
  }

  int ElementNamed(const std::string& name) const {
    for (std::size_t e = 0; e < elements.size(); ++e) {
      if (elements[e].name == name) return static_cast<int>(e);
    }
    return -1;
  }

  Assembly assembly;
  std::vector<Element> elements;
  Eigen::VectorXd drawn;
  ContactCheck check;
};

TEST(ContactCheckTest, FeasibleDesignsHoldTogetherInEveryPose) {
  for (const Assembly& assembly : {TwoLeggedTable(), ChestWithLid()}) {
    const Design design(assembly);
    EXPECT_THAT(design.FaultsAt(design.drawn), IsEmpty());
    ASSERT_OK_AND_ASSIGN(const FeasibleSet set, design.Set(0));
    ASSERT_OK_AND_ASSIGN(const auto samples, set.Sample(1000, 3));
    for (const Eigen::VectorXd& q : samples) {
      for (const ContactFault& fault : design.FaultsAt(q)) ADD_FAILURE() << Describe(fault);
    }
  }
}

// Boxes that fill a grid, in a random hierarchy: the hardest drawings to keep apart.
TEST(ContactCheckTest, WhatRandomDesignsAreDraggedToHoldsTogether) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    const Design design(RandomAssembly(seed));
    ASSERT_THAT(design.FaultsAt(design.drawn), IsEmpty());
    ASSERT_OK_AND_ASSIGN(const FeasibleSet set, design.Set(-1));
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 0.1);
    for (int round = 0; round < 20; ++round) {
      Eigen::VectorXd wish = design.drawn;
      for (double& entry : wish) entry += normal(random);
      ASSERT_OK_AND_ASSIGN(const Eigen::VectorXd q, set.Nearest(wish));
      for (const ContactFault& fault : design.FaultsAt(q)) ADD_FAILURE() << Describe(fault);
    }
  }
}

TEST(ContactCheckTest, ALostContactNamesBothParts) {
  const Design table(TwoLeggedTable());
  Eigen::VectorXd q = table.drawn;
  q[CenterVariable(table.ElementNamed("leg 2"), Axis::kZ)] -= 0.01;
  const auto faults = table.FaultsAt(q);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, Kind::kLostContact);
  EXPECT_NEAR(faults[0].amount, 0.01, 1e-9);
  EXPECT_THAT(Describe(faults[0]), HasSubstr("'leg 2'"));
  EXPECT_THAT(Describe(faults[0]), HasSubstr("'top'"));
}

TEST(ContactCheckTest, PenetrationIsToldBeyondItsTolerance) {
  const Design table(TwoLeggedTable());
  const int leg_2 = table.ElementNamed("leg 2");
  const double gap = 0.34 + 0.34;
  Eigen::VectorXd q = table.drawn;
  q[CenterVariable(leg_2, Axis::kX)] -= gap + 5e-5;
  EXPECT_THAT(table.FaultsAt(q), IsEmpty());
  q[CenterVariable(leg_2, Axis::kX)] -= 1e-3;
  const auto faults = table.FaultsAt(q);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, Kind::kPenetration);
  EXPECT_NEAR(faults[0].amount, 1.05e-3, 1e-9);
}

TEST(ContactCheckTest, EveryPartOfAPatternMustKeepWhatAllTouched) {
  const Design chest(ChestWithLid());
  const int shelves = chest.ElementNamed("shelf 1");
  Eigen::VectorXd q = chest.drawn;
  q[SizeVariable(shelves, Axis::kX)] -= 0.004;  // 2 mm too short at either end
  const auto faults = chest.FaultsAt(q);
  // Three shelves, two sides; told once, for the lid's pose moves neither.
  EXPECT_EQ(faults.size(), 6U);
  for (const ContactFault& fault : faults) {
    EXPECT_EQ(fault.kind, Kind::kLostContact);
    EXPECT_NEAR(fault.amount, 0.002, 1e-9);
  }
}

TEST(ContactCheckTest, ARestPoseIsCheckedToo) {
  const Design chest(ChestWithLid());
  Eigen::VectorXd q = chest.drawn;
  // About this centre the open lid falls between the sides' front and back.
  q[JointVariable(chest.elements.size(), 0, Axis::kY)] = 0.4;
  q[JointVariable(chest.elements.size(), 0, Axis::kZ)] = 0.58;
  const auto faults = chest.FaultsAt(q);
  ASSERT_FALSE(faults.empty());
  for (const ContactFault& fault : faults) {
    EXPECT_EQ(fault.kind, Kind::kPenetration);
    EXPECT_EQ(fault.pose, "lid hinge: open");
    EXPECT_THAT(Describe(fault), HasSubstr("in 'lid hinge: open'"));
  }
}

TEST(ContactCheckTest, AFixedSizeThatChangedIsTold) {
  Assembly table = TwoLeggedTable();
  table.parts[1] = FixedPart("leg 1", table.parts[1].box.minimum, table.parts[1].box.maximum);
  const Design design(table);
  Eigen::VectorXd q = design.drawn;
  q[SizeVariable(design.ElementNamed("leg 1"), Axis::kY)] += 0.003;
  const auto faults = design.FaultsAt(q);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].kind, Kind::kChangedSize);
  EXPECT_EQ(faults[0].first, "leg 1");
  EXPECT_NEAR(faults[0].amount, 0.003, 1e-9);
}

TEST(ContactCheckTest, ParametersThatAreNoneAreRefused) {
  const Design table(TwoLeggedTable());
  const auto field = [&](const Eigen::VectorXd& q) {
    return DetailOf(table.check.FaultsAt(q).status()).field;
  };
  EXPECT_EQ(field(Eigen::VectorXd::Ones(17)), "q");
  Eigen::VectorXd q = table.drawn;
  q[0] = std::nan("");
  EXPECT_EQ(field(q), "q");
  q = table.drawn;
  q[SizeVariable(1, Axis::kY)] = 0;
  EXPECT_EQ(field(q), "q");
}

// An angle and a block in its corner, as far from both legs as `gap`, m.
Assembly BlockInAngle(double gap) {
  Assembly corner;
  corner.name = "corner";
  corner.groups = {{"corner", -1}};
  corner.parts = {ResizablePart("angle", {0, 0, 0}, {0.04, 0.04, 0.1}),
                  ResizablePart("block", {0.004 + gap, 0.004 + gap, 0}, {0.03, 0.03, 0.1})};
  corner.parts[0].shape = Angle();
  return corner;
}

TEST(ContactCheckTest, LooksAtTrueSurfacesWhereBoxesOverlap) {
  const Design touching(BlockInAngle(0));
  EXPECT_THAT(touching.FaultsAt(touching.drawn), IsEmpty()) << "solids that touch do not penetrate";
  Eigen::VectorXd moved = touching.drawn;
  moved(CenterVariable(1, Axis::kX)) += 0.002;
  moved(CenterVariable(1, Axis::kY)) += 0.002;
  std::vector<ContactFault> faults = touching.FaultsAt(moved);
  ASSERT_EQ(faults.size(), 1u) << "though it is in the angle's box";
  EXPECT_EQ(faults[0].kind, Kind::kLostContact);
  EXPECT_NEAR(faults[0].amount, 0.002, 1e-9);

  const Design apart(BlockInAngle(0.003));
  EXPECT_THAT(apart.FaultsAt(apart.drawn), IsEmpty());
  moved = apart.drawn;
  moved(CenterVariable(1, Axis::kX)) -= 0.005;
  faults = apart.FaultsAt(moved);
  ASSERT_EQ(faults.size(), 1u);
  EXPECT_EQ(faults[0].kind, Kind::kPenetration);
  EXPECT_NEAR(faults[0].amount, 0.002, 1e-9);
  moved = apart.drawn;
  moved(CenterVariable(1, Axis::kX)) -= 0.00305;
  EXPECT_THAT(apart.FaultsAt(moved), IsEmpty()) << "less than counts";
}

TEST(ContactCheckTest, ContactsAreThoseOfTrueSurfaces) {
  const auto contacts_of = [](const Assembly& assembly) {
    const std::vector<Element> elements = MakeElements(assembly, kTolerance);
    return FindContacts(assembly, elements, kTolerance).value().size();
  };
  EXPECT_EQ(contacts_of(BlockInAngle(0)), 1u);
  EXPECT_EQ(contacts_of(BlockInAngle(0.003)), 0u);
  Assembly boxes = BlockInAngle(0.003);
  boxes.parts[0].shape = nullptr;
  EXPECT_EQ(contacts_of(boxes), 1u) << "without a shape it is in the box";
  // What the triangles may miss of a curved face is no gap.
  Assembly curved = BlockInAngle(0.0001);
  auto rough = *curved.parts[0].shape;
  rough.deflection = 0.0002;
  curved.parts[0].shape = std::make_shared<const mesh::DrawnShape>(std::move(rough));
  EXPECT_EQ(contacts_of(curved), 1u);
}

}  // namespace
}  // namespace mortise::parametric
