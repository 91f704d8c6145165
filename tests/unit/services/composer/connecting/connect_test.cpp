// Components of designs that ship, connected to others: what comes out can be built.
#include "services/composer/connecting/connect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "services/composer/model/overlap.h"
#include "services/composer/model/removal.h"
#include "services/composer/snapping/snap.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::AssemblyPart;
using parametric::BoundingBox;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::IsSupersetOf;

struct Composition {
  std::string name, body, body_node, from, node;
  Eigen::Vector3d middle;  // m, of the component, where it is dropped
};

// What people would make of what ships.
const std::vector<Composition>& Compositions() {
  static const auto* const all = new std::vector<Composition>{
      {"ShelfInCabinet", "cabinet", "case", "bookshelf", "shelf 3", {0.5, 0.2, 0.2}},
      {"DrawerInCart", "tool_cart", "frame", "tool_cart", "drawer", {0.36, 0.22, 0.715}},
      {"TableTopOnWorkbench", "workbench", "frame", "dining_table", "top", {0.8, 0.36, 0.85}},
      {"WorkbenchTopOnTable", "dining_table", "frame", "workbench", "top", {0.8, 0.45, 0.75}},
      {"DoorOnCabinet", "cabinet", "case", "cabinet", "left door", {0.26, -0.02, 0.31}},
      {"SeatOnWorkbench", "workbench", "frame", "garden_bench", "seat", {0.8, 0.36, 0.85}},
      {"SeatOnItsFrame", "garden_bench", "frame", "garden_bench", "seat", {0.74, 0.22, 0.44}}};
  return *all;
}

absl::StatusOr<Connected> Compose(const Composition& of) {
  const Design body = ShippedComponent(of.body, of.body_node);
  const Design dropped = DroppedAt(ShippedComponent(of.from, of.node), of.middle);
  const Original original = ShippedOriginal(of.from);
  MORTISE_ASSIGN_OR_RETURN(const Snapped snapped, Snap(dropped, &original.design, body));
  return Connect(body, snapped.component, "new", &original, AllShippedConnections(),
                 ShippedOptions());
}

// Pairs of parts that reach into each other, but for those of which one connects and those that do
// so in the designs they come from.
std::vector<std::string> Overlaps(const Connected& made) {
  const Assembly& assembly = made.model.assembly->assembly();
  std::vector<std::string> found;
  for (std::size_t i = 0; i < assembly.parts.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      const AssemblyPart& a = assembly.parts[i];
      const AssemblyPart& b = assembly.parts[j];
      if (a.connecting || b.connecting || made.parts[i].from == made.parts[j].from) continue;
      if (SolidPart::DepthOf(SolidPart(a), SolidPart(b)) > 0)
        found.push_back(a.name + " " + b.name);
    }
  }
  return found;
}

// New connecting parts that reach into something that they do not connect.
std::vector<std::string> Clashes(const Connected& made) {
  const Assembly& assembly = made.model.assembly->assembly();
  std::vector<std::string> found;
  for (const MadeConnection& connection : made.connections) {
    const std::set<std::string> own(connection.principals.begin(), connection.principals.end());
    const std::set<std::string> parts(connection.parts.begin(), connection.parts.end());
    for (const AssemblyPart& a : assembly.parts) {
      if (!parts.contains(a.name)) continue;
      for (const AssemblyPart& b : assembly.parts) {
        if (parts.contains(b.name) || own.contains(b.name)) continue;
        if (SolidPart::DepthOf(SolidPart(a), SolidPart(b)) > 0) {
          found.push_back(a.name + " " + b.name);
        }
      }
    }
  }
  return found;
}

// The box of the first part of this name, which must be there.
BoundingBox BoxOfPart(const Assembly& assembly, const std::string& name) {
  for (const AssemblyPart& part : assembly.parts) {
    if (part.name == name) return part.box;
  }
  ADD_FAILURE() << "there is no part " << name;
  return {};
}

double Apart(const BoundingBox& a, const BoundingBox& b) {
  return (a.minimum - b.maximum).cwiseMax(b.minimum - a.maximum).maxCoeff();
}

class CompositionTest : public ::testing::TestWithParam<Composition> {};

