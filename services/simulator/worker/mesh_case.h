// Checks what a case of an uploaded mesh says by itself, before anybody looks at the mesh.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace mortise::v1 {
class Material;
class MeshCase;
class MeshMaterial;
}  // namespace mortise::v1

namespace mortise::simulator {

// Fails with INVALID_ARGUMENT naming the first field that is wrong, below `field`, whatever the
// mesh: missing or unknown length unit, lists that are too long, numbers out of range or beyond
// 1e30, names that are missing, taken twice or refer to nothing, empty vectors of loads, nothing
// asked for. FAILED_PRECONDITION, NO_LOADS, for a load case without a load that is not 0, where no
// support is moved. RESOURCE_EXHAUSTED past 200 kB. That numbers are finite has been checked.
absl::Status CheckMeshCase(const v1::MeshCase& mesh_case, const std::string& field);

// Puts the catalog's numbers in the place of the material's name.
void UseCatalogMaterial(const v1::Material& material, v1::MeshMaterial& use);

}  // namespace mortise::simulator
