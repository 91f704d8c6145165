// Conditions and choices in expressions: grammar, values, gradients of branches, and what is
// refused, with its place.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "common/expressions/expression.h"
#include "common/expressions/identifier.h"
#include "common/expressions/metric_expressions.h"

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;

// Two lengths, a mass, a plain number and a choice.
const std::vector<ExpressionName> kNames = {{"length", Dimension{{"m", 1}}},
                                            {"width", Dimension{{"m", 1}}},
                                            {"weight", Dimension{{"kg", 1}}},
                                            {"n", Dimension{}},
                                            {"arms", Dimension{}, {"none", "both", "left only"}}};

Eigen::VectorXd At(double length, double width, double weight, double n, double arms) {
  Eigen::VectorXd q(5);
  q << length, width, weight, n, arms;
  return q;
}

const Eigen::VectorXd kPoint = At(2, 3, 5, 0, 1);

bool Holds(const std::string& text, const Eigen::VectorXd& q = kPoint) {
  const auto condition = Expression::ParseCondition(text, kNames);
  EXPECT_TRUE(condition.ok()) << text << ": " << condition.status();
  if (!condition.ok()) return false;
  const auto holds = condition->Holds(q);
  EXPECT_TRUE(holds.ok()) << text << ": " << holds.status();
  return holds.value_or(false);
}

double ValueAt(const std::string& text, const Eigen::VectorXd& q = kPoint) {
  const auto expression = Expression::Parse(text, kNames);
  EXPECT_TRUE(expression.ok()) << text << ": " << expression.status();
  if (!expression.ok()) return NAN;
  const auto value = expression->Value(q);
  EXPECT_TRUE(value.ok()) << text << ": " << value.status();
  return value.value_or(NAN);
}

std::string NumberFault(const std::string& text) {
  return std::string(Expression::Parse(text, kNames).status().message());
}

std::string ConditionFault(const std::string& text) {
  return std::string(Expression::ParseCondition(text, kNames).status().message());
}

TEST(Condition, Compares) {
  EXPECT_TRUE(Holds("length < width"));
  EXPECT_FALSE(Holds("length > width"));
  EXPECT_TRUE(Holds("length <= 2"));
  EXPECT_TRUE(Holds("length >= 2"));
  EXPECT_FALSE(Holds("length < 2"));
  EXPECT_TRUE(Holds("length == 2"));
  EXPECT_FALSE(Holds("length != 2"));
  EXPECT_TRUE(Holds("length + width == 2 + 3"));
  EXPECT_TRUE(Holds("(length < width)"));
}

TEST(Condition, ComparesChoicesWithNamesOfTheirValues) {
  EXPECT_TRUE(Holds("arms == 'both'"));
  EXPECT_TRUE(Holds("'both' == arms"));
  EXPECT_TRUE(Holds("(arms) != 'none'"));
  EXPECT_FALSE(Holds("arms == 'left only'"));
  EXPECT_TRUE(Holds("arms == 'left only'", At(2, 3, 5, 0, 2)));
}

TEST(Condition, GroupsNotBeforeAndBeforeOr) {
  for (const double a : {0.0, 1.0}) {
    for (const double b : {0.0, 1.0}) {
      for (const double c : {0.0, 1.0}) {
        const Eigen::VectorXd q = At(a, b, 5, c, 0);
        const bool x = a == 1, y = b == 1, z = c == 1;
        EXPECT_EQ(Holds("length == 1 or width == 1 and n == 1", q), x || (y && z));
        EXPECT_EQ(Holds("(length == 1 or width == 1) and n == 1", q), (x || y) && z);
        EXPECT_EQ(Holds("not length == 1 and width == 1", q), !x && y);
        EXPECT_EQ(Holds("not (length == 1 and width == 1) or n == 1", q), !(x && y) || z);
        EXPECT_EQ(Holds("not not length == 1", q), x);
        EXPECT_EQ(Holds("length == 1 or width == 1 or n == 1", q), x || y || z);
        EXPECT_EQ(Holds("length == 1 and width == 1 and n == 1", q), x && y && z);
        EXPECT_EQ(Holds("if(length == 1, width == 1, n == 1)", q), x ? y : z);
      }
    }
  }
}

TEST(Condition, DecidesBetweenNumbers) {
  EXPECT_DOUBLE_EQ(ValueAt("if(length < width, 1, 2)"), 1);
  EXPECT_DOUBLE_EQ(ValueAt("if(arms == 'none', 1, if(arms == 'both', 2, 3)) + 10"), 12);
  EXPECT_DOUBLE_EQ(ValueAt("2 * if(not arms == 'both', length, width)"), 6);
  EXPECT_DOUBLE_EQ(ValueAt("max(if(n == 0, 1, 2), 0.5)"), 1);
}

// Only what decides is evaluated.
TEST(Condition, LeavesAloneWhatDoesNotDecide) {
  EXPECT_DOUBLE_EQ(ValueAt("if(n > 0, length / n, 7)"), 7);
  EXPECT_FALSE(Holds("n > 0 and length / n > 1"));
  EXPECT_TRUE(Holds("n == 0 or length / n > 1"));
  const auto divides = Expression::Parse("if(n == 0, length / n, 7)", kNames);
  ASSERT_TRUE(divides.ok());
  EXPECT_THAT(divides->Value(kPoint).status().message(), HasSubstr("divides by zero"));
}

