// mortise.v1.AssemblyService, answered by the catalog.
#pragma once

#include <memory>

#include "common/host/run_service.h"
#include "services/catalog/records/parametrization_cache.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::catalog {

// `blobs`: where drawings are kept that are uploaded; outlives it. `parametrized`: assemblies that
// others of the catalog have parametrised, too.
std::shared_ptr<grpc::Service> MakeAssemblyService(
    const rpc::ServiceEnvironment& environment, store::BlobFolder* blobs,
    std::shared_ptr<ParametrizationCache> parametrized);

}  // namespace mortise::catalog
