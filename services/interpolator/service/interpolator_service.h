// The gRPC service of maps of design spaces (mortise.v1.InterpolatorService).
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"

namespace mortise::interpolator {

// Makes the service on the environment's store and blobs, and registers its operations. Evaluations
// are asked of the peer "simulator"; changes of templates are heard of from the peer "catalog".
// `disk_quota`: bytes that all maps together may take.
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, double disk_quota);

}  // namespace mortise::interpolator
