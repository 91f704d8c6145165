// Says how pictures of steps look: colours, size, and from where they are seen. Private to
// this folder.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/statusor.h"
#include "common/render/scene.h"

namespace mortise::fabplanner {

inline const render::Color kPresentColor{0.86, 0.86, 0.85};
inline const render::Color kAddedColor{0.95, 0.66, 0.28};
inline const render::Color kPegColor{0.60, 0.30, 0.10};
inline const render::Color kArrowColor{0.05, 0.35, 0.75};

// Returns the direction from which what has kAddedColor is seen best: from the front and above
// unless another corner is much better.
absl::StatusOr<Eigen::Vector3d> ChooseView(const render::Scene& scene);

// Returns the PNG, 900 × 675 pixels, of all in the scene.
absl::StatusOr<std::string> RenderStep(render::Scene scene, const Eigen::Vector3d& view);

}  // namespace mortise::fabplanner
