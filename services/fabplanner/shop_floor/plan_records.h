// Plans in the store: each whole (kind "plans"), and again without its contents (kind
// "planSummaries"), so that a list does not read megabytes of cuts.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/resources/collection.h"
#include "common/store/store.h"
#include "mortise/v1/fabplanner.pb.h"

namespace mortise::fabplanner {

inline constexpr resources::Collection<v1::Plan> kPlans{
    .names = "plans", .kind = "plans", .event = "plan"};
inline constexpr resources::Collection<v1::Plan> kPlanSummaries{
    .names = "plans", .kind = "planSummaries", .event = nullptr};

// Writes both records of a new plan. ABORTED, STALE_REVISION if there is one of its name.
absl::Status CreatePlanRecords(store::Transaction& transaction, const v1::Plan& plan);

// Changes the external ids and labels of a plan in both records, and tells of it ("plan.updated").
// Returns the whole plan. NOT_FOUND; INVALID_ARGUMENT naming fields of the request.
absl::StatusOr<v1::Plan> UpdatePlanTags(store::Transaction& transaction,
                                        const v1::UpdatePlanRequest& request,
                                        const resources::Author& author);

}  // namespace mortise::fabplanner
