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

}  // namespace mortise::retrieval
