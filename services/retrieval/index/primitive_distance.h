// Distances of descriptors from primitives that are laid out in flat arrays.
#pragma once

#include <cstdint>

#include "services/retrieval/index/index_arrays.h"

namespace mortise::retrieval {

// As Distance of primitive.h, in an order of additions that does not depend on where the numbers
// lie in memory, so that it is the same to the bit in every process. `x` has N numbers, `offset` is
// room for N more.
double DistanceFrom(const IndexArrays& arrays, const PrimitiveEntry& primitive, const double* x,
                    double* offset);

// What lies between a descriptor and the box around a primitive's ellipsoid, along its axes.
struct BoxOffset {
  double center_square = 0;  // of the distance from the centre
  double box_square = 0;     // of the distance from the box, which is convex
};

// Returns the offset of `x` from the primitive's box; what of it lies within, from the centre along
// each axis, is written to `within`, with room for as many numbers as there are axes.
BoxOffset OffsetFromBox(const IndexArrays& arrays, const PrimitiveEntry& primitive, const double* x,
                        double* offset, double* within);

}  // namespace mortise::retrieval
