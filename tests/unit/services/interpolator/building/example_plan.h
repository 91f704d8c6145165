// Two numbers that vary beside a whole one, of four parameters.
#pragma once

#include "services/interpolator/building/map_plan.h"

namespace mortise::interpolator {

// x in [0, 1], ribs 1 or 3, y in [10, 12]; "fixed" between them is 7. Metrics "sum" and "product".
inline MapPlan ExamplePlan(int evaluations) {
  MapPlan plan;
  plan.names = {"x", "fixed", "ribs", "y"};
  plan.base = Eigen::Vector4d(0.5, 7, 1, 11);
  plan.parameters.resize(3);
  plan.parameters[0] = {.name = "x", .unit = "m", .index = 0, .minimum = 0, .maximum = 1};
  plan.parameters[1] = {.name = "ribs", .unit = "1", .index = 2, .minimum = 1, .maximum = 3};
  plan.parameters[1].whole = true;
  plan.parameters[1].values = {1, 3};
  plan.parameters[2] = {.name = "y", .unit = "m", .index = 3, .minimum = 10, .maximum = 12};
  plan.metrics = {{"sum", "m", 0}, {"product", "m2", 0}};
  plan.evaluations = evaluations;
  plan.structures.resize(1, 2);
  plan.structures << 1, 3;
  return plan;
}

}  // namespace mortise::interpolator
