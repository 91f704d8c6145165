// Brings the shape of one surface into the triangulation of another of the same design (thesis
// §6.6.2, surface mapping).
//
// The patches of a common layout are flattened into the same convex regions (disk_map.h), with the
// points on the boundary at the mean of both surfaces' shares of its length. A vertex of the target
// that is within a patch goes to where the source's patch has the same place in the region, one on
// a path to the same share of the path's length. As both have the same vertices on the boundaries,
// what is composed is a homeomorphism of the two surfaces, linear within triangles of their common
// refinement.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "absl/status/statusor.h"
#include "services/interpolator/mapping/disk_map.h"
#include "services/interpolator/mapping/marked_surface.h"
#include "services/interpolator/mapping/patch_layout.h"

namespace mortise::interpolator {

struct SurfaceMap {
  Eigen::Matrix3Xd positions;         // 3 × target's vertices, m, on the source's surface
  std::vector<TrianglePlace> places;  // of each: where in which of the source's triangles
  int points = 0;                     // how many both have
  int given_paths = 0;                // of the layout, from the surfaces
  int added_paths = 0;
  int patches = 0;
};

// Maps every vertex of the target's surface. Vertices that no triangle names become 0, their place
// −1. Fails as BuildPatchLayout, and INTERNAL as DiskMap does.
absl::StatusOr<SurfaceMap> MapSurface(const MarkedSurface& source, const MarkedSurface& target,
                                      const LayoutOptions& options = {});

}  // namespace mortise::interpolator
