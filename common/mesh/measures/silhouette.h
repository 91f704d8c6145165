// Measures the shadow that solids cast in parallel light.
#pragma once

#include <Eigen/Core>
#include <span>

#include "common/mesh/surface_mesh.h"

namespace mortise::mesh {

// Returns the area of the union of the solids' projections along `direction` (any length but zero,
// either way), m². Surfaces are closed and outward; solids may touch, overlap and hide each other.
//
// The triangles that face the light cover each point of the shadow at least once, so the shadow is
// where the boundaries of what faces the light wind around a point (Boost.Polygon's union). The
// area is exact for polyhedra but for rounding: coordinates are rounded to a grid of 2^-28 of the
// shadow's extent, which changes the area by at most its perimeter times twice that. It takes O(T
// log T), and O(log) for each crossing of the contours.
double ProjectedArea(std::span<const SurfaceMesh> solids, const Eigen::Vector3d& direction);

}  // namespace mortise::mesh
