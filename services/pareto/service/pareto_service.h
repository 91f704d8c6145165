// The gRPC service of Pareto fronts (mortise.v1.ParetoService).
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"

namespace mortise::pareto {

// Makes the service on the environment's store, and registers its operations. Evaluations are asked
// of the peer "simulator".
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment);

}  // namespace mortise::pareto
