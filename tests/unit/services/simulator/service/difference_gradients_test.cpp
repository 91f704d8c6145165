#include "services/simulator/service/difference_gradients.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "common/base/errors.h"

namespace mortise::simulator {
namespace {

// Lengths from 1 to 3, and a second parameter that has no range.
v1::DesignSpace Space() {
  v1::DesignSpace space;
  auto& length = *space.add_parameters();
  length.set_minimum(1);
  length.set_maximum(3);
  auto& fixed = *space.add_parameters();
  fixed.set_minimum(5);
  fixed.set_maximum(5);
  return space;
}

v1::DesignPoint PointAt(double length) {
  v1::DesignPoint point;
  point.add_parameters(length);
  point.add_parameters(5);
  return point;
}

std::optional<double> SlopeOf(const std::function<double(double)>& f, double at, double step) {
  const v1::DesignSpace space = Space();
  const v1::DesignPoint point = PointAt(at);
  const DifferenceStencil stencil = StencilsAround(space, point, step)[0];
  std::array<std::optional<double>, 2> values;
  for (int side = 0; side < 2; ++side) {
    const double x = PointAtOffset(space, point, 0, stencil.offsets[side]).parameters(0);
    EXPECT_GE(x, 1);
    EXPECT_LE(x, 3);
    EXPECT_NEAR(x, at + stencil.offsets[side], 1e-12);
    values[side] = f(x);
  }
  return SlopeAt(f(at), stencil, values);
}

TEST(DifferenceGradients, AreExactForParabolasEverywhere) {
  const auto parabola = [](double x) { return 3 * x * x - 7 * x + 2; };
  for (const double step : {1e-3, 0.01, 0.1}) {
    for (const double at : {1.0, 1.001, 1.5, 2.0, 2.9, 2.9999, 3.0}) {
      EXPECT_NEAR(*SlopeOf(parabola, at, step), 6 * at - 7, 1e-9) << at << " by " << step;
    }
  }
}

// Their error falls with the square of the step, at bounds too.
TEST(DifferenceGradients, AreOfSecondOrder) {
  const auto wave = [](double x) { return std::sin(x); };
  for (const double at : {1.0, 2.0, 3.0}) {
    const double coarse = std::abs(*SlopeOf(wave, at, 0.04) - std::cos(at));
    const double fine = std::abs(*SlopeOf(wave, at, 0.02) - std::cos(at));
    EXPECT_NEAR(coarse / fine, 4, 0.4) << at;
  }
}

TEST(DifferenceGradients, TakeTheSideThatIsThere) {
  const DifferenceStencil stencil{{-0.5, 0.5}};
  EXPECT_EQ(SlopeAt(1, stencil, {std::nullopt, 2.0}), 2.0);
  EXPECT_EQ(SlopeAt(1, stencil, {2.0, std::nullopt}), -2.0);
  EXPECT_EQ(SlopeAt(1, stencil, {std::nullopt, std::nullopt}), std::nullopt);
}

TEST(DifferenceGradients, AreZeroWhereNothingCanChange) {
  const auto stencils = StencilsAround(Space(), PointAt(2), 0.01);
  ASSERT_EQ(stencils.size(), 2u);
  EXPECT_FALSE(stencils[0].IsEmpty());
  EXPECT_TRUE(stencils[1].IsEmpty());
  EXPECT_EQ(SlopeAt(1, stencils[1], {std::nullopt, std::nullopt}), 0.0);
}

// A count of 2 to 6 and a choice: between whole numbers there are no designs.
TEST(DifferenceGradients, GoFromWholeNumberToWholeNumber) {
  v1::DesignSpace space;
  auto& count = *space.add_parameters();
  count.set_minimum(2);
  count.set_maximum(6);
  count.set_step(1);
  auto& choice = *space.add_parameters();
  choice.set_maximum(1);
  choice.set_step(1);
  choice.add_choices("none");
  choice.add_choices("both");
  const auto offsets = [&](double at) {
    v1::DesignPoint point;
    point.add_parameters(at);
    point.add_parameters(1);
    const auto stencils = StencilsAround(space, point, 0.01);
    EXPECT_TRUE(stencils[1].IsEmpty());
    return stencils[0].offsets;
  };
  EXPECT_EQ(offsets(4), (std::array<double, 2>{-1, 1}));
  EXPECT_EQ(offsets(2), (std::array<double, 2>{1, 2}));
  EXPECT_EQ(offsets(6), (std::array<double, 2>{-1, -2}));
  space.mutable_parameters(0)->set_maximum(3);  // two whole numbers make no parabola
  v1::DesignPoint point;
  point.add_parameters(2);
  point.add_parameters(0);
  EXPECT_TRUE(StencilsAround(space, point, 0.01)[0].IsEmpty());
}

TEST(DifferenceGradients, AreRefusedByName) {
  v1::EvaluateBatchRequest asked;
  asked.set_difference_step(0.01);
  EXPECT_EQ(DetailOf(CheckDifferences(asked, 3)).field, "difference_step") << "without gradients";
  asked.set_gradients(true);
  EXPECT_TRUE(CheckDifferences(asked, 3).ok());
  for (const double step : {-0.01, 1e-7, 0.2, std::nan("")}) {
    asked.set_difference_step(step);
    EXPECT_EQ(DetailOf(CheckDifferences(asked, 3)).field, "difference_step") << step;
  }
  asked.set_difference_step(0.1);
  for (int i = 0; i < 100; ++i) asked.add_points();
  EXPECT_TRUE(CheckDifferences(asked, 99).ok());
  EXPECT_EQ(DetailOf(CheckDifferences(asked, 100)).field, "points");
}

}  // namespace
}  // namespace mortise::simulator
