// Makes shapes of files.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/step/step_assembly.h"
#include "common/mesh/shapes/drawn_shape.h"
#include "common/mesh/surface_mesh.h"

namespace mortise::catalog {

// Returns the surface in an STL file, binary or text, in millimetres there and metres here; corners
// at the same place are one vertex. INVALID_ARGUMENT, "file": no STL, cut off, numbers that are
// none; RESOURCE_EXHAUSTED past 50,000 triangles.
absl::StatusOr<mesh::SurfaceMesh> ReadStl(std::string_view bytes);

// A shape, and what was repaired of its file, for people.
struct ImportedShape {
  mesh::DrawnShape shape;
  std::vector<std::string> notes;
};

// Returns the one solid of an STL file, repaired if it is not closed (mesh/surface_repair.h).
// Errors as ReadStl's, RepairSurface's and mesh::ShapeOfMesh's.
absl::StatusOr<ImportedShape> ShapeOfStl(std::string_view bytes);

// Returns the one solid of a STEP file as a shape in the axes of the file. INVALID_ARGUMENT,
// "file", for several, and with all that is wrong with it.
absl::StatusOr<mesh::DrawnShape> ShapeOfStep(const cad::StepAssembly& drawing);

}  // namespace mortise::catalog
