// What an evaluator says of a subject: its parameters and metrics.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "common/rpc/channel.h"

namespace mortise::v1 {
class DescribeDesignSpaceRequest;
class DesignSpace;
}  // namespace mortise::v1

namespace mortise::evaluation {

// Returns the design space and metrics of a subject. NOT_FOUND, INVALID_ARGUMENT and what else the
// evaluator refuses it with; UNAVAILABLE if it stays out of reach for as long as `retry` says.
absl::StatusOr<std::unique_ptr<v1::DesignSpace>> DescribeDesignSpace(
    const std::shared_ptr<grpc::Channel>& channel, const v1::DescribeDesignSpaceRequest& request,
    const rpc::Origin& origin, const rpc::RetryOptions& retry);

}  // namespace mortise::evaluation
