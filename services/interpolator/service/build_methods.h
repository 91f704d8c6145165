// The methods of InterpolatorService that start operations.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "mortise/v1/interpolator.pb.h"
#include "mortise/v1/operations.pb.h"
#include "services/interpolator/service/interpolator.h"

namespace mortise::interpolator::methods {

// Checks a request and asks the evaluator, which settles the revision and knows the names; returns
// the request with that revision. Slow: it runs before the transaction. INVALID_ARGUMENT naming the
// fields, NOT_FOUND, UNAVAILABLE.
absl::StatusOr<v1::BuildMapRequest> SettleMap(const Interpolator& interpolator,
                                              const rpc::Call& call,
                                              const v1::BuildMapRequest& asked);

absl::StatusOr<v1::Operation> BuildMap(const Interpolator& interpolator, const rpc::Call& call,
                                       const v1::BuildMapRequest& asked,
                                       v1::BuildMapRequest& settled,
                                       store::Transaction& transaction);

// INVALID_ARGUMENT naming the fields, as EvaluateMap names points; NOT_FOUND.
absl::StatusOr<v1::Operation> VerifyMap(const Interpolator& interpolator, const rpc::Call& call,
                                        const v1::VerifyMapRequest& asked,
                                        store::Transaction& transaction);

}  // namespace mortise::interpolator::methods
