// The simulator over gRPC: SimulatorService and EvaluatorService of one process.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"

namespace mortise::simulator {

inline constexpr double kDefaultFileQuota = 100e9;  // bytes

// Makes the services of this program; it needs --peer catalog=ADDRESS. `file_quota`: bytes that all
// files together may take.
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, double file_quota);

}  // namespace mortise::simulator
