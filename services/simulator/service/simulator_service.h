// The simulator over gRPC: SimulatorService and EvaluatorService of one process.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"

namespace mortise::simulator {

// Makes the services of this program; it needs --peer catalog=ADDRESS.
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment);

}  // namespace mortise::simulator
