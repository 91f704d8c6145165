// The building of a map as a long-running operation: it survives restarts of this service and of
// the evaluator.
//
// The answers of the evaluator are stored as they come, each batch as a record of its own. They are
// the whole state of a build: one that begins again tells them to a fresh one and goes on where the
// last run ended, to the same map, and asks for nothing again.
//
// What is found out of shapes is kept likewise, after the files that it names have been written to
// the folder of blobs, of the quota of disk.
//
// A map is written to its file before its record names it, both the record and the removal of the
// answers in one transaction: there is never a map without its file, nor half of one.
#pragma once

#include <functional>
#include <string>

#include "absl/status/statusor.h"
#include "common/host/run_service.h"
#include "common/operations/operations.h"
#include "services/interpolator/records/disk_quota.h"

namespace mortise::interpolator {

// Runs the operation whose request, a BuildMapRequest, has its revision settled. Writes the map and
// the event `map.created`, tells `stored` of the subject, and returns the map.
// RESOURCE_EXHAUSTED, DISK_QUOTA or DISK_FULL, where it would take more disk than there is.
absl::StatusOr<std::string> RunBuildOperation(
    rpc::ServiceEnvironment& environment, DiskQuota& quota, operations::OperationContext& context,
    const std::function<void(const std::string& subject)>& stored);

}  // namespace mortise::interpolator
