// The shapes of all steps as the guide's page carries them: what is alike once, with where each of
// it stands. guide/guide_scene.mjs reads it.
#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/fabplanner/documents/step_arrangement.h"

namespace mortise::fabplanner {

// A step to be shown in three dimensions, and from where it is seen at first.
struct SceneStep {
  int number = 0;
  StepArrangement arrangement;
  Eigen::Vector3d view = Eigen::Vector3d::UnitX();  // from what is seen to the eye
};

struct GuideScene {
  nlohmann::ordered_json description;  // of shapes and steps
  std::string pack;                    // their numbers (common/pages/number_pack.h)
  double rounding = 0;                 // m, how far a corner of a shape is moved at most
};

// Returns the scene. Corners of shapes are rounded to 2^-16 of the longest side of any part: those
// of parts 2.4 m long by 0.032 mm at most. Parts and pegs that are then alike but for their place
// share a shape; parts without triangles are left out. RESOURCE_EXHAUSTED where all of it is more
// than browsers read.
absl::StatusOr<GuideScene> PackGuideScene(const std::vector<SceneStep>& steps);

}  // namespace mortise::fabplanner
