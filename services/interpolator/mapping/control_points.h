// Finds the control variables of a CAD model on a mesh of it.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "common/mesh/control_variables.h"
#include "services/interpolator/mapping/marked_surface.h"

namespace mortise::interpolator {

// Returns the surface with a vertex at each control point and a way along edges for each path. The
// vertices given come first; edges are split for points that lie between them, which leaves the
// shape as it is. A point goes to the nearest place on edges, or to a vertex within a twentieth of
// the edge. A path follows the edges that lie along it; if another path is in its way it is left
// out, as is a point that is further from the surface than a tenth of the size of the surface's box
// or comes to lie at another's vertex. The same input gives the same surface.
//
// INVALID_ARGUMENT, "surface", unless it is closed and oriented; "variables" naming the point or
// path whose numbers are no points or not finite.
absl::StatusOr<MarkedSurface> PlaceControlVariables(const mesh::SurfaceMesh& surface,
                                                    const mesh::ControlVariables& variables);

}  // namespace mortise::interpolator
