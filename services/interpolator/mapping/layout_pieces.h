// Tells what bounds the patches of a layout, and compares two layouts. Private to this folder.
#pragma once

#include <vector>

#include "absl/status/status.h"
#include "services/interpolator/mapping/layout_surface.h"
#include "services/interpolator/mapping/marked_surface.h"

namespace mortise::interpolator {

// A connected piece of the boundary of a patch: its corners in order, or one lone node.
using BoundaryPiece = std::vector<Corner>;

struct PatchPieces {
  std::vector<BoundaryPiece> pieces;
  int genus = 0;
};

// Returns the pieces of each patch, whose labels are up to date.
std::vector<PatchPieces> FindPieces(const LayoutSurface& surface);

// Returns the paths of `both` that lie in the same cyclic order around their ends on both surfaces.
// Of paths at odds with one another the first stays.
std::vector<Correspondence::Path> OrderedPaths(const LayoutSurface& source,
                                               const LayoutSurface& target,
                                               const Correspondence& both);

// Fails with TOPOLOGY_DIFFERS, naming a point, unless corresponding patches have the same corners
// and handles, and with PATCH_NOT_SIMPLE if one has handles.
absl::Status ComparePieces(const std::vector<PatchPieces>& source,
                           const std::vector<PatchPieces>& target, const LayoutSurface& surface,
                           const Correspondence& both);

}  // namespace mortise::interpolator
