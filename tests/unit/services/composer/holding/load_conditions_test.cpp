// Supports and loads of models, as templates have them.
#include "services/composer/holding/load_conditions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <string>

#include "common/base/errors.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/services/composer/holding/holding_parts.h"
#include "tests/unit/services/composer/shipped_designs.h"

namespace mortise::composer {
namespace {

using parametric::BoundaryCondition;
using parametric::BoundaryConditionKind;
using parametric::FixedPart;
using ::testing::ElementsAre;

// The force of all conditions of a load case downwards, N.
double LoadOfCase(const std::vector<BoundaryCondition>& conditions, const std::string& load_case) {
  double force = 0;
  for (const BoundaryCondition& each : conditions) {
    if (each.kind != BoundaryConditionKind::kForce || each.load_case != load_case) continue;
    EXPECT_EQ(each.face, "z_max");
    force -= std::strtod(each.components.at(2).c_str(), nullptr);
  }
  return force;
}

TEST(LoadConditionsTest, ATableStandsOnItsLegsAndIsLoadedOnItsTop) {
  ASSERT_OK_AND_ASSIGN(Design table, AsDrawn(parametric::TwoLeggedTable()));
  table.shift = {0, 0, 2};
  ASSERT_OK_AND_ASSIGN(const auto conditions, SupportsAndLoads(table, TestItems()));
  std::set<std::string> held;
  int gravity = 0;
  for (const BoundaryCondition& each : conditions) {
    if (each.kind == BoundaryConditionKind::kGravity) ++gravity;
    if (each.kind != BoundaryConditionKind::kFixed) continue;
    held.insert(each.part);
    EXPECT_EQ(each.face, "z_min");
  }
  EXPECT_THAT(held, ElementsAre("leg 1", "leg 2"));
  EXPECT_EQ(gravity, 1);
  EXPECT_NEAR(LoadOfCase(conditions, "top"), 1000, 1e-5);
}

// Each shelf is a load case, loaded by its area.
TEST(LoadConditionsTest, EachShelfHasALoadCaseOfItsOwn) {
  ASSERT_OK_AND_ASSIGN(const auto conditions,
                       SupportsAndLoads(ShippedDesign("bookshelf"), parametric::ShippedItems()));
  std::set<std::string> load_cases;
  for (const BoundaryCondition& each : conditions) {
    if (!each.load_case.empty()) load_cases.insert(each.load_case);
  }
  EXPECT_GT(load_cases.size(), 3U);
  EXPECT_TRUE(load_cases.contains("shelf_1"));
  EXPECT_GT(LoadOfCase(conditions, "shelf_1"), 100);
}

TEST(LoadConditionsTest, TheSlatsOfASeatShareItsLoad) {
  parametric::Assembly bench =
      parametric::Named("bench", {FixedPart("leg", {0, 0, 0}, {0.4, 0.4, 0.4}),
                                  FixedPart("seat wide", {0, 0, 0.4}, {0.4, 0.2, 0.42}),
                                  FixedPart("seat narrow", {0, 0.2, 0.4}, {0.4, 0.3, 0.42})});
  ASSERT_OK_AND_ASSIGN(const Design design, AsDrawn(bench));
  ASSERT_OK_AND_ASSIGN(const auto conditions, SupportsAndLoads(design, TestItems()));
  EXPECT_NEAR(LoadOfCase(conditions, "seat"), 1300, 1e-5);
  for (const BoundaryCondition& each : conditions) {
    if (each.part != "seat narrow") continue;
    EXPECT_NEAR(std::strtod(each.components.at(2).c_str(), nullptr), -1300 / 3.0, 1e-5);
  }
}

TEST(LoadConditionsTest, WhatBearsNothingHasNoLoads) {
  ASSERT_OK_AND_ASSIGN(
      const Design post,
      AsDrawn(parametric::Named("post", {FixedPart("post", {0, 0, 0}, {0.05, 0.05, 1})})));
  const absl::Status refused = SupportsAndLoads(post, TestItems()).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(refused).reason, "NO_LOADS");
}

}  // namespace
}  // namespace mortise::composer