TEST_P(CompositionTest, CanBeBuilt) {
  ASSERT_OK_AND_ASSIGN(const Connected made, Compose(GetParam()));
  const parametric::ParametricAssembly& assembly = *made.model.assembly;
  EXPECT_THAT(parametric::ValidateAssembly(assembly.assembly()), IsEmpty());
  EXPECT_THAT(assembly.feasible_set().Violations(made.model.q, 1e-6), IsEmpty());
  EXPECT_THAT(Overlaps(made), IsEmpty());
  EXPECT_THAT(Clashes(made), IsEmpty());
  ASSERT_EQ(made.parts.size(), assembly.assembly().parts.size());
  ASSERT_EQ(made.joints.size(), assembly.assembly().joints.size());
  EXPECT_THAT(made.connections, ::testing::Not(IsEmpty()));
}

// Each connecting part touches what it connects: none hangs in the air.
TEST_P(CompositionTest, ConnectingPartsTouchWhatTheyConnect) {
  ASSERT_OK_AND_ASSIGN(const Connected made, Compose(GetParam()));
  const Assembly& assembly = made.model.assembly->assembly();
  for (const MadeConnection& connection : made.connections) {
    for (const std::string& part : connection.parts) {
      bool touches = false;
      for (const std::string& other : connection.principals) {
        touches |= Apart(BoxOfPart(assembly, part), BoxOfPart(assembly, other)) <= 1e-6;
      }
      for (const std::string& other : connection.parts) {
        touches |=
            other != part && Apart(BoxOfPart(assembly, part), BoxOfPart(assembly, other)) <= 1e-6;
      }
      EXPECT_TRUE(touches) << part;
    }
    if (!connection.parts.empty()) continue;
    ASSERT_EQ(connection.principals.size(), 2U);
    EXPECT_LE(Apart(BoxOfPart(assembly, connection.principals[0]),
                    BoxOfPart(assembly, connection.principals[1])),
              1e-6);
  }
}

// The model goes on as any other design: it can be changed, and stays sound.
TEST_P(CompositionTest, StaysADesignThatCanBeChanged) {
  ASSERT_OK_AND_ASSIGN(const Connected made, Compose(GetParam()));
  const parametric::ParametricAssembly& assembly = *made.model.assembly;
  ASSERT_OK_AND_ASSIGN(const auto samples, assembly.Sample(4, 3));
  for (const Eigen::VectorXd& q : samples) {
    ASSERT_OK_AND_ASSIGN(const auto faults, assembly.FaultsAt(q));
    for (const auto& fault : faults) ADD_FAILURE() << parametric::Describe(fault);
  }
}

TEST_P(CompositionTest, IsTheSameAgain) {
  ASSERT_OK_AND_ASSIGN(const Connected once, Compose(GetParam()));
  ASSERT_OK_AND_ASSIGN(const Connected again, Compose(GetParam()));
  const auto& a = once.model.assembly->assembly().parts;
  const auto& b = again.model.assembly->assembly().parts;
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].box.minimum, b[i].box.minimum);
    EXPECT_EQ(a[i].box.maximum, b[i].box.maximum);
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, CompositionTest, ::testing::ValuesIn(Compositions()),
                         [](const auto& composition) { return composition.param.name; });

std::vector<std::string> PartsBetween(const Connected& made, const std::string& first,
                                      const std::string& second) {
  for (const MadeConnection& connection : made.connections) {
    const auto has = [&](const std::string& name) {
      return std::find(connection.principals.begin(), connection.principals.end(), name) !=
             connection.principals.end();
    };
    if (has(first) && has(second)) return connection.parts;
  }
  ADD_FAILURE() << "nothing connects " << first << " and " << second;
  return {};
}

TEST(ConnectTest, AShelfGetsTheScrewsThatItHadInBothSides) {
  ASSERT_OK_AND_ASSIGN(const Connected made, Compose(Compositions()[0]));
  EXPECT_EQ(PartsBetween(made, "side 1", "shelf 3").size(), 2U);
  EXPECT_EQ(PartsBetween(made, "side 2", "shelf 3").size(), 2U);
  EXPECT_THAT(PartsBetween(made, "back", "shelf 3"), IsEmpty());
  EXPECT_THAT(made.warnings, IsEmpty());
  EXPECT_EQ(made.group, "new");
  // Sides and back are all in the root of what was the case.
  EXPECT_EQ(made.insert_below, made.model.assembly->assembly().groups[0].name);
  const Assembly& assembly = made.model.assembly->assembly();
  for (const std::string& screw : PartsBetween(made, "side 1", "shelf 3")) {
    const BoundingBox box = BoxOfPart(assembly, screw);
    EXPECT_NEAR(box.minimum.x(), 0, 1e-8);  // the head is flush with the side
    EXPECT_NEAR(box.size().x(), 0.04, 1e-9);
    EXPECT_NEAR(box.center().z(), BoxOfPart(assembly, "shelf 3").center().z(), 1e-8);
  }
}

