// Custom metrics: values, exact gradients, units, and what is said where one is wrong.
#include "common/expressions/metric_expressions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "absl/strings/str_cat.h"
#include "common/design/metric_registry.h"
#include "common/files/metric_codec.h"

namespace mortise::parametric {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

const std::vector<NamedUnit> kParameters{{"length", "m"}, {"angle", "rad"}, {"load", "N"}};
const std::vector<NamedUnit> kDesignMetrics = simulator::UnitsOf(simulator::OfferedMetrics());
const Eigen::Vector3d kAt{2, 0.5, 30};

std::vector<FieldViolation> FindingsOf(const MetricDefinitions& definitions,
                                       const MetricDefinitions& earlier = {}) {
  std::vector<FieldViolation> findings;
  MetricExpressions(definitions, earlier, kParameters, kDesignMetrics, "own", findings);
  return findings;
}

std::vector<FieldViolation> FindingsOf(const std::string& unit, const std::string& expression) {
  return FindingsOf({{{"m0", unit, expression}}, {{"p", "length", "", "0.5"}}});
}

std::string FirstOf(const std::vector<FieldViolation>& findings) {
  return findings.empty() ? "nothing" : absl::StrCat(findings[0].field, ": ", findings[0].message);
}

MetricExpressions Parsed(const MetricDefinitions& definitions) {
  std::vector<FieldViolation> findings;
  MetricExpressions expressions(definitions, {}, kParameters, kDesignMetrics, "own", findings);
  EXPECT_THAT(findings, IsEmpty()) << FirstOf(findings);
  return expressions;
}

// What became a word of the language is refused, but not where a template has it already.
TEST(MetricExpressionsTest, WordsAreNoNamesButInWhatIsStored) {
  for (const std::string word : {"if", "and", "or", "not"}) {
    const MetricDefinitions definitions{{{word, "kg", "mass"}, {"twice", "kg", "2 * " + word}}, {}};
    EXPECT_THAT(FirstOf(FindingsOf(definitions)),
                HasSubstr("own.expressions[0].name: must be 1 to 63 lower-case letters"));
    EXPECT_THAT(FindingsOf({}, definitions), IsEmpty()) << word;
  }
}

// Numbers for metrics and calls that depend on the parameters somehow.
Dual Invented(std::size_t i, const Eigen::VectorXd& q) {
  const double c = 1.5 + static_cast<double>(i);
  return {c + q[0] * q[0] + std::sin(c * q[1]) + 0.1 * q[2],
          Eigen::Vector3d(2 * q[0], c * std::cos(c * q[1]), 0.1)};
}

absl::StatusOr<Dual> ValueOf(const MetricExpressions& expressions, const std::string& name,
                             const Eigen::VectorXd& q) {
  const auto needs = expressions.NeedsOf(std::vector{name});
  std::vector<absl::StatusOr<Dual>> metrics, calls;
  for (std::size_t i = 0; i < needs.metrics.size(); ++i) metrics.push_back(Invented(i, q));
  for (std::size_t i = 0; i < needs.calls.size(); ++i) calls.push_back(Invented(7 + i, q));
  return expressions.At(expressions.Find(name), q, true, needs, metrics, calls);
}

TEST(MetricExpressions, ComputeOverParametersMetricsPlacesAndEachOther) {
  const MetricExpressions expressions = Parsed({{{"lever", "m", "distance('jaw', 'p') - '200 mm'"},
                                                 {"pull", "N", "'30 N m' / lever"},
                                                 {"heavy", "kg", "mass + 2 * mass * angle"}},
                                                {{"p", "length", "", "0.5"}}});
  const std::vector<std::string> pull{"pull", "volume"};
  const auto needs = expressions.NeedsOf(pull);
  EXPECT_THAT(needs.metrics, ElementsAre("volume"));
  ASSERT_THAT(needs.calls, SizeIs(1));
  EXPECT_EQ(ToText(needs.calls[0]), "distance('jaw', 'p')");
  const std::vector<absl::StatusOr<Dual>> calls{Dual{1.7, {}}}, metrics{Dual{3, {}}};
  const auto value = expressions.At(expressions.Find("pull"), kAt, false, needs, metrics, calls);
  ASSERT_TRUE(value.ok()) << value.status();
  EXPECT_DOUBLE_EQ(value->value, 30 / 1.5);
  const auto point = expressions.PointAt("p", kAt);
  ASSERT_TRUE(point.ok() && point->has_value());
  EXPECT_EQ((*point)->position, Eigen::Vector3d(2, 0, 0.5));
  EXPECT_EQ((*point)->velocity(0, 0), 1);
  EXPECT_FALSE(expressions.PointAt("jaw", kAt)->has_value());
}

TEST(MetricExpressions, HaveTheGradientsThatDifferencesTell) {
  const MetricExpressions expressions =
      Parsed({{{"a", "m", "sqrt(area('f')) * cos(angle) + length"},
               {"b", "N m", "a * load + compliance - min(strain_energy, 2 * compliance)"},
               {"c", "1", "b / ('1 J' + abs(reaction_z('f', 'wind')) * a)"}},
              {}});
  std::mt19937 bits(7);
  std::uniform_real_distribution<double> spread(0.5, 2);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d q(spread(bits), spread(bits), spread(bits));
    for (const char* name : {"a", "b", "c"}) {
      const auto dual = ValueOf(expressions, name, q);
      ASSERT_TRUE(dual.ok()) << dual.status();
      for (int k = 0; k < 3; ++k) {
        const double h = 1e-6;
        const Eigen::Vector3d step = h * Eigen::Vector3d::Unit(k);
        const double difference = (ValueOf(expressions, name, q + step)->value -
                                   ValueOf(expressions, name, q - step)->value) /
                                  (2 * h);
        EXPECT_NEAR(dual->gradient[k], difference, 1e-7 * (1 + std::abs(difference))) << name;
      }
    }
  }
}

