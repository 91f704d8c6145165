// Heights as the triangles of a mesh file, in double precision: places of surveys have seven digits
// before the point.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"
#include "mortise/v1/template.pb.h"

namespace mortise::cli {

// Returns the faces of an OBJ file as triangles, in its unit: polygons as fans about their first
// corner; groups, normals and all else are passed over. INVALID_ARGUMENT naming the line in
// `origin` that is at fault: "scan.obj: line 12".
absl::StatusOr<v1::HeightTriangles> ParseObjGround(std::string_view text,
                                                   const std::string& origin);

// Returns the triangles of an STL file, text or binary; corners at one place become one vertex.
// Likewise.
absl::StatusOr<v1::HeightTriangles> ParseStlGround(std::string_view bytes,
                                                   const std::string& origin);

}  // namespace mortise::cli
