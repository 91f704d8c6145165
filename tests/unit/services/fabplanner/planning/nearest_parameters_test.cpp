#include "services/fabplanner/planning/nearest_parameters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "services/fabplanner/planning/part_making.h"
#include "tests/unit/services/fabplanner/example_table.h"
#include "tests/unit/services/fabplanner/sloped_part.h"

namespace mortise::fabplanner {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr double kOneDegree = M_PI / 180;

// A rail mitred at both ends.
std::vector<PlannedPart> RailAt(double mitre, const std::string& name = "rail") {
  Design design;
  design.parts = {SlopedLumber(name, "items/apron-20", {0.9, 0.09, 0.02},
                               {SlopeOf(mitre, 0), SlopeOf(-mitre, 0)}, 0, 1)};
  const auto planned = PlanParts(design, ExampleItems());
  EXPECT_TRUE(planned.ok()) << planned.status();
  return planned.ok() ? *planned : std::vector<PlannedPart>{};
}

FabricationPlan PlanAt(double mitre) {
  FabricationPlan plan;
  plan.parts = RailAt(mitre);
  return plan;
}

TEST(NearestParametersTest, ValueAtTheLimitIsFoundAlongEachParameterThatChangesIt) {
  // "lean" is the mitre, "width" changes it, too, "height" does not.
  const std::vector<DesignParameter> parameters = {{"lean", "rad", -1.2, 1.2, 0.001, 1.1},
                                                   {"width", "m", 0.2, 1.0, 0, 0.25},
                                                   {"height", "m", 0.2, 1.0, 0.001, 0.5}};
  int designs = 0;
  const PartsAt parts_at = [&](std::size_t parameter, double value) {
    ++designs;
    const double mitres[] = {value, 1.1 * 0.25 / value, 1.1};
    return RailAt(mitres[parameter]);
  };
  FabricationPlan plan = PlanAt(1.1);
  ASSERT_EQ(plan.parts[0].beyond_machines.size(), 2);
  ASSERT_TRUE(AddNearestParameters(parameters, parts_at, &plan).ok());
  for (const MachineLimit& limit : plan.parts[0].beyond_machines) {
    ASSERT_EQ(limit.nearest_parameters.size(), 2);
    EXPECT_EQ(limit.nearest_parameters[0].first, "lean");
    EXPECT_NEAR(limit.nearest_parameters[0].second, 0.872, 1e-9);  // below 50°, in steps
    EXPECT_EQ(limit.nearest_parameters[1].first, "width");
    EXPECT_NEAR(limit.nearest_parameters[1].second, 1.1 * 0.25 / (50 * kOneDegree), 1e-3);
    EXPECT_GE(limit.nearest_parameters[1].second, 1.1 * 0.25 / (50 * kOneDegree));
    EXPECT_THAT(limit.reason, HasSubstr("it is made by machine with lean = 0.872 rad (50°), or "
                                        "width = 315."));
  }
  EXPECT_THAT(plan.handwork,
              ElementsAre(HasSubstr("rail: its end towards -x is made by machine with lean"),
                          HasSubstr("rail: its end towards +x is made by machine with lean")));
  EXPECT_LT(designs, 80);  // both ends share what was looked at

  FabricationPlan again = PlanAt(1.1);
  ASSERT_TRUE(AddNearestParameters(parameters, parts_at, &again).ok());
  EXPECT_EQ(again.handwork, plan.handwork);
}

TEST(NearestParametersTest, OfValuesAtBothSidesTheNearerIsTold) {
  // Made below 0.3 and above 0.6; the design is at 0.5.
  const PartsAt parts_at = [](std::size_t, double value) {
    return RailAt(value < 0.3 || value > 0.6 ? 0.5 : 1.1);
  };
  FabricationPlan plan = PlanAt(1.1);
  ASSERT_TRUE(AddNearestParameters({{"twist", "1", 0, 1, 0.01, 0.5}}, parts_at, &plan).ok());
  EXPECT_THAT(plan.parts[0].beyond_machines[0].nearest_parameters,
              ElementsAre(Pair("twist", ::testing::DoubleNear(0.61, 1e-9))));
}

TEST(NearestParametersTest, ChoicesAreTriedOneByOne) {
  const std::set<double> whole = {0, 1, 2};
  const PartsAt parts_at = [&](std::size_t, double value) {
    EXPECT_TRUE(whole.contains(value)) << value;
    return RailAt(value == 2 ? 0.5 : 1.1);
  };
  FabricationPlan plan = PlanAt(1.1);
  ASSERT_TRUE(AddNearestParameters({{"style", "1", 0, 2, 1, 0, {"steep", "steeper", "flat"}}},
                                   parts_at, &plan)
                  .ok());
  EXPECT_THAT(plan.parts[0].beyond_machines[0].nearest_parameters, ElementsAre(Pair("style", 2)));
  EXPECT_THAT(plan.parts[0].beyond_machines[0].reason, HasSubstr("style = flat"));
}

TEST(NearestParametersTest, NothingIsToldWhereNothingHelps) {
  const std::vector<DesignParameter> parameters = {{"lean", "rad", -1.2, 1.2, 0.001, 1.1},
                                                   {"fixed", "m", 0.2, 0.2, 0, 0.2}};
  const auto untold = [&](const PartsAt& parts_at) {
    FabricationPlan plan = PlanAt(1.1);
    const std::string reason = plan.parts[0].beyond_machines[0].reason;
    ASSERT_TRUE(AddNearestParameters(parameters, parts_at, &plan).ok());
    EXPECT_THAT(plan.handwork, IsEmpty());
    EXPECT_THAT(plan.parts[0].beyond_machines[0].nearest_parameters, IsEmpty());
    EXPECT_EQ(plan.parts[0].beyond_machines[0].reason, reason);
  };
  untold([](std::size_t, double) { return RailAt(1.1); });
  untold([](std::size_t, double) { return std::nullopt; });                 // no such designs
  untold([](std::size_t, double) { return RailAt(0.5, "another part"); });  // the part is absent
  FabricationPlan made = PlanAt(0.5);                                       // nothing to look for
  const PartsAt never = [](std::size_t, double) -> std::optional<std::vector<PlannedPart>> {
    ADD_FAILURE() << "no design needs to be looked at";
    return std::nullopt;
  };
  EXPECT_TRUE(AddNearestParameters(parameters, never, &made).ok());
}

TEST(NearestParametersTest, NoMoreDesignsAreLookedAtThanAllowed) {
  std::vector<DesignParameter> parameters;
  for (int i = 0; i < 100; ++i) parameters.push_back({"p", "m", 0, 1, 0.001, 0.5});
  int designs = 0;
  FabricationPlan plan = PlanAt(1.1);
  const PartsAt parts_at = [&](std::size_t, double) {
    ++designs;
    return RailAt(1.1);
  };
  EXPECT_TRUE(AddNearestParameters(parameters, parts_at, &plan).ok());
  EXPECT_EQ(designs, kMostDesigns);
}

TEST(NearestParametersTest, ValuesAreThoseThatDesignsAreRoundedTo) {
  // Multiples of the step, though the least value is none.
  const PartsAt parts_at = [](std::size_t, double value) {
    EXPECT_NEAR(std::remainder(value, 0.01), 0, 1e-9) << value;
    return RailAt(value > 0.255 ? 0.5 : 1.1);
  };
  FabricationPlan plan = PlanAt(1.1);
  ASSERT_TRUE(
      AddNearestParameters({{"width", "m", 0.015, 0.515, 0.01, 0.1}}, parts_at, &plan).ok());
  EXPECT_THAT(plan.parts[0].beyond_machines[0].nearest_parameters,
              ElementsAre(Pair("width", ::testing::DoubleNear(0.26, 1e-9))));
}

TEST(NearestParametersTest, OneLimitInPlaceOfAnotherIsNoCure) {
  const PartsAt parts_at = [](std::size_t, double) {
    std::vector<PlannedPart> parts = RailAt(1.1);
    for (MachineLimit& limit : parts[0].beyond_machines) limit.kind = MachineLimit::Kind::kBevel;
    return parts;
  };
  FabricationPlan plan = PlanAt(1.1);
  ASSERT_TRUE(AddNearestParameters({{"lean", "rad", -1.2, 1.2, 0.001, 1.1}}, parts_at, &plan).ok());
  EXPECT_THAT(plan.parts[0].beyond_machines[0].nearest_parameters, IsEmpty());
}

TEST(NearestParametersTest, SharpCornersAreLookedAtTheEndsAlone) {
  FabricationPlan plan = PlanAt(1.1);
  for (MachineLimit& limit : plan.parts[0].beyond_machines) {
    limit.kind = MachineLimit::Kind::kRadius;
    limit.value = 0;
  }
  int designs = 0;
  const PartsAt parts_at = [&](std::size_t, double) {
    ++designs;
    return plan.parts;
  };
  FabricationPlan told = plan;
  ASSERT_TRUE(AddNearestParameters({{"width", "m", 0, 1, 0.001, 0.5}}, parts_at, &told).ok());
  EXPECT_EQ(designs, 2);
  EXPECT_THAT(told.handwork, IsEmpty());
}

TEST(NearestParametersTest, EndsWhereDesignsCannotBeLookedAt) {
  int designs = 0;
  const PartsAt parts_at = [&](std::size_t,
                               double) -> absl::StatusOr<std::optional<std::vector<PlannedPart>>> {
    ++designs;
    return absl::UnavailableError("the catalog is away");
  };
  FabricationPlan plan = PlanAt(1.1);
  EXPECT_TRUE(absl::IsUnavailable(
      AddNearestParameters({{"width", "m", 0, 1, 0.001, 0.5}}, parts_at, &plan)));
  EXPECT_EQ(designs, 1);
}

}  // namespace
}  // namespace mortise::fabplanner