TEST(ConnectTest, ADrawerComesWithItsSlidesAndMovesOnThem) {
  ASSERT_OK_AND_ASSIGN(const Connected made, Compose(Compositions()[1]));
  EXPECT_THAT(PartsBetween(made, "upright 1.1", "drawer side 1"),
              IsSupersetOf({"slide 1", "slide screw left 1", "slide screw left 2",
                            "drawer screw left 1", "drawer screw left 2"}));
  // There the handle is missing whose screws go past the slide.
  EXPECT_THAT(PartsBetween(made, "upright 2.1", "drawer side 2"),
              IsSupersetOf({"slide 2", "slide screw right 1", "slide screw right 2",
                            "drawer screw right 1", "drawer screw right 2"}));
  const Assembly& assembly = made.model.assembly->assembly();
  ASSERT_EQ(assembly.joints.size(), 1U);
  EXPECT_EQ(assembly.joints[0].kind, parametric::JointKind::kPrismatic);
  EXPECT_EQ(assembly.groups[static_cast<std::size_t>(assembly.joints[0].group)].name, made.group);
  EXPECT_EQ(made.joints[0].from, Provenance::From::kConnection);
}

TEST(ConnectTest, ADoorTurnsOnItsHinges) {
  ASSERT_OK_AND_ASSIGN(const Connected made, Compose(Compositions()[4]));
  EXPECT_EQ(PartsBetween(made, "side 1", "left door").size(), 10U);
  const Assembly& assembly = made.model.assembly->assembly();
  ASSERT_EQ(assembly.joints.size(), 1U);
  EXPECT_EQ(assembly.joints[0].kind, parametric::JointKind::kHinge);
  EXPECT_LE(assembly.joints[0].center.head<2>().norm(), 1e-6);
}

// The top of the bench comes with the brackets of tables, whose aprons are of its wood.
TEST(ConnectTest, WhatTheOriginalCannotConnectTheCollectionDoes) {
  ASSERT_OK_AND_ASSIGN(const Connected made, Compose(Compositions()[3]));
  EXPECT_EQ(PartsBetween(made, "long apron 1", "top board").size(), 9U);
  for (const MadeConnection& connection : made.connections) {
    if (!connection.parts.empty()) {
      EXPECT_EQ(connection.source, "assemblies/dining_table");
    }
  }
}

TEST(ConnectTest, WhatNothingHoldsIsWarnedOf) {
  ASSERT_OK_AND_ASSIGN(const Connected made, Compose(Compositions()[2]));
  ASSERT_FALSE(made.warnings.empty());
  EXPECT_EQ(made.warnings[0].first, "upper long rail 1");
  EXPECT_EQ(made.warnings[0].second, "top board");
  EXPECT_THAT(made.warnings[0].text, HasSubstr("nothing holds 'upper long rail 1'"));
}

// A part of the body has the name of the component's already.
TEST(ConnectTest, WarningsNameWhatIsInTheModel) {
  const Composition& of = Compositions()[2];
  ASSERT_OK_AND_ASSIGN(Assembly frame, DrawnAt(ShippedComponent(of.body, of.body_node)));
  const auto lowest = std::min_element(frame.parts.begin(), frame.parts.end(),
                                       [](const AssemblyPart& a, const AssemblyPart& b) {
                                         return std::pair(a.connecting, a.box.maximum.z()) <
                                                std::pair(b.connecting, b.box.maximum.z());
                                       });
  lowest->name = "top board";
  ASSERT_OK_AND_ASSIGN(const Design body, AsDrawn(std::move(frame)));
  const Original original = ShippedOriginal(of.from);
  const Design dropped = DroppedAt(ShippedComponent(of.from, of.node), of.middle);
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &original.design, body));
  ASSERT_OK_AND_ASSIGN(const Connected made, Connect(body, snapped.component, "new", &original,
                                                     AllShippedConnections(), ShippedOptions()));
  ASSERT_FALSE(made.warnings.empty());
  EXPECT_EQ(made.warnings[0].second, "new top board");
}

