// Searching for a shape.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/service/retrieval.h"

namespace mortise::retrieval::methods {

// See retrieval.proto. INVALID_ARGUMENT naming each field at fault.
absl::StatusOr<v1::SearchShapesResponse> SearchShapes(const Retrieval& retrieval,
                                                      const rpc::Call& call,
                                                      const v1::SearchShapesRequest& request);

}  // namespace mortise::retrieval::methods