TEST(MetricExpressions, MustHaveTheUnitThatTheyClaim) {
  for (const auto& [unit, expression] : std::vector<std::pair<std::string, std::string>>{
           {"N", "'30 N m' / length"},
           {"m", "max(0, length - '30 mm')"},
           {"m^2", "length ^ 2 + area('f')"},
           {"1", "sin(angle) * max_von_mises / '2.1 GPa'"},
           {"m", "sqrt(area('f'))"},
           {"W/(m^2 K)", "heat_dissipation('f') / area('f') / mean_temperature('f')"},
           {"kg m^2", "inertia_xx"},
           {"1", "cost / (2 * cost)"},
           {"N m", "moment_z('f', 'p') + compliance"},
           {"Hz", "natural_frequency * angle"}}) {
    EXPECT_THAT(FindingsOf(unit, expression), IsEmpty())
        << expression << ": " << FirstOf(FindingsOf(unit, expression));
  }
  EXPECT_EQ(FirstOf(FindingsOf("m", "length * length")),
            "own.expressions[0].expression: 'm0': has the unit m^2, not m; a number has one in "
            "quotes only, as '30 N m'");
  for (const char* expression : {"length - 0.03", "mass + length * mass / '1 m' + volume",
                                 "sin(length) * '1 m'", "max(length, 1)", "2 ^ length * '1 m'"}) {
    EXPECT_THAT(FirstOf(FindingsOf("m", expression)), HasSubstr("own.expressions[0].expression"))
        << expression;
  }
}

