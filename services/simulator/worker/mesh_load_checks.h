// Checks the load cases of a mesh's case, before anybody looks at the mesh.
#pragma once

#include <string>

#include "absl/status/status.h"

namespace mortise::v1 {
class MeshCase;
class MeshLoadCase;
}  // namespace mortise::v1

namespace mortise::simulator {

// Whether supports prescribe displacements that are not 0, as they then do in every load case.
bool MovesSupports(const v1::MeshCase& of);

// Fails with INVALID_ARGUMENT naming the first field that is wrong or missing; FAILED_PRECONDITION,
// NO_LOADS, where no load is other than 0 and no support is moved.
absl::Status CheckLoadCase(const v1::MeshLoadCase& loads, const v1::MeshCase& of,
                           const std::string& field);

}  // namespace mortise::simulator
