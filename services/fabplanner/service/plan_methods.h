// The methods of plans: made by an operation, read, listed, found by their tags, downloaded.
// fabplanner.proto says what each takes and gives; the wrappers of common/rpc what all have.
#pragma once

#include <memory>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/stream_writer.h"
#include "common/store/store.h"
#include "mortise/v1/fabplanner.pb.h"
#include "services/fabplanner/service/fabplanner.h"

namespace mortise::fabplanner::methods {

// Says that a request was checked.
struct CheckedPlan {};

// Tells what is wrong with the request, and with the design at the catalog, where that can be asked
// now.
absl::StatusOr<CheckedPlan> CheckPlan(const FabPlanner& planner, const rpc::Call& call,
                                      const v1::CreatePlanRequest& asked);
absl::StatusOr<v1::Operation> CreatePlan(const FabPlanner& planner, const rpc::Call& call,
                                         const v1::CreatePlanRequest& asked,
                                         const CheckedPlan& checked,
                                         store::Transaction& transaction);

absl::StatusOr<v1::Plan> GetPlan(const FabPlanner& planner, const rpc::Call& call,
                                 const v1::GetPlanRequest& asked);

absl::StatusOr<v1::ListPlansResponse> ListPlans(const FabPlanner& planner, const rpc::Call& call,
                                                const v1::ListPlansRequest& asked);

absl::StatusOr<v1::Plan> UpdatePlan(const FabPlanner& planner, const rpc::Call& call,
                                    const v1::UpdatePlanRequest& asked,
                                    store::Transaction& transaction);

absl::Status DownloadArtifact(const FabPlanner& planner, const rpc::Call& call,
                              const v1::DownloadArtifactRequest& asked,
                              const std::shared_ptr<rpc::StreamWriter<v1::Chunk>>& writer);

}  // namespace mortise::fabplanner::methods
