// The catalog's gRPC services (mortise.v1.CatalogService and AssemblyService).
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"

namespace mortise::catalog {

// Makes the services on the environment's store. With a `collection` folder, the store first
// takes what it lacks of it (collection_loader.h).
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, const std::filesystem::path& collection);

}  // namespace mortise::catalog
