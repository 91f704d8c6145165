// One design of a map as a file that people open.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::cli {

// Whether a shape is written as STL, which has the surface alone and no fields, or as VTU.
// INVALID_ARGUMENT naming "--output" for a name that ends in neither.
enum class ShapeFormat { kVtu, kStl };
absl::StatusOr<ShapeFormat> ShapeFormatOf(const std::string& file);

// Returns the file of a shape whose mesh is whole (`new_mesh` without `more`): as VTU with all its
// fields under "stress (Pa), pull", tetrahedra where the mesh has them, else triangles; as STL the
// outside. `fields` of the map say units and whether a field is of elements. INVALID_ARGUMENT
// where the answer's numbers are not those of its mesh.
absl::StatusOr<std::string> WriteShapeFile(const v1::DesignMap& map, const v1::MapShape& shape,
                                           ShapeFormat format);

}  // namespace mortise::cli
