// The primitives of one family that come nearest to a query.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::retrieval {

// Returns the `query.count` primitives of the family nearest to the query, each at its best turn,
// nearest first, then of each structure that these do not have its nearest, `query.count` more at
// most; of equal distances the smaller number first. None where the index has no such family.
// `query.allowed` is not asked. By looking at each of the family's primitives; INVALID_ARGUMENT as
// PrimitiveIndex::Nearest.
absl::StatusOr<std::vector<IndexMatch>> NearestOfFamily(const PrimitiveIndex& index,
                                                        const IndexQuery& query, int family);

}  // namespace mortise::retrieval
