// The service of notes.
#pragma once

#include "common/host/run_service.h"

namespace mortise::notes {

absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment);

}  // namespace mortise::notes
