// Discovery as a long-running operation: it survives restarts of this service and of the evaluator.
//
// The answers of the evaluator are stored as they come, each batch as a record of its own. They are
// the whole state of a discovery (discovery.h), so a run that begins again tells them to a fresh
// one and goes on where the last run ended, to the same front.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"
#include "common/operations/operations.h"

namespace mortise::pareto {

inline constexpr char kEvaluatorPeer[] = "simulator";

// Runs the operation whose request has its revision settled (discovery_request.h). Writes the
// front, with the external ids and labels of the request and who started the operation as its
// creator, and the event `front.created`, and returns it without points.
absl::StatusOr<std::string> RunDiscoveryOperation(rpc::ServiceEnvironment& environment,
                                                  operations::OperationContext& context);

}  // namespace mortise::pareto
