// Whether the arrays of an index refer only to what is there.
#pragma once

#include "services/retrieval/index/index_arrays.h"

namespace mortise::retrieval {

// Returns whether sizes are those of the arrays and every place that an entry refers to lies in its
// array, so that a search reads nothing else and comes to an end. O(primitives + nodes).
bool AreConsistent(const IndexArrays& arrays);

}  // namespace mortise::retrieval
