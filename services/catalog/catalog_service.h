// The catalog's gRPC service (mortise.v1.CatalogService).
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/rpc/run_service.h"

namespace mortise::catalog {

// Makes the service on the environment's store. With a `collection` folder, an empty store is
// filled from it first.
absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> MakeServices(
    rpc::ServiceEnvironment& environment, const std::filesystem::path& collection);

}  // namespace mortise::catalog
