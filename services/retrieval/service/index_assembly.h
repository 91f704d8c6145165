// Puts the covers of an index together.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "common/operations/operations.h"
#include "mortise/v1/catalog.pb.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/index_operation.h"

namespace mortise::retrieval {

// Stores the index of all covers that there are with the target's δ, in place of that which there
// was, and tells of it. A family's number in its file is its place in the record. The same covers
// give the same bytes, in whatever order they were made.
absl::StatusOr<v1::ShapeIndex> PutIndexTogether(const IndexBuilding& building,
                                                operations::OperationContext& context,
                                                const IndexTarget& target,
                                                const std::vector<v1::Template>& templates);

}  // namespace mortise::retrieval
