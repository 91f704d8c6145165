// Components of all designs that ship, dropped anywhere onto all others: each is refused with a
// reason, or what comes out can be built.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "services/composer/connecting/connect.h"
#include "services/composer/model/overlap.h"
#include "services/composer/snapping/snap.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::AssemblyPart;
using parametric::BoundingBox;
using ::testing::AnyOf;
using ::testing::IsEmpty;

using Node = std::pair<std::string, std::string>;  // a design that ships, and a node of it

std::vector<Node> AllNodes() {
  std::vector<Node> nodes;
  for (const std::string& id : parametric::ShippedAssemblyIds()) {
    const parametric::ParametricAssembly& design = *ShippedDesign(id).assembly;
    for (const std::string& group : parametric::DistinctSubTrees(design.assembly())) {
      nodes.emplace_back(id, group);
    }
    for (const parametric::Element& element : design.elements()) {
      if (!element.connecting) nodes.emplace_back(id, element.name);
    }
  }
  return nodes;
}

double Apart(const BoundingBox& a, const BoundingBox& b) {
  return (a.minimum - b.maximum).cwiseMax(b.minimum - a.maximum).maxCoeff();
}

const AssemblyPart& PartOf(const parametric::Assembly& assembly, const std::string& name) {
  for (const AssemblyPart& part : assembly.parts) {
    if (part.name == name) return part;
  }
  ADD_FAILURE() << "there is no part " << name;
  return assembly.parts.front();
}

// New connecting parts touch what they connect, and run into nothing else.
void ExpectHolds(const Connected& made) {
  const parametric::Assembly& assembly = made.model.assembly->assembly();
  for (const MadeConnection& connection : made.connections) {
    std::set<std::string> own(connection.principals.begin(), connection.principals.end());
    own.insert(connection.parts.begin(), connection.parts.end());
    for (const std::string& name : connection.parts) {
      const AssemblyPart& part = PartOf(assembly, name);
      bool touches = false;
      for (const AssemblyPart& other : assembly.parts) {
        if (other.name == name) continue;
        if (own.contains(other.name)) {
          touches |= Apart(part.box, other.box) <= 1e-6;
        } else {
          EXPECT_EQ(SolidPart::DepthOf(SolidPart(part), SolidPart(other)), 0)
              << name << " and " << other.name;
        }
      }
      EXPECT_TRUE(touches) << name << " hangs in the air";
    }
  }
}

void ExpectCanBeChanged(const Design& model) {
  EXPECT_THAT(model.assembly->feasible_set().Violations(model.q, 1e-6), IsEmpty());
  ASSERT_OK_AND_ASSIGN(const auto samples, model.assembly->Sample(2, 3));
  for (const Eigen::VectorXd& q : samples) {
    ASSERT_OK_AND_ASSIGN(const auto faults, model.assembly->FaultsAt(q));
    for (const auto& fault : faults) ADD_FAILURE() << parametric::Describe(fault);
  }
}

// Drops the component onto, below or beside a random part, about a centimetre off.
Design Dropped(const Design& component, const Design& body, std::mt19937_64& random) {
  const std::vector<parametric::PlacedPart> parts = PartsOf(body);
  const BoundingBox& target = parts[random() % parts.size()].box;
  const auto axis = static_cast<Eigen::Index>(random() % 3);
  const double side = random() % 2 == 0 ? 1 : -1;
  const double off = 0.01 * (static_cast<double>(random() % 100) / 50 - 1);
  Eigen::Vector3d middle = target.center();
  middle[axis] += side * (target.size()[axis] + BoundsOf(component).size()[axis]) / 2 + off;
  return DroppedAt(component, middle);
}

TEST(RandomCompositionsTest, AreRefusedOrCanBeBuilt) {
  const std::vector<Node> nodes = AllNodes();
  const std::vector<std::string> ids = parametric::ShippedAssemblyIds();
  const std::vector<const CollectionConnection*> all = AllShippedConnections();
  const ConnectOptions options = ShippedOptions();
  std::mt19937_64 random(29);
  int made_count = 0, held_count = 0;
  for (int drop = 0; drop < 120; ++drop) {
    const auto& [id, node] = nodes[random() % nodes.size()];
    const Design& body = ShippedDesign(ids[random() % ids.size()]);
    SCOPED_TRACE(node + " of " + id + " on " + body.assembly->assembly().name);
    ASSERT_OK_AND_ASSIGN(parametric::Assembly part_of,
                         parametric::SubTreeOf(ShippedDesign(id).assembly->assembly(), node));
    ASSERT_OK_AND_ASSIGN(const Design component, AsDrawn(std::move(part_of)));
    const Original original = ShippedOriginal(id);
    ASSERT_OK_AND_ASSIGN(const Snapped snapped,
                         Snap(Dropped(component, body, random), &original.design, body));
    const absl::StatusOr<Connected> made =
        Connect(body, snapped.component, "new", &original, all, options);
    if (!made.ok()) {
      EXPECT_THAT(DetailOf(made.status()).reason,
                  AnyOf("NOTHING_NEAR", "NOTHING_HOLDS", "COMPONENT_OVERLAPS"));
      continue;
    }
    ++made_count;
    for (const MadeConnection& one : made->connections) held_count += one.parts.empty() ? 0 : 1;
    ExpectHolds(*made);
    ExpectCanBeChanged(made->model);
  }
  EXPECT_GT(made_count, 10);
  EXPECT_GT(held_count, 10);
}

}  // namespace
}  // namespace mortise::composer
