// What a discovery operation keeps as its request.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "mortise/v1/pareto.pb.h"

namespace mortise::pareto {

// Returns the request of an operation from the bytes that are stored with it: a
// mortise.v1.DiscoverFrontRequest, or what earlier versions stored, its specification alone.
// INTERNAL, STORAGE_FAILED naming `operation` for other bytes.
absl::StatusOr<v1::DiscoverFrontRequest> ReadDiscoveryRequest(const std::string& operation,
                                                              const std::string& bytes);

}  // namespace mortise::pareto
