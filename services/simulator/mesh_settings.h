// How finely a request wants a solid divided: checked, and told apart.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "mortise/v1/evaluator.pb.h"

namespace mortise::simulator {

// INVALID_ARGUMENT naming "mesh.element_size" or "mesh.relative_error".
absl::Status CheckMeshSettings(const v1::MeshSettings& settings);

// What of the settings beside size and order of the elements a result depends on, for its key;
// empty where nothing is refined.
std::string RefinementText(const v1::MeshSettings& settings);

}  // namespace mortise::simulator
