// Lists the templates of the catalog, for services that work on all of them.
#pragma once

#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "common/rpc/channel.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::bundles {

// Returns the latest revisions that the request asks for, of all its pages, by name and without
// what they are made of. Fails as IsPassingFailure; INVALID_ARGUMENT as the catalog tells it.
absl::StatusOr<std::vector<v1::Template>> ListTemplates(
    const std::shared_ptr<grpc::Channel>& catalog, v1::ListTemplatesRequest request,
    const rpc::Origin& origin, const rpc::RetryOptions& retry = {});

}  // namespace mortise::bundles
