// Makes shapes that stretch with their box of solids of the CAD kernel, and solids of shapes.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/mesh/shapes/drawn_shape.h"

namespace mortise::cad {

// Returns the shape of `solid` turned by `rotation`: triangles and exact surfaces. `minimum` and
// `maximum` are the corners, m, of the box of the solid so turned.
//
// INVALID_ARGUMENT, "shape", if the kernel cannot triangulate or stretch it, and as
// mesh::MakeDrawnShape.
absl::StatusOr<mesh::DrawnShape> ShapeOfSolid(const Solid& solid, const Eigen::Matrix3d& rotation,
                                              const Eigen::Vector3d& minimum,
                                              const Eigen::Vector3d& maximum);

// Returns the shape stretched into a box with the lower corner at the origin. Exact surfaces are
// stretched exactly: flat faces stay planes, and cylinders and cones stay such where their section
// is not stretched differently, as bores do between levels at their sides (StretchSolid). A shape
// of triangles only has a plane for each. Levels divide the shape (mesh::ShapeLevel), and its
// triangles are divided there (mesh::DividedAt).
//
// INVALID_ARGUMENT, "shape", if no such solid can be made, naming the faces at fault, and for what
// is only a surface.
absl::StatusOr<Solid> SolidOfShape(const mesh::DrawnShape& shape, const mesh::BoxStretch& stretch,
                                   const std::string& name);

// Returns a shape that was turned (DrawnShape::turn) as if it had been drawn so, with the same
// triangles: its exact solid is turned, too, and it has no name yet. INVALID_ARGUMENT, "shape", if
// the kernel fails.
absl::StatusOr<mesh::DrawnShape> ShapeDrawnTurned(const mesh::DrawnShape& shape);

// Returns the solid moved by `translation`, m.
Solid MovedSolid(const Solid& solid, const Eigen::Vector3d& translation);

}  // namespace mortise::cad
