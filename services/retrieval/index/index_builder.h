// Lays primitives out for a search: principal components, a tree, flat arrays.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/index/index_arrays.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::retrieval {

// Returns what PrimitiveIndex::Build makes, and fails with.
absl::StatusOr<OwnedArrays> BuildArrays(std::vector<FamilyCover> covers);

}  // namespace mortise::retrieval
