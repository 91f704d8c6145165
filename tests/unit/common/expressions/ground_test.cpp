// Ground in expressions: what it is asked for, gradients through it, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/expressions/expression.h"
#include "common/expressions/identifier.h"
#include "common/terrain/height_field.h"
#include "tests/support/status_assertions.h"

namespace mortise::parametric {
namespace {

using ::testing::HasSubstr;

std::shared_ptr<const terrain::HeightField> Ground() {
  const Eigen::MatrixXd heights{{0.1, 0.4, 0.2}, {0.5, 0.3, 0.9}, {0.2, 0.7, 0.6}};
  return terrain::HeightField::Create(terrain::HeightGrid{.heights = heights}).value();
}

// A length, ground among the parameters, another length and a choice; after them ground again.
std::vector<ExpressionName> Names() {
  return {{.name = "length", .dimension = Dimension{{"m", 1}}},
          {.name = "ground", .ground = Ground()},
          {.name = "width", .dimension = Dimension{{"m", 1}}},
          {.name = "arms", .dimension = Dimension{}, .choices = {"none", "both"}},
          {.name = "bank", .ground = Ground()},
          {.name = "weight", .dimension = Dimension{{"kg", 1}}}};
}

const Eigen::Vector4d kPoint(0.7, 1.2, 1, 3);  // length, width, arms, weight

double ValueAt(const std::string& text) {
  const auto expression = Expression::Parse(text, Names());
  EXPECT_OK(expression) << text;
  if (!expression.ok()) return 0;
  const auto value = expression->Value(kPoint);
  EXPECT_OK(value) << text;
  return value.value_or(0);
}

std::string FaultOf(const std::string& text) {
  return std::string(Expression::Parse(text, Names()).status().message());
}

TEST(Ground, IsAskedByItsName) {
  const auto ground = Ground();
  EXPECT_EQ(ValueAt("terrain('ground', length, width)"), ground->HeightAt(0.7, 1.2)->value);
  EXPECT_EQ(ValueAt("terrain_slope('bank', length, width)"), ground->SlopeAt(0.7, 1.2)->value);
  EXPECT_EQ(ValueAt("terrain_lowest('ground', 0.2, length, 0.5, width + 0.3)"),
            ground->LowestUnder({0.2, 0.7, 0.5, 1.5})->value);
  EXPECT_EQ(ValueAt("1 + 2 * terrain_highest('ground', 0.2, length, 0.5, width) - length"),
            1 + 2 * ground->HighestUnder({0.2, 0.7, 0.5, 1.2})->value - 0.7);
  EXPECT_EQ(ValueAt("if(terrain('ground', 0, 0) > 1, 2, 3)"), 3);
  EXPECT_EQ(ValueAt("if(arms == 'both', weight, 1)"), 3)
      << "the names after ground keep their place";
}

TEST(Ground, HasGradients) {
  for (const char* const text :
       {"length * terrain('ground', length / 2, width^2 / 3)",
        "terrain_slope('ground', length, 1.1 * width)",
        "terrain_lowest('ground', length / 3, length, width / 2, 1.5 * width)",
        "max(terrain_highest('ground', 0, length, 0, width), terrain('bank', 2, 2)) * weight"}) {
    ASSERT_OK_AND_ASSIGN(const Expression expression, Expression::Parse(text, Names()));
    ASSERT_OK_AND_ASSIGN(const Dual dual, expression.ValueAndGradient(kPoint));
    for (Eigen::Index i = 0; i < 4; ++i) {
      if (i == 2) continue;  // the choice
      constexpr double kStep = 1e-6;
      Eigen::VectorXd less = kPoint, more = kPoint;
      less(i) -= kStep;
      more(i) += kStep;
      EXPECT_NEAR(dual.gradient(i),
                  (*expression.Value(more) - *expression.Value(less)) / (2 * kStep), 1e-6)
          << text << " by " << i;
    }
  }
}

TEST(Ground, IsNoParameter) {
  ASSERT_OK_AND_ASSIGN(const Expression expression,
                       Expression::Parse("terrain('ground', width, 1)", Names()));
  EXPECT_TRUE(expression.Uses(1));
  EXPECT_FALSE(expression.Uses(0));
  EXPECT_FALSE(expression.Value(Eigen::VectorXd::Zero(6)).ok()) << "four parameters, not six names";
  EXPECT_THAT(
      FaultOf("ground + 1"),
      HasSubstr("column 1: expected a number; 'ground' is ground, to be asked for a height, "
                "as terrain('ground', x, y)"));
  EXPECT_THAT(FaultOf("if(ground == 'x', 1, 2)"), HasSubstr("column 4"));
  for (const char* const word : {"terrain", "terrain_slope", "terrain_lowest", "terrain_highest"}) {
    EXPECT_TRUE(IsReserved(word));
  }
}

TEST(Ground, IsRefusedWhereItIsAskedWrongly) {
  EXPECT_THAT(FaultOf("1 + terrain('field', 0, 0)"),
              HasSubstr("column 13: there is no ground 'field'; there is 'ground', 'bank'"));
  EXPECT_THAT(
      std::string(Expression::Parse("terrain('ground', 0, 0)", std::vector<std::string>{"length"})
                      .status()
                      .message()),
      HasSubstr("there is none here"));
  EXPECT_THAT(FaultOf("terrain(ground, 0, 0)"), HasSubstr("expected the name of ground in quotes"));
  EXPECT_THAT(FaultOf("terrain('ground', 0)"), HasSubstr("expected ','"));
  EXPECT_THAT(FaultOf("terrain('ground', 0, 0, 1)"), HasSubstr("expected ')'"));
  EXPECT_THAT(FaultOf("terrain('ground, 0, 0)"), HasSubstr("the quotation has no end"));
  EXPECT_THAT(FaultOf("terrain('ground', weight, 0)"),
              HasSubstr("column 19: is in kg, while places are in m"));
  EXPECT_THAT(FaultOf("terrain('ground', arms == 'both', 0)"), HasSubstr("not a condition"));
  EXPECT_THAT(std::string(Expression::ParseCondition("terrain('ground', 0, 0) > weight", Names())
                              .status()
                              .message()),
              HasSubstr("is in kg, while its counterpart is in m"));
  EXPECT_THAT(
      std::string(Expression::ParseCondition("terrain_slope('ground', 0, 0) > length", Names())
                      .status()
                      .message()),
      HasSubstr("is in m, while its counterpart is in 1"));
}

TEST(Ground, TellsWhereItIsNotKnown) {
  ASSERT_OK_AND_ASSIGN(const Expression expression,
                       Expression::Parse("terrain('bank', 3 * width, 1)", Names()));
  EXPECT_EQ(
      expression.Value(kPoint).status().message(),
      "'terrain('bank', 3 * width, 1)': ground 'bank' is known for x 0 to 2 m and y 0 to 2 m, "
      "not at x = 3.6 m, y = 1 m");
  ASSERT_OK_AND_ASSIGN(const Expression turned,
                       Expression::Parse("terrain_lowest('bank', 1, 0.5, 0, 1)", Names()));
  EXPECT_THAT(turned.Value(kPoint).status().message(), HasSubstr("ends before it begins"));
}

}  // namespace
}  // namespace mortise::parametric
