// Decides which pieces of a surface are one part.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/mesh/parts/surface_pieces.h"

namespace mortise::mesh {

struct PartGroupingOptions {
  std::size_t most_parts = 40;  // at least 1
  // Pieces no further apart than this share of the scene's diagonal touch.
  double contact = 2e-3;
  // Whether pieces of other components of the scene are joined only where those of the same one
  // cannot be, as the components have names.
  bool keeps_components = false;
};

// Pieces as parts.
struct PartGrouping {
  std::vector<int>
      part_of;    // of each piece, numbered from 0 in the order of the pieces; -1: left out
  int count = 0;  // of parts
  // Of each part, whether it comes near another, but touches none of those only by a gap.
  std::vector<bool> has_gap;
  std::vector<std::string> notes;  // whole sentences: what was left out and joined
};

// Returns the parts that the pieces make. A piece is a part, except:
//
//   doubled    of pieces at the same place with the same corners all but the first are left out
//   decals     a flat piece that lies within the box of one it touches becomes part of that
//   floating   where pieces do not hang together by contact, the two that are nearest to each other
//              become one part, until all hang together
//   too many   with more than `most_parts`, the smallest (by the diagonals of their boxes) become
//              part of one that they touch: of those of the same component if components are kept,
//              the one whose box grows least. Parts as large as the last that went go with it.
//
// All of it is our own. INVALID_ARGUMENT for pieces without triangles. Beyond 200 pieces, the
// smallest are joined with larger ones by their boxes first, so that it takes O(P log P) for P
// pieces, and the distances of triangles of those 200 whose boxes meet (proximity.h).
absl::StatusOr<PartGrouping> GroupPieces(const std::vector<SurfacePiece>& pieces,
                                         const PartGroupingOptions& options = {});

// Whether two surfaces have the same area, and the same corners, to within `tolerance`, if the
// second is moved by `translation`.
bool AreAlike(const SurfaceMesh& a, const SurfaceMesh& b, const Eigen::Vector3d& translation,
              double tolerance);

}  // namespace mortise::mesh
