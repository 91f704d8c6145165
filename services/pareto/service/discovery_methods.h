// The method of ParetoService that starts discoveries.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/operations.pb.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/service/pareto.h"

namespace mortise::pareto::methods {

// A discovery whose request is known to be usable.
struct SettledDiscovery {
  v1::DiscoverFrontRequest request;  // as it was asked, with the revision of its subject
  v1::Front start;  // the designs to begin with (discovery_start.h); no points if there are none
};

// Checks a request and asks the evaluator, which settles the revision and knows the names. Slow:
// it runs before the transaction. INVALID_ARGUMENT naming the fields, NOT_FOUND, UNAVAILABLE.
absl::StatusOr<SettledDiscovery> SettleDiscovery(const Pareto& pareto, const rpc::Call& call,
                                                 const v1::DiscoverFrontRequest& asked);

absl::StatusOr<v1::Operation> DiscoverFront(const Pareto& pareto, const rpc::Call& call,
                                            const v1::DiscoverFrontRequest& asked,
                                            SettledDiscovery& settled,
                                            store::Transaction& transaction);

}  // namespace mortise::pareto::methods
