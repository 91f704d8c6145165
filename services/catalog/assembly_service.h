// mortise.v1.AssemblyService, answered by the catalog.
#pragma once

#include <memory>

#include "common/rpc/run_service.h"

namespace mortise::catalog {

std::shared_ptr<grpc::Service> MakeAssemblyService(const rpc::ServiceEnvironment& environment);

}  // namespace mortise::catalog
