// Finds where parts pass each other closely without touching. Private to this folder: it brings
// Open CASCADE.
#pragma once

#include <vector>

#include "common/cad/surface/solid_fusion.h"

namespace mortise::cad {

// Two faces of different parts, on the outside of the fused assembly, that share no point.
struct FaceGap {
  int first = 0;  // index into SolidFusion::faces()
  int second = 0;
  double width = 0;  // m, where it is narrowest
  // True if the faces face each other across the gap, as a tenon and its bore do, or their parts
  // meet nowhere. Faces that are set off sideways do not.
  bool is_between = false;
};

// Returns the gaps no wider than `reach`, or wider by no more than the two faces' triangles may
// miss together. `misses` are those distances of each face, m; 0 for planes. Where parts meet,
// faces that look the same way are passed over: their triangles do not cross.
std::vector<FaceGap> FindGaps(const SolidFusion& fusion, double reach,
                              const std::vector<double>& misses);

}  // namespace mortise::cad
