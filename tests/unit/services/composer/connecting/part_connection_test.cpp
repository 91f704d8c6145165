// Connections part by part, of the designs that ship.
#include "services/composer/connecting/part_connection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "common/assembly/connections/connection_optimizer.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using ::testing::ElementsAre;
using ::testing::UnorderedElementsAre;

std::vector<std::string> ConnectingOf(const CollectionConnection& one) {
  std::vector<std::string> names;
  for (std::size_t i = static_cast<std::size_t>(one.connection.principal_count());
       i < one.connection.elements.size(); ++i) {
    for (const int part : one.connection.elements[i].parts) {
      names.push_back(one.connection.assembly.parts[static_cast<std::size_t>(part)].name);
    }
  }
  return names;
}

const CollectionConnection* Between(const std::string& id,
                                    const std::vector<std::string>& principals) {
  for (const CollectionConnection& one : ShippedConnections(id)) {
    if (one.Principals() == principals) return &one;
  }
  return nullptr;
}

// Six shelves are one element; their screws are those of each.
TEST(PartConnectionTest, ThePartsOfARowHaveTheirOwn) {
  const CollectionConnection* const third = Between("bookshelf", {"side 1", "shelf 3"});
  ASSERT_NE(third, nullptr);
  EXPECT_THAT(ConnectingOf(*third), UnorderedElementsAre("screw left 1.3", "screw left 2.3"));
  EXPECT_EQ(third->source, "assemblies/bookshelf");
}

TEST(PartConnectionTest, WhatOnlyTouchesIsAConnectionWithoutParts) {
  const CollectionConnection* const behind = Between("bookshelf", {"shelf 3", "back"});
  ASSERT_NE(behind, nullptr);
  EXPECT_TRUE(behind->connection.connecting.empty());
}

class EveryPartConnectionTest : public ::testing::TestWithParam<std::string> {};

// Every connecting part that touches a principal one is in one connection, and as drawn each
// connection is as drawn.
TEST_P(EveryPartConnectionTest, IsAsDrawnForItsPrincipalsAsDrawn) {
  std::multiset<std::string> connecting;
  for (const CollectionConnection& one : ShippedConnections(GetParam())) {
    for (const std::string& name : ConnectingOf(one)) connecting.insert(name);
    const parametric::ConnectionOptimizer optimizer(one.connection);
    std::vector<parametric::BoundingBox> boxes;
    for (int i = 0; i < one.connection.principal_count(); ++i) {
      ASSERT_EQ(one.connection.elements[static_cast<std::size_t>(i)].parts.size(), 1U);
      boxes.push_back(one.connection.elements[static_cast<std::size_t>(i)].box);
    }
    ASSERT_OK_AND_ASSIGN(const parametric::OptimizedConnection placed, optimizer.Optimize(boxes));
    for (std::size_t i = 0; i < placed.connecting.size(); ++i) {
      const parametric::BoundingBox& drawn = one.connection.elements[boxes.size() + i].box;
      EXPECT_LE((placed.connecting[i].minimum - drawn.minimum).norm(), 1e-7) << one.connection.name;
      EXPECT_LE((placed.connecting[i].maximum - drawn.maximum).norm(), 1e-7) << one.connection.name;
    }
  }
  for (const parametric::AssemblyPart& part :
       ShippedDesign(GetParam()).assembly->assembly().parts) {
    EXPECT_LE(connecting.count(part.name), part.connecting ? 1U : 0U) << part.name;
  }
}

INSTANTIATE_TEST_SUITE_P(Collection, EveryPartConnectionTest,
                         ::testing::ValuesIn(parametric::ShippedAssemblyIds()),
                         [](const auto& shipped) { return shipped.param; });

// Behind the right slide of the drawer the handle's cheek is screwed on.
TEST(PartConnectionTest, WithoutSomePrincipalsTheRestIsLeft) {
  const auto& all = ShippedConnections("tool_cart");
  const auto slide = std::find_if(all.begin(), all.end(), [](const auto& one) {
    const std::vector<std::string> parts = ConnectingOf(one);
    return std::find(parts.begin(), parts.end(), "slide 2") != parts.end();
  });
  ASSERT_NE(slide, all.end());
  EXPECT_THAT(slide->Principals(), ::testing::Contains("cheek 1"));
  ASSERT_OK_AND_ASSIGN(
      const std::vector<CollectionConnection> left,
      ConnectionsAmong(*slide, {"upright 2.1", "upright 2.2", "drawer front", "drawer side 2"}));
  const auto with_slide = std::find_if(left.begin(), left.end(), [](const auto& one) {
    const std::vector<std::string> parts = ConnectingOf(one);
    return std::find(parts.begin(), parts.end(), "slide 2") != parts.end();
  });
  ASSERT_NE(with_slide, left.end());
  EXPECT_THAT(with_slide->Principals(), ::testing::Contains("drawer side 2"));
  for (const CollectionConnection& one : left) {
    for (const std::string& name : ConnectingOf(one)) {
      EXPECT_FALSE(name.starts_with("cheek")) << name;
    }
  }
}

}  // namespace
}  // namespace mortise::composer