TEST(MetricExpressions, TellEveryMistakeWithNameAndPlace) {
  const auto expect = [](const std::string& expression, const std::string& message) {
    EXPECT_THAT(FirstOf(FindingsOf("1", expression)),
                HasSubstr(absl::StrCat("own.expressions[0].expression: 'm0': ", message)))
        << expression;
  };
  expect("mass / weight", "column 8: there is no parameter or metric 'weight'");
  expect("1 + surface('f')", "column 5: there is no function 'surface' of faces and points");
  expect("area('f', 'g')", "column 1: area takes 1 place");
  expect("distance('f')", "column 1: distance takes 2 places");
  expect("moment_x('f')", "column 1: moment_x takes 2 places and a load case");
  expect("area('f)", "column 6: the quotation has no end");
  expect("area('f' 2)", "column 10: expected ',' or ')'");
  expect("1 + ''", "column 5: there is nothing between the quotes");
  expect("2 * '3 parsec'", "column 5: there is no unit 'parsec'");
  expect("2 * 'f'", "column 5: outside of a function, quotes hold a number and its unit");
  expect("area('f') +", "column 12: expected");
  expect("", "column 1: expected");
  expect(std::string(3000, '('), "expression of 3000 characters");
}

TEST(MetricExpressions, RefuseNamesThatAreTakenAndCircles) {
  const auto named = [](const std::string& name) {
    return FirstOf(FindingsOf({{{name, "1", "1"}}, {}}));
  };
  EXPECT_THAT(named("length"), HasSubstr("own.expressions[0].name: 'length' is a parameter"));
  EXPECT_THAT(named("mass"), HasSubstr("'mass' is a metric already"));
  for (const char* name : {"", "Mass", "2nd", "a b", "sqrt", "pi"}) {
    EXPECT_THAT(named(name), HasSubstr("own.expressions[0].name: must be")) << name;
  }
  EXPECT_THAT(FirstOf(FindingsOf({{{"a", "1", "1"}, {"a", "1", "2"}}, {}})),
              HasSubstr("own.expressions[1].name: 'a' is a metric already"));
  EXPECT_THAT(FirstOf(FindingsOf({{{"a", "1", "1"}}, {}}, {{{"a", "1", "2"}}, {}})),
              HasSubstr("own.expressions[0].name: 'a' is a metric already"));
  EXPECT_EQ(FirstOf(FindingsOf({{{"a", "1", "b"}, {"b", "1", "c + 1"}, {"c", "1", "2 * b"}}, {}})),
            "own.expressions[1].expression: 'b' depends on itself: b needs c needs b");
  EXPECT_THAT(FirstOf(FindingsOf({{{"a", "1", "a + 1"}}, {}})),
              HasSubstr("'a' depends on itself: a needs a"));
  EXPECT_THAT(FirstOf(FindingsOf({{{"a", "mm", "1"}}, {}})),
              HasSubstr("own.expressions[0].unit: must be an SI unit"));
  EXPECT_THAT(FirstOf(FindingsOf({{}, {{"p", "mass", "", ""}}})),
              HasSubstr("own.points[0].x: 'p': column 1: there is no parameter 'mass'"));
  EXPECT_THAT(FirstOf(FindingsOf({{}, {{"p", "", "", ""}, {"p", "", "", ""}}})),
              HasSubstr("own.points[1].name: 'p' occurs twice"));
  MetricDefinitions many;
  for (int i = 0; i < 51; ++i) many.expressions.push_back({absl::StrCat("m", i), "1", "1"});
  EXPECT_THAT(FirstOf(FindingsOf(many)), HasSubstr("own.expressions: has 51; at most 50"));
}

