// Finds how a design of prisms moves with its parameters: its faces, its volume and the numbers of
// its loads. It takes differences of the design by each parameter, without a mesh: exact, but for
// rounding, where they are linear in the parameters (thesis §3.3), and with an error of the square
// of a ten-thousandth of the range where they are not.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/templates/template.h"
#include "services/simulator/analysis/design_gradients.h"

namespace mortise::simulator {

// Whether all that bears loads of a design is prisms.
bool IsMadeOfPrisms(const parametric::EvaluatedDesign& design);

// Whether the conditions of a design are of kinds whose changes are known: AllowsGradients.
bool HasConstantSupports(const parametric::EvaluatedDesign& design);

// Says which exact gradients a template offers, judged at its defaults.
struct OfferedGradients {
  bool mass = false;   // of mass and volume
  bool shape = false;  // of areas, centroids and distances of faces and points
  bool loads = false;  // of what is computed under loads
};
OfferedGradients GradientsOf(const templates::Template& function, bool is_of_prisms);

// Returns what of the motion is known: mass and volume of templates that offer them exactly, and
// all of MotionOf where that does not fail.
DesignMotion KnownMotion(const templates::Template& function, const Eigen::VectorXd& parameters,
                         const parametric::EvaluatedDesign& design, const DesignModel& model);

// Returns the motion of `design`, which is `function` at `parameters`, and of `model` made of it.
// FAILED_PRECONDITION, reason MESH_MOTION, for what is no prism, and where a small change of a
// parameter changes what parts there are or is impossible; as `function` fails.
absl::StatusOr<DesignMotion> MotionOf(const templates::Template& function,
                                      const Eigen::VectorXd& parameters,
                                      const parametric::EvaluatedDesign& design,
                                      const DesignModel& model);

}  // namespace mortise::simulator
