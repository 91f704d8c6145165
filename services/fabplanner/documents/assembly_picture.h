// Draws one picture for each step of the assembly: what stands already in grey, the added parts in
// colour and pulled apart, with arrows that show how they go in.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/statusor.h"
#include "services/fabplanner/documents/step_arrangement.h"

namespace mortise::fabplanner {

// A picture, and from where it was taken.
struct StepPicture {
  std::string png;
  Eigen::Vector3d view = Eigen::Vector3d::UnitX();  // from what is seen to the eye
};

// Returns the picture of a step, 900 × 675 pixels. The view is the usual one from above unless the
// added parts are seen much better from another corner or from below. Of many arrows and pegs some,
// evenly chosen, stand for all.
absl::StatusOr<StepPicture> DrawStep(const StepArrangement& arrangement);

}  // namespace mortise::fabplanner
