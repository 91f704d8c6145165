// Makes a drawing, as STEP files are read to, of a mesh of several components (thesis §4.6.1: one
// mesh becomes a parametric assembly).
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "common/cad/step/step_assembly.h"
#include "common/mesh/scenes/scene.h"

namespace mortise::catalog {

// The parts that a mesh may have, and has at most where nobody says how many.
inline constexpr std::size_t kMaxMeshParts = 200;
inline constexpr std::size_t kUsualMeshParts = 40;

struct MeshDrawingOptions {
  mesh::UpAxis up = mesh::UpAxis::kUnknown;  // as the file says, or else z
  std::optional<double> unit = {};  // m; as the file says, else a guess by the size, else a metre
  std::size_t most_parts = kUsualMeshParts;  // 1 to kMaxMeshParts
};

// Returns what a scene shows: its parts (mesh/parts/scene_parts.h) with their boxes and shapes, in
// metres and with z upwards, and its components of several parts as groups. `name` is that of the
// whole. Parts that fill their box have no shape, and those that are alike have one in common.
// Shapes need not be solids (mesh::ShapeOfSurface). Of parts whose boxes nearly touch the smaller
// is stretched until they do, and the shapes of others that nearly touch have a deflection so that
// they do. Its notes say what was guessed and joined.
//
// INVALID_ARGUMENT, "file": no triangles, all of them in one plane, further than 10 km from the
// origin, smaller than 0.1 mm; "most_parts". RESOURCE_EXHAUSTED, "file", for a part of more
// triangles than a shape may have.
absl::StatusOr<cad::StepAssembly> DrawingOfScene(mesh::Scene scene, const std::string& name,
                                                 const MeshDrawingOptions& options = {});

// Returns the accuracy to which planes of such a drawing that nearly lie in one are made to, m.
double ToleranceOfMesh(const cad::StepAssembly& drawing);

}  // namespace mortise::catalog
