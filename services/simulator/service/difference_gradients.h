// Gradients by differences, for metrics that have no exact ones: from designs on either side.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::simulator {

// Fails with INVALID_ARGUMENT naming "difference_step" unless it is 0, or 1e-6 to 0.1 where
// gradients are wanted; naming "points" where too many designs would be evaluated.
absl::Status CheckDifferences(const v1::EvaluateBatchRequest& asked, int parameters);

// What is added to a parameter for two more designs: in its unit, neither of them 0. Both are 0 for
// a parameter that has no range, or is a choice.
struct DifferenceStencil {
  std::array<double, 2> offsets = {};

  bool IsEmpty() const { return offsets[0] == 0; }
};

// Returns for each parameter of a point within the space: `step`, up to 0.1 of its range, to either
// side, or where a bound is nearer than that, one and two steps to the other side.
std::vector<DifferenceStencil> StencilsAround(const v1::DesignSpace& space,
                                              const v1::DesignPoint& point, double step);

// Returns the point with an offset added to a parameter, and held within the space.
v1::DesignPoint PointAtOffset(const v1::DesignSpace& space, const v1::DesignPoint& point,
                              int parameter, double offset);

// Returns the slope at 0 of the parabola through `at` and the values at both offsets: exact for
// quadratic functions. With one of them that of the line, with none nothing; 0 for an empty
// stencil.
std::optional<double> SlopeAt(double at, const DifferenceStencil& stencil,
                              const std::array<std::optional<double>, 2>& values);

}  // namespace mortise::simulator