// A template that was stored before there was such a metric keeps the name for its own, in what
// stands on it, too; whoever defines a metric now takes another.
TEST(MetricExpressions, KeepTheNamesThatATemplateHasHad) {
  const MetricDefinitions stored{
      {{"mean_von_mises", "Pa", "2 * mean_von_mises('top')"}, {"safe", "Pa", "3 * mean_von_mises"}},
      {}};
  std::vector<FieldViolation> findings;
  const MetricExpressions expressions({{{"half", "Pa", "safe / 2"}}, {}}, stored, kParameters,
                                      kDesignMetrics, "own", findings);
  ASSERT_THAT(findings, IsEmpty()) << FirstOf(findings);
  const auto needs = expressions.NeedsOf(std::vector<std::string>{"half"});
  EXPECT_THAT(needs.metrics, IsEmpty());
  EXPECT_THAT(needs.calls, SizeIs(1));
  const std::vector<absl::StatusOr<Dual>> top{Dual{5, {}}};
  const auto half = expressions.At(expressions.Find("half"), kAt, false, needs, {}, top);
  ASSERT_TRUE(half.ok()) << half.status();
  EXPECT_DOUBLE_EQ(half->value, 15);
  EXPECT_THAT(FirstOf(FindingsOf({{{"mean_von_mises", "Pa", "mean_von_mises('top')"}}, {}})),
              HasSubstr("'mean_von_mises' is a metric already"));
  EXPECT_THAT(FirstOf(FindingsOf({{{"mean_von_mises", "Pa", "'1 Pa'"}}, {}}, stored)),
              HasSubstr("'mean_von_mises' is a metric already"));
}

TEST(MetricExpressions, SayWhichOfThemHasNoValueAndWhy) {
  const MetricExpressions expressions =
      Parsed({{{"a", "1", "1 / (area('f') / '1 m^2' - 1)"}, {"b", "1", "2 * a"}}, {}});
  const auto needs = expressions.NeedsOf(std::vector<std::string>{"b"});
  const std::vector<absl::StatusOr<Dual>> one{Dual{1, {}}};
  const auto zero = expressions.At(1, kAt, false, needs, {}, one);
  EXPECT_EQ(zero.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(std::string(zero.status().message()),
              HasSubstr("own.expressions[0].expression: 'a': '1 / (area('f') / '1 m^2' - 1)' "
                        "divides by zero"));
  const std::vector<absl::StatusOr<Dual>> missing{absl::NotFoundError("there is no face 'f'")};
  const auto unknown = expressions.At(1, kAt, false, needs, {}, missing);
  EXPECT_EQ(unknown.status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(unknown.status().message(), "'b': 'a': there is no face 'f'");
}

TEST(MetricExpressions, AreReadFromMessages) {
  v1::MetricDefinitions message;
  auto& metric = *message.add_expressions();
  metric.set_name("density");
  metric.set_unit("kg/m^3");
  metric.set_expression("mass / volume");
  EXPECT_THAT(ValidateMetricDefinitions(message, {}, kDesignMetrics), IsEmpty());
  metric.set_unit("kg");
  const auto findings = ValidateMetricDefinitions(message, {}, kDesignMetrics);
  ASSERT_THAT(findings, SizeIs(1));
  EXPECT_EQ(findings[0].field, "metric_definitions.expressions[0].expression");
}

TEST(Units, AreReadAsPeopleWriteThem) {
  const auto expect = [](const std::string& text, double factor, const std::string& dimension) {
    const auto unit = ParseUnit(text);
    ASSERT_TRUE(unit.ok()) << text << ": " << unit.status();
    EXPECT_DOUBLE_EQ(unit->factor, factor) << text;
    EXPECT_EQ(ToText(unit->dimension), dimension) << text;
  };
  expect("N m", 1, "kg m^2 s^-2");
  expect("kg*m^2", 1, "kg m^2");
  expect("mm^2", 1e-6, "m^2");
  expect("W/(m^2 K)", 1, "K^-1 kg s^-3");
  expect("1/K", 1, "K^-1");
  expect("MPa", 1e6, "kg m^-1 s^-2");
  expect("deg", M_PI / 180, "1");
  expect("EUR/kg", 1, "EUR kg^-1");
  for (const char* text : {"", "x", "m/", "m//s", "m^", "m^99", "W/(m^2", "kmm", "kkg", "m s)"}) {
    EXPECT_FALSE(ParseUnit(text).ok()) << text;
  }
}

}  // namespace
}  // namespace mortise::parametric
