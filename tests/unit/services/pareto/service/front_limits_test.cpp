// Limits of fronts and of discoveries: single values, narrow ranges, and numbers as they are
// printed.
#include "services/pareto/service/front_limits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "common/base/errors.h"
#include "services/pareto/service/discovery_constraints.h"
#include "services/pareto/service/front_queries.h"
#include "services/pareto/service/number_text.h"

namespace mortise::pareto {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

// Eleven points: mass 10 to 20 kg, cost the other way round; "width" as mass, "ribs" 1 to 3.
OpenFront Eleven() {
  v1::Front front;
  front.add_parameter_names("width");
  front.add_parameter_names("ribs");
  front.add_metric_names("mass");
  front.add_metric_names("cost");
  front.add_metric_units("kg");
  front.add_metric_units("EUR");
  for (int i = 0; i <= 10; ++i) {
    v1::FrontPoint& point = *front.add_points();
    point.add_parameters(0.1 * i);
    point.add_parameters(1 + i / 5);
    point.add_metrics(10 + i + 1e-9);
    point.add_metrics(20 - i);
    point.add_embedding(1 - 0.1 * i);
  }
  return OpenFront(front);
}

v1::RestrictFrontResponse Restricted(const std::string& name, std::optional<double> minimum,
                                     std::optional<double> maximum) {
  v1::RestrictFrontRequest request;
  v1::FrontLimit& limit = *request.add_limits();
  limit.set_name(name);
  if (minimum) limit.set_minimum(*minimum);
  if (maximum) limit.set_maximum(*maximum);
  return *Restrict(Eleven(), request);
}

TEST(TextBesideTest, TellsNumbersApart) {
  EXPECT_EQ(TextBeside(2.5, 2.5), "2.5");
  EXPECT_EQ(TextBeside(2.5, 3), "2.5");
  EXPECT_EQ(TextBeside(2.5, 2.4999999), "2.5");
  EXPECT_EQ(TextBeside(2.4999999, 2.5), "2.4999999");
  const double next = std::nextafter(2.5, 3);
  EXPECT_NE(TextBeside(next, 2.5), TextBeside(2.5, next));
  EXPECT_EQ(TextBeside(-1e300, 0), "-1e+300");
}

TEST(FrontLimitsTest, ASingleValueOfAMetricIsABandThatIsStated) {
  const v1::RestrictFrontResponse response = Restricted("mass", 15, 15);
  EXPECT_THAT(response.points(), ElementsAre(5));
  ASSERT_EQ(response.limits_size(), 1);
  EXPECT_EQ(response.limits(0).name(), "mass");
  EXPECT_NEAR(response.limits(0).minimum(), 14.95, 1e-12);
  EXPECT_NEAR(response.limits(0).maximum(), 15.05, 1e-12);
  EXPECT_THAT(response.remarks(), ElementsAre(AllOf(HasSubstr("'mass'"), HasSubstr("15 kg"),
                                                    HasSubstr("14.95"), HasSubstr("15.05"))));
  // Where it meets nothing all the same, the nearest are named.
  const v1::RestrictFrontResponse none = Restricted("mass", 15.5, 15.5);
  EXPECT_TRUE(none.points().empty());
  ASSERT_EQ(none.remarks_size(), 2);
  EXPECT_THAT(none.remarks(1), AllOf(HasSubstr("'mass'"), HasSubstr("15 kg, below 15.45"),
                                     HasSubstr("16 kg, above 15.55")));
}

TEST(FrontLimitsTest, ASingleValueThatSeveralPointsHaveIsKeptToAsItIs) {
  const v1::RestrictFrontResponse response = Restricted("ribs", 2, 2);
  EXPECT_THAT(response.points(), ElementsAre(5, 6, 7, 8, 9));
  EXPECT_EQ(response.limits(0).minimum(), 2);
  EXPECT_EQ(response.limits(0).maximum(), 2);
  EXPECT_TRUE(response.remarks().empty());
  EXPECT_THAT(Restricted("ribs", 3, 3).points(), ElementsAre(10)) << "no band reaches another";
  EXPECT_THAT(Restricted("width", 0.5001, 0.5001).points(), ElementsAre(5));
}

TEST(FrontLimitsTest, WhatIsRefusedNeverLooksAsIfItMetItsLimit) {
  // The least is 10.000000001.
  const v1::RestrictFrontResponse none = Restricted("mass", {}, 10);
  EXPECT_TRUE(none.points().empty());
  EXPECT_THAT(none.remarks(), ElementsAre(HasSubstr("the nearest has 10.000000001 kg, above 10")));
  EXPECT_THAT(Restricted("cost", {}, 10).points(), ElementsAre(10)) << "up to the end";
  EXPECT_THAT(Restricted("cost", 20, {}).points(), ElementsAre(0));
  v1::RestrictFrontRequest both;
  for (const char* name : {"mass", "cost"}) {
    both.add_limits()->set_name(name);
    both.mutable_limits(both.limits_size() - 1)->set_maximum(12);
  }
  const auto apart = Restrict(Eleven(), both);
  EXPECT_THAT(apart->remarks(), ElementsAre(HasSubstr("each limit by itself")));
}

v1::DiscoverySpecification Limited(std::optional<double> minimum, std::optional<double> maximum) {
  v1::DiscoverySpecification specification;
  auto& constraint = *specification.add_constraints();
  constraint.set_metric("mass");
  if (minimum) constraint.set_minimum(*minimum);
  if (maximum) constraint.set_maximum(*maximum);
  return specification;
}

TEST(DiscoveryConstraintsTest, LimitsThatAreMetByChanceOnlyAreRefusedWithTheLeastDistance) {
  for (const auto& [minimum, maximum] : std::vector<std::pair<double, double>>{
           {0, 0}, {2.5, 2.5000001}, {-1e9, -1e9 + 1}, {-0.0, 0.0}}) {
    const absl::Status refused = CheckConstraints(Limited(minimum, maximum));
    EXPECT_TRUE(absl::IsInvalidArgument(refused)) << minimum;
    EXPECT_EQ(DetailOf(refused).field, "specification.constraints[0].maximum");
    EXPECT_THAT(std::string(refused.message()), HasSubstr("by chance only"));
  }
  const std::string narrow(CheckConstraints(Limited(2.5, 2.5000001)).message());
  EXPECT_THAT(narrow, AllOf(HasSubstr("2.5000001 "), HasSubstr("minimum 2.5 "),
                            HasSubstr("at least 2.5e-06")));
  for (const auto& [minimum, maximum] : std::vector<std::pair<double, double>>{
           {2.5, 2.5}, {-1, -1}, {0, 1e-12}, {-1e-9, 1e-9}, {2.5, 2.50001}}) {
    EXPECT_TRUE(CheckConstraints(Limited(minimum, maximum)).ok()) << minimum;
  }
  EXPECT_TRUE(CheckConstraints(Limited(0, {})).ok());
}

TEST(DiscoveryConstraintsTest, ASingleValueIsABandThatIsStated) {
  for (const double value : {2.5, -2.5}) {
    Constraint constraint{.metric = "mass", .unit = "kg", .minimum = value, .maximum = value};
    constraint.WidenSingleValue();
    EXPECT_NEAR(*constraint.maximum - *constraint.minimum, 0.0025, 1e-12);
    EXPECT_NEAR(0.5 * (*constraint.maximum + *constraint.minimum), value, 1e-12);
    EXPECT_THAT(BandRemarks({constraint}),
                ElementsAre(AllOf(HasSubstr("'mass' was to be"), HasSubstr("2.5 kg"),
                                  HasSubstr("2.49875"), HasSubstr("2.50125"))));
  }
  Constraint range{.metric = "mass", .unit = "kg", .minimum = 2, .maximum = 3};
  range.WidenSingleValue();
  EXPECT_EQ(range.minimum, 2);
  EXPECT_TRUE(BandRemarks({range}).empty());
}

TEST(DiscoveryConstraintsTest, WhatIsMissedIsPrintedApartFromItsLimitAndOnItsSide) {
  const Constraint constraint{.metric = "mass", .unit = "kg", .minimum = 2, .maximum = 2.5};
  const auto missed = [&](double value, double deviations = 0) {
    std::vector<double> rows;
    constraint.AppendTo(value, rows);
    const Eigen::VectorXd robust = Eigen::Vector2d(rows[0], rows[1]).array() + deviations;
    return constraint.Missed(robust);
  };
  EXPECT_TRUE(missed(2.2).empty());
  EXPECT_THAT(missed(2.5000000001), ElementsAre("mass is 2.5000000001 kg, not at most 2.5"));
  EXPECT_THAT(missed(1.999999999), ElementsAre("mass is 1.999999999 kg, not at least 2"));
  EXPECT_THAT(missed(std::nextafter(2.5, 3)), ElementsAre(testing::Not(HasSubstr("2.5 kg"))));
  // With deviations a mean of 2.2 may be too little, of 2.25 either.
  EXPECT_THAT(missed(2.2, 0.25), ElementsAre("mass is 1.95 kg, not at least 2"));
  EXPECT_THAT(missed(2.25, 0.3),
              ElementsAre("mass is 2.55 kg, not at most 2.5", "mass is 1.95 kg, not at least 2"));
}

}  // namespace
}  // namespace mortise::pareto
