// The convex region of the plane that both surfaces' patches are flattened into. Private to this
// folder.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "services/interpolator/mapping/patch_layout.h"

namespace mortise::interpolator {

// A stretch of the boundary of a patch, from one of its corners to the next.
struct BoundarySide {
  double share = 0;            // of the whole boundary's length
  std::vector<double> places;  // of its vertices, as shares of its length: from 0, below 1
};

// Returns where the vertices of the sides go, counter-clockwise in their order, on a strictly
// convex curve. The corners lie on the unit circle at the shares of the length. Between them run
// parabolas that turn by `bulge` times as much as the circle does, 0 < bulge < 1: a rectangle
// becomes nearly one. With fewer than three sides all is on the circle.
Eigen::Matrix2Xd RegionBoundary(const std::vector<BoundarySide>& sides, double bulge = 0.2);

// Returns where the boundary of a patch goes, the same for both surfaces: as many positions as its
// boundary has vertices. Shares are the means of those of both surfaces. Corners are the points
// where both surfaces' patches together have an angle of less than 150 degrees on average.
Eigen::Matrix2Xd RegionOf(const PatchLayout& layout, std::size_t patch);

}  // namespace mortise::interpolator
