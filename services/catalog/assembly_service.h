// mortise.v1.AssemblyService, answered by the catalog.
#pragma once

#include <memory>

#include "common/rpc/run_service.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::catalog {

// `blobs`: where drawings are kept that are uploaded; outlives it.
std::shared_ptr<grpc::Service> MakeAssemblyService(const rpc::ServiceEnvironment& environment,
                                                   store::BlobFolder* blobs);

}  // namespace mortise::catalog
