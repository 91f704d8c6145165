// What nothing holds when nodes are taken out of designs that ship.
#include "services/composer/holding/unheld_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "services/composer/model/removal.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::UnorderedElementsAre;

absl::StatusOr<Design> Without(const std::string& id, const std::vector<std::string>& nodes) {
  Design design = ShippedDesign(id);
  for (const std::string& node : nodes) {
    MORTISE_ASSIGN_OR_RETURN(parametric::Assembly rest, WithoutNode(design, node));
    MORTISE_ASSIGN_OR_RETURN(design, AsDrawn(std::move(rest)));
  }
  return design;
}

TEST(UnheldPartsTest, ALegIsHeldByEitherOfItsAprons) {
  for (const std::vector<std::string>& nodes :
       {std::vector<std::string>{}, {"long apron 1"}, {"short apron 1"}}) {
    ASSERT_OK_AND_ASSIGN(const Design design, Without("dining_table", nodes));
    ASSERT_OK_AND_ASSIGN(const std::vector<UnheldParts> unheld,
                         FindUnheldParts(design, parametric::ShippedItems()));
    EXPECT_THAT(unheld, IsEmpty());
  }
}

TEST(UnheldPartsTest, ALegWithoutItsApronsIsNot) {
  ASSERT_OK_AND_ASSIGN(const Design design,
                       Without("dining_table", {"long apron 1", "short apron 1"}));
  ASSERT_OK_AND_ASSIGN(const std::vector<UnheldParts> unheld,
                       FindUnheldParts(design, parametric::ShippedItems()));
  ASSERT_THAT(unheld, SizeIs(1));
  EXPECT_THAT(unheld[0].parts, ElementsAre("leg 1.1"));
  EXPECT_FALSE(unheld[0].text.empty());
}

// Its plinth and back are drawn without anything that fastens them.
TEST(UnheldPartsTest, WhatMayBeGluedIsAmongThem) {
  ASSERT_OK_AND_ASSIGN(const std::vector<UnheldParts> unheld,
                       FindUnheldParts(ShippedDesign("bookshelf"), parametric::ShippedItems()));
  std::vector<std::string> parts;
  for (const UnheldParts& one : unheld) {
    parts.insert(parts.end(), one.parts.begin(), one.parts.end());
  }
  EXPECT_THAT(parts, UnorderedElementsAre("plinth", "back"));
}

}  // namespace
}  // namespace mortise::composer
