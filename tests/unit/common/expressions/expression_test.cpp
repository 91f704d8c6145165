// Expressions: grammar, values, exact gradients, and errors with their places.
#include "common/expressions/expression.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;

const std::vector<std::string> kNames = {"a", "b", "c"};

double ValueAt(const std::string& text, const Eigen::Vector3d& q = {2, 3, 5}) {
  const auto expression = Expression::Parse(text, kNames);
  EXPECT_TRUE(expression.ok()) << text << ": " << expression.status();
  if (!expression.ok()) return NAN;
  const auto value = expression->Value(q);
  EXPECT_TRUE(value.ok()) << text << ": " << value.status();
  return value.ok() ? *value : NAN;
}

std::string ParseError(const std::string& text) {
  const auto expression = Expression::Parse(text, kNames);
  return expression.ok() ? "parsed" : std::string(expression.status().message());
}

std::string ValueError(const std::string& text, const Eigen::Vector3d& q = {2, 3, 5}) {
  const auto expression = Expression::Parse(text, kNames);
  if (!expression.ok()) return "not parsed";
  const auto value = expression->Value(q);
  return value.ok() ? "evaluated" : std::string(value.status().message());
}

TEST(Expression, FollowsPrecedenceAndGrouping) {
  EXPECT_DOUBLE_EQ(ValueAt("1 + 2 * 3"), 7);
  EXPECT_DOUBLE_EQ(ValueAt("(1 + 2) * 3"), 9);
  EXPECT_DOUBLE_EQ(ValueAt("10 - 4 - 3"), 3);
  EXPECT_DOUBLE_EQ(ValueAt("12 / 3 / 2"), 2);
  EXPECT_DOUBLE_EQ(ValueAt("-2 ^ 2"), -4);
  EXPECT_DOUBLE_EQ(ValueAt("2 ^ 3 ^ 2"), 512);
  EXPECT_DOUBLE_EQ(ValueAt("2 ^ -1"), 0.5);
  EXPECT_DOUBLE_EQ(ValueAt("--a"), 2);
  EXPECT_DOUBLE_EQ(ValueAt("-a / 2 + 0.03"), -0.97);
  EXPECT_DOUBLE_EQ(ValueAt(" \t\n a*b "), 6);
}

TEST(Expression, KnowsFunctionsAndPi) {
  EXPECT_DOUBLE_EQ(ValueAt("sqrt(16)"), 4);
  EXPECT_DOUBLE_EQ(ValueAt("sin(pi / 2) + cos(0) + tan(0)"), 2);
  EXPECT_DOUBLE_EQ(ValueAt("floor(2.7) + ceil(2.1) + abs(-1)"), 6);
  EXPECT_DOUBLE_EQ(ValueAt("min(a, b, c) + max(a, b, c)"), 7);
  EXPECT_DOUBLE_EQ(ValueAt("1e-3 + .5 + 2."), 2.501);
}

TEST(Expression, ReportsTheColumnOfAMistake) {
  EXPECT_THAT(ParseError(""), HasSubstr("column 1"));
  EXPECT_THAT(ParseError("1 +"), HasSubstr("column 4"));
  EXPECT_THAT(ParseError("a + width"), HasSubstr("column 5: there is no parameter 'width'"));
  EXPECT_THAT(ParseError("(a + b"), HasSubstr("column 7: expected ')'"));
  EXPECT_THAT(ParseError("a b"), HasSubstr("column 3"));
  EXPECT_THAT(ParseError("log(a)"), HasSubstr("no function 'log'"));
  EXPECT_THAT(ParseError("sqrt(a, b)"), HasSubstr("expected ')'"));
  EXPECT_THAT(ParseError("min(a)"), HasSubstr("expected ','"));
  EXPECT_THAT(ParseError("1e999"), HasSubstr("finite number"));
  EXPECT_THAT(ParseError(std::string("a\0b", 3)), HasSubstr("column 2"));
}

TEST(Expression, LimitsLengthAndDepth) {
  EXPECT_THAT(ParseError(std::string(5000, '1')), HasSubstr("at most"));
  EXPECT_THAT(ParseError(std::string(1000, '(')), HasSubstr("nesting"));
  EXPECT_THAT(ParseError(std::string(1000, '-')), HasSubstr("nesting"));
}

TEST(Expression, RefusesWhatHasNoValue) {
  EXPECT_THAT(ValueError("1 / (a - 2)"), HasSubstr("'1 / (a - 2)' divides by zero"));
  EXPECT_THAT(ValueError("sqrt(-a)"), HasSubstr("no finite value"));
  EXPECT_THAT(ValueError("(-a) ^ 0.5"), HasSubstr("no finite value"));
  EXPECT_THAT(ValueError("10 ^ 400"), HasSubstr("no finite value"));
  EXPECT_THAT(ValueError("a", {NAN, 0, 0}), HasSubstr("no finite value"));
}

TEST(Expression, RefusesAGradientThatIsInfinite) {
  const auto expression = Expression::Parse("sqrt(a - 2)", kNames);
  ASSERT_TRUE(expression.ok());
  EXPECT_TRUE(expression->Value(Eigen::Vector3d(2, 0, 0)).ok());
  EXPECT_FALSE(expression->ValueAndGradient(Eigen::Vector3d(2, 0, 0)).ok());
}

TEST(Expression, RefusesAWrongNumberOfParameters) {
  const auto expression = Expression::Parse("a", kNames);
  ASSERT_TRUE(expression.ok());
  EXPECT_FALSE(expression->Value(Eigen::Vector2d(1, 2)).ok());
}

// The gradient agrees with central differences, to their accuracy, wherever the expression is
// smooth.
TEST(Expression, GradientMatchesDifferences) {
  const std::vector<std::string> texts = {"a * b * c",
                                          "a / b - c / a",
                                          "a ^ 3 + b ^ 0.5",
                                          "a ^ b",
                                          "2 ^ a",
                                          "sqrt(a * a + b * b)",
                                          "sin(a) * cos(b)",
                                          "tan(a / 4)",
                                          "abs(a - b) * c",
                                          "min(a, b) + max(b, c)",
                                          "-(a + b) / (c + 1)",
                                          "floor(a) * b + ceil(c)",
                                          "(a + 0.1) ^ 0 * b",
                                          "a - a",
                                          "pi * a ^ 2 / 4"};
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.3, 2.7);
  for (const std::string& text : texts) {
    const auto expression = Expression::Parse(text, kNames);
    ASSERT_TRUE(expression.ok()) << text;
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::Vector3d q(uniform(random), uniform(random), uniform(random));
      const auto dual = expression->ValueAndGradient(q);
      ASSERT_TRUE(dual.ok()) << text << ": " << dual.status();
      EXPECT_DOUBLE_EQ(dual->value, *expression->Value(q));
      for (int i = 0; i < 3; ++i) {
        const double step = 1e-6;
        Eigen::Vector3d up = q, down = q;
        up(i) += step;
        down(i) -= step;
        const double difference = (*expression->Value(up) - *expression->Value(down)) / (2 * step);
        EXPECT_NEAR(dual->gradient(i), difference, 1e-6 * (1 + std::abs(difference)))
            << text << " by " << kNames[static_cast<std::size_t>(i)] << " at " << q.transpose();
      }
    }
  }
}

}  // namespace
}  // namespace mortise::parametric