TEST(ConnectTest, NothingNearIsSaidWithTheNearest) {
  Design far = ShippedComponent("bookshelf", "shelf 3");
  far.shift = {5, 0, 0};
  const Original original = ShippedOriginal("bookshelf");
  const absl::Status refused =
      Connect(ShippedComponent("cabinet", "case"), far, "new", &original, {}, ShippedOptions())
          .status();
  EXPECT_EQ(DetailOf(refused).reason, "NOTHING_NEAR");
  EXPECT_THAT(std::string(refused.message()), HasSubstr("'shelf 3'"));
}

TEST(ConnectTest, WhatHangsInTheAirIsRefused) {
  const Design body = ShippedComponent("cabinet", "case");
  Design above = ShippedComponent("bookshelf", "shelf 3");
  const BoundingBox top = BoxOfPart(body.assembly->assembly(), "top");
  above = DroppedAt(above, {0.5, 0.2, top.maximum.z() + 0.009 + 0.006});
  const absl::Status refused = Connect(body, above, "new", nullptr, {}, ShippedOptions()).status();
  EXPECT_EQ(DetailOf(refused).reason, "NOTHING_HOLDS");
  EXPECT_THAT(std::string(refused.message()), HasSubstr("'top'"));
}

TEST(ConnectTest, WhatReachesIntoTheModelIsRefused) {
  const Design body = ShippedComponent("cabinet", "case");
  const Design in_the_way = DroppedAt(ShippedComponent("bookshelf", "shelf 3"), {0.9, 0.2, 0.2});
  const absl::Status refused =
      Connect(body, in_the_way, "new", nullptr, {}, ShippedOptions()).status();
  EXPECT_EQ(DetailOf(refused).reason, "COMPONENT_OVERLAPS");
}

// A second seat of a go-kart, where floor boards were. The screws of the original have no room
// there; that the seat touches the rails is not taken for a connection instead.
TEST(ConnectTest, WhatOnlyTouchesIsNoAnswerToScrewsThatDoNotFit) {
  ASSERT_OK_AND_ASSIGN(Assembly rest, WithoutNode(ShippedDesign("go_kart"), "floor board"));
  ASSERT_OK_AND_ASSIGN(const Design body, AsDrawn(std::move(rest)));
  const Original original = ShippedOriginal("go_kart");
  ASSERT_OK_AND_ASSIGN(
      const Connected made,
      Connect(body, DroppedAt(ShippedComponent("go_kart", "seat"), {0.79, 0, 0.271}), "new",
              &original, AllShippedConnections(), ShippedOptions()));
  for (const char* const rail : {"rail 1", "rail 2"}) {
    const bool is_held = std::any_of(made.connections.begin(), made.connections.end(),
                                     [&](const MadeConnection& one) {
                                       return one.principals.front() == rail && !one.parts.empty();
                                     });
    const bool is_warned_of = std::any_of(
        made.warnings.begin(), made.warnings.end(), [&](const ConnectionWarning& warning) {
          const std::pair<std::string, std::string> pair(rail, "new seat");
          return std::pair(warning.first, warning.second) == pair ||
                 std::count(warning.others.begin(), warning.others.end(), pair) > 0;
        });
    EXPECT_NE(is_held, is_warned_of) << rail;
  }
}

// Two shelves of the same design, one after the other.
TEST(ConnectTest, NamesStayDistinct) {
  ASSERT_OK_AND_ASSIGN(const Connected first, Compose(Compositions()[0]));
  const Original original = ShippedOriginal("bookshelf");
  const Design dropped = DroppedAt(ShippedComponent("bookshelf", "shelf 3"), {0.5, 0.2, 0.42});
  ASSERT_OK_AND_ASSIGN(const Snapped snapped, Snap(dropped, &original.design, first.model));
  ASSERT_OK_AND_ASSIGN(const Connected second,
                       Connect(first.model, snapped.component, "upper", &original,
                               AllShippedConnections(), ShippedOptions()));
  EXPECT_THAT(parametric::ValidateAssembly(second.model.assembly->assembly()), IsEmpty());
  EXPECT_EQ(PartsBetween(second, "side 1", "upper shelf 3").size(), 2U);
  EXPECT_EQ(second.group, "upper");
}

}  // namespace
}  // namespace mortise::composer
