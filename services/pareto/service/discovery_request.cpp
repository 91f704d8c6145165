#include "services/pareto/service/discovery_request.h"

#include "common/base/errors.h"

namespace mortise::pareto {

absl::StatusOr<v1::DiscoverFrontRequest> ReadDiscoveryRequest(const std::string& operation,
                                                              const std::string& bytes) {
  v1::DiscoverFrontRequest request;
  // The second field of a specification is a number and that of a request a message, so that a
  // specification by itself never reads as a request that has one.
  if (request.ParseFromString(bytes) && request.has_specification()) return request;
  request.Clear();
  if (request.mutable_specification()->ParseFromString(bytes)) return request;
  return StorageFailed(operation, "the stored request cannot be read");
}

}  // namespace mortise::pareto