TEST(Condition, RefusesNumbersForConditionsAndTheReverse) {
  EXPECT_THAT(ConditionFault("length"), HasSubstr("column 1: expected a condition"));
  EXPECT_THAT(ConditionFault("1"), HasSubstr("not a number"));
  EXPECT_THAT(NumberFault("length < width"),
              HasSubstr("column 1: expected a number, not a condition"));
  EXPECT_THAT(NumberFault("1 + (length < width)"), HasSubstr("column 6: expected a number"));
  EXPECT_THAT(NumberFault("(length < width) + 1"), HasSubstr("expected a number"));
  EXPECT_THAT(NumberFault("-(length < width)"), HasSubstr("expected a number"));
  EXPECT_THAT(NumberFault("sqrt(length < width)"), HasSubstr("column 6: expected a number"));
  EXPECT_THAT(NumberFault("(1 < 2) ^ 2"), HasSubstr("expected a number"));
  EXPECT_THAT(NumberFault("2 ^ (1 < 2)"), HasSubstr("expected a number"));
  EXPECT_THAT(NumberFault("if(length, 1, 2)"), HasSubstr("column 4: expected a condition"));
  EXPECT_THAT(NumberFault("if(n > 0, 1, n > 1)"), HasSubstr("column 14: expected a number"));
  EXPECT_THAT(NumberFault("if(n > 0, n > 1, 1)"), HasSubstr("column 18: expected a condition"));
  EXPECT_THAT(ConditionFault("length and width > 1"), HasSubstr("column 1: expected a condition"));
  EXPECT_THAT(ConditionFault("width > 1 or n"), HasSubstr("column 14: expected a condition"));
  EXPECT_THAT(ConditionFault("not length"), HasSubstr("column 5: expected a condition"));
  EXPECT_THAT(ConditionFault("(n > 1) > 1"), HasSubstr("expected a number, not a condition"));
}

TEST(Condition, RefusesChoicesInAnyOtherUse) {
  EXPECT_THAT(ConditionFault("arms == 'bth'"),
              HasSubstr("column 9: 'arms' has no value 'bth'; it has 'none', 'both', 'left only'"));
  EXPECT_THAT(ConditionFault("arms < 'both'"), HasSubstr("no order"));
  EXPECT_THAT(ConditionFault("arms == 1"), HasSubstr("column 9: expected the name of a value"));
  EXPECT_THAT(ConditionFault("arms == arms"), HasSubstr("expected the name of a value"));
  EXPECT_THAT(ConditionFault("arms"), HasSubstr("as arms == 'none'"));
  EXPECT_THAT(ConditionFault("not arms"), HasSubstr("'arms' is a choice"));
  EXPECT_THAT(NumberFault("arms + 1"),
              HasSubstr("column 1: expected a number; 'arms' is a choice"));
  EXPECT_THAT(NumberFault("1 + arms"), HasSubstr("column 5"));
  EXPECT_THAT(NumberFault("abs(arms)"), HasSubstr("'arms' is a choice"));
  EXPECT_THAT(NumberFault("'both'"), HasSubstr("quoted"));
  EXPECT_THAT(ConditionFault("length == 'both'"),
              HasSubstr("column 1: expected a parameter that is"));
  EXPECT_THAT(ConditionFault("'none' == 'both'"),
              HasSubstr("expected a parameter that is a choice"));
  EXPECT_THAT(ConditionFault("arms == 'both"), HasSubstr("column 9: the quotation has no end"));
  EXPECT_THAT(ConditionFault("legs == 'both'"), HasSubstr("there is no parameter 'legs'"));
}

TEST(Condition, RefusesWhatIsMeasuredInOtherUnits) {
  EXPECT_THAT(ConditionFault("length < weight"),
              HasSubstr("column 10: is in kg, while its counterpart is in m"));
  EXPECT_THAT(ConditionFault("length * width > width"), HasSubstr("is in m"));
  EXPECT_THAT(ConditionFault("max(length, width) > weight"), HasSubstr("is in kg"));
  EXPECT_THAT(ConditionFault("length / width > weight"), HasSubstr("is in kg"));
  EXPECT_THAT(NumberFault("if(n > 0, length, weight)"), HasSubstr("column 19: is in kg"));
  // A plain number takes the unit that is needed.
  EXPECT_TRUE(Holds("length > 1.2"));
  EXPECT_TRUE(Holds("length + 0.1 < width * 0.9"));
  EXPECT_TRUE(Holds("ceil(length / 0.15) > n"));
  EXPECT_TRUE(Holds("length / width < 1"));
}

