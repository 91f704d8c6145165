// mortise.v1.AssemblyService, answered by the catalog.
#pragma once

#include <memory>

#include "common/host/run_service.h"
#include "services/catalog/service/catalog.h"

namespace mortise::catalog {

std::shared_ptr<grpc::Service> MakeAssemblyService(const rpc::ServiceEnvironment& environment,
                                                   std::shared_ptr<Catalog> catalog);

}  // namespace mortise::catalog
