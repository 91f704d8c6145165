// FabPlannerService over gRPC: the adapter between mortise.v1 and the planner's algorithms.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"

namespace grpc {
class Service;
}
namespace mortise::rpc {
struct ServiceEnvironment;
}

namespace mortise::fabplanner {

// Makes the services of this program, for rpc::RunService. Needs a peer "catalog" and a blob
// folder.
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment);

}  // namespace mortise::fabplanner
