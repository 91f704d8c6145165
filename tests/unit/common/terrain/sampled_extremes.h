// Extremes of height fields found by looking at many places, and derivatives by differences.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "common/terrain/height_field.h"
#include "tests/support/status_assertions.h"

namespace mortise::terrain {

inline constexpr int kSamples = 60;  // along each axis

struct Extremes {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
};

inline Extremes SampledUnder(const HeightField& field, const Rectangle& rectangle) {
  Extremes extremes;
  for (int i = 0; i <= kSamples; ++i) {
    for (int k = 0; k <= kSamples; ++k) {
      const double x = std::lerp(rectangle.from_x, rectangle.to_x, double(i) / kSamples);
      const double y = std::lerp(rectangle.from_y, rectangle.to_y, double(k) / kSamples);
      const double height = field.HeightAt(x, y).value().value;
      extremes.lowest = std::min(extremes.lowest, height);
      extremes.highest = std::max(extremes.highest, height);
    }
  }
  return extremes;
}

inline double& NumberOf(Rectangle& rectangle, int number) {
  double* const numbers[] = {&rectangle.from_x, &rectangle.to_x, &rectangle.from_y,
                             &rectangle.to_y};
  return *numbers[number];
}

inline Rectangle RandomRectangle(std::mt19937& random, double width, double depth) {
  std::uniform_real_distribution<double> share(0.02, 0.98);
  const auto [from_x, to_x] = std::minmax({share(random) * width, share(random) * width});
  const auto [from_y, to_y] = std::minmax({share(random) * depth, share(random) * depth});
  return {from_x, to_x, from_y, to_y};
}

// That extremes under rectangles are those of many samples, and derivatives those of differences.
// `steepest` is how steep the field is at most, `width` and `depth` how far it reaches from 0.
inline void ExpectExtremes(const HeightField& field, double width, double depth, double steepest,
                           std::mt19937& random) {
  const Rectangle rectangle = RandomRectangle(random, width, depth);
  ASSERT_OK_AND_ASSIGN(const RectangleValue lowest, field.LowestUnder(rectangle));
  ASSERT_OK_AND_ASSIGN(const RectangleValue highest, field.HighestUnder(rectangle));
  const Extremes sampled = SampledUnder(field, rectangle);
  const double apart =
      steepest * (rectangle.to_x - rectangle.from_x + rectangle.to_y - rectangle.from_y) / kSamples;
  EXPECT_LE(lowest.value, sampled.lowest + 1e-12);
  EXPECT_GE(lowest.value, sampled.lowest - apart);
  EXPECT_GE(highest.value, sampled.highest - 1e-12);
  EXPECT_LE(highest.value, sampled.highest + apart);
  constexpr double kStep = 1e-7;
  for (int number = 0; number < 4; ++number) {
    Rectangle less = rectangle, more = rectangle;
    NumberOf(less, number) -= kStep;
    NumberOf(more, number) += kStep;
    const auto difference = [&](const absl::StatusOr<RectangleValue>& of_more,
                                const absl::StatusOr<RectangleValue>& of_less) {
      return (of_more.value().value - of_less.value().value) / (2 * kStep);
    };
    EXPECT_NEAR(lowest.gradient(number),
                difference(field.LowestUnder(more), field.LowestUnder(less)), 1e-5);
    EXPECT_NEAR(highest.gradient(number),
                difference(field.HighestUnder(more), field.HighestUnder(less)), 1e-5);
  }
}

// That the derivatives of a place's value are those of differences.
template <typename ValueAt>
void ExpectPlaceGradient(ValueAt value_at, double x, double y) {
  constexpr double kStep = 1e-6;
  ASSERT_OK_AND_ASSIGN(const PlaceValue value, value_at(x, y));
  const auto at = [&](double at_x, double at_y) { return value_at(at_x, at_y).value().value; };
  EXPECT_NEAR(value.gradient.x(), (at(x + kStep, y) - at(x - kStep, y)) / (2 * kStep), 1e-5);
  EXPECT_NEAR(value.gradient.y(), (at(x, y + kStep) - at(x, y - kStep)) / (2 * kStep), 1e-5);
}

}  // namespace mortise::terrain