TEST(Condition, RefusesWhatIsNoComparison) {
  EXPECT_THAT(ConditionFault("length = 2"), HasSubstr("column 8: expected an operator"));
  EXPECT_THAT(ConditionFault("1 < length < 2"), HasSubstr("'and' or 'or'"));
  EXPECT_THAT(ConditionFault("length <"), HasSubstr("column 9: expected a number"));
  EXPECT_THAT(ConditionFault("length > 1 and"), HasSubstr("column 15"));
  EXPECT_THAT(ConditionFault("length > 1 && n > 1"), HasSubstr("column 12"));
  EXPECT_THAT(NumberFault("if(n > 0, 1)"), HasSubstr("expected ','"));
  EXPECT_THAT(NumberFault("if(n > 0, 1, 2, 3)"), HasSubstr("expected ')'"));
  std::string deep;
  for (int i = 0; i < 100; ++i) deep += "not ";
  EXPECT_THAT(ConditionFault(deep + "n > 1"), HasSubstr("nesting"));
}

TEST(Condition, LeavesNamesThatWereThereBefore) {
  const auto value =
      Expression::Parse("if + not * and", std::vector<std::string>{"if", "not", "and"});
  ASSERT_TRUE(value.ok()) << value.status();
  EXPECT_DOUBLE_EQ(*value->Value(Eigen::Vector3d(1, 2, 3)), 7);
  for (const char* word : {"if", "and", "or", "not"}) EXPECT_TRUE(IsReserved(word));
}

TEST(Condition, GradientIsThatOfTheBranchTaken) {
  const std::vector<std::string> texts = {
      "if(length < width, length * width, width ^ 2)",
      "if(arms == 'both', sqrt(length), width) * weight",
      "if(length > 1.5 and width < 1.5, length ^ 2, if(weight > 1, 3 * length, 0.5))",
      "if(not n > 1 or length > 2, sin(length), cos(width))"};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0.3, 2.7);
  for (const std::string& text : texts) {
    const auto expression = Expression::Parse(text, kNames);
    ASSERT_TRUE(expression.ok()) << text << ": " << expression.status();
    for (int trial = 0; trial < 50; ++trial) {
      const Eigen::VectorXd q =
          At(uniform(random), uniform(random), uniform(random), uniform(random), trial % 3);
      const auto dual = expression->ValueAndGradient(q);
      ASSERT_TRUE(dual.ok()) << text << ": " << dual.status();
      EXPECT_EQ(dual->value, *expression->Value(q));
      EXPECT_EQ(dual->gradient(4), 0);
      for (int i = 0; i < 4; ++i) {
        const double step = 1e-6;
        Eigen::VectorXd up = q, down = q;
        up(i) += step;
        down(i) -= step;
        const double difference = (*expression->Value(up) - *expression->Value(down)) / (2 * step);
        EXPECT_NEAR(dual->gradient(i), difference, 1e-6 * (1 + std::abs(difference))) << text;
      }
    }
  }
}

TEST(Condition, TellsWhichNamesItUses) {
  const auto expression = Expression::Parse("if(n > 0, length, 2)", kNames);
  ASSERT_TRUE(expression.ok());
  EXPECT_TRUE(expression->Uses(0));
  EXPECT_FALSE(expression->Uses(1));
  EXPECT_TRUE(expression->Uses(3));
}

// Metrics of one's own: what is quoted beside == is the name of a value, not a number with a unit.
TEST(Condition, StandsInMetrics) {
  const std::vector<NamedUnit> parameters = {{"length", "m"}, {"arms", "1", {"none", "both"}}};
  const std::vector<NamedUnit> metrics = {{"mass", "kg"}};
  std::vector<FieldViolation> findings;
  const MetricDefinitions definitions = {
      {{"shipped", "kg", "if(arms == 'both' and length > '1 m', mass + '2 kg', mass)"}}, {}};
  const MetricExpressions expressions(definitions, {}, parameters, metrics, "metrics", findings);
  ASSERT_TRUE(findings.empty()) << findings[0].message;
  const std::vector<std::string> names = {"shipped"};
  const MetricExpressions::Needs needs = expressions.NeedsOf(names);
  const std::vector<absl::StatusOr<Dual>> mass = {Dual{10, Eigen::Vector2d(1, 0)}};
  for (const auto& [arms, expected] : {std::pair(0.0, 10.0), std::pair(1.0, 12.0)}) {
    const auto shipped = expressions.At(0, Eigen::Vector2d(1.5, arms), true, needs, mass, {});
    ASSERT_TRUE(shipped.ok()) << shipped.status();
    EXPECT_DOUBLE_EQ(shipped->value, expected);
    EXPECT_DOUBLE_EQ(shipped->gradient(0), 1);
  }
  for (const auto& [text, fault] :
       {std::pair("if(arms == 'bth', mass, mass)", "'arms' has no value 'bth'"),
        std::pair("if(length > mass, mass, mass)", "is in kg, while its counterpart is in m"),
        std::pair("mass * arms", "'arms' is a choice")}) {
    std::vector<FieldViolation> found;
    const MetricExpressions refused({{{"shipped", "kg", text}}, {}}, {}, parameters, metrics,
                                    "metrics", found);
    ASSERT_EQ(found.size(), 1U) << text;
    EXPECT_EQ(found[0].field, "metrics.expressions[0].expression");
    EXPECT_THAT(found[0].message, HasSubstr(fault));
  }
}

}  // namespace
}  // namespace mortise::parametric
