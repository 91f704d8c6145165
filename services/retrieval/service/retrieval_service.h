// RetrievalService over gRPC, and what runs behind it.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"

namespace mortise::retrieval {

// Needs the peer "catalog". `cover_threads`: of the service's own that make covers for indexes; 0
// leaves all to workers.
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, int cover_threads);

}  // namespace mortise::retrieval
