// RetrievalService over gRPC, and what runs behind it.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"

namespace mortise::retrieval {

// Needs the peer "catalog".
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment);

}  // namespace mortise::retrieval
