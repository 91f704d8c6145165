// The methods of SimulatorService by which workers get tasks and tell of them, and by which others
// look at the queue.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/handler.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::store {
class BlobFolder;
}

namespace mortise::simulator {

class SimulatorCore;

// Answers when there are tasks, when the caller's patience is over, or when it has gone.
absl::Status LeaseTasks(SimulatorCore& core, const rpc::Call& call,
                        const v1::LeaseTasksRequest& asked,
                        rpc::Responder<v1::LeaseTasksResponse> respond);

absl::StatusOr<v1::RenewLeasesResponse> RenewLeases(SimulatorCore& core,
                                                    const v1::RenewLeasesRequest& asked);

// What a worker says of its attempt becomes the task's end, or its next try. It may hold numbers
// that are not finite: then the task has failed with NOT_FINITE, and the report is INVALID_ARGUMENT
// with their fields.
absl::StatusOr<v1::ReportTaskResponse> ReportTask(SimulatorCore& core, store::BlobFolder& blobs,
                                                  const v1::ReportTaskRequest& asked);

absl::StatusOr<v1::QueueStatus> GetQueueStatus(SimulatorCore& core,
                                               const v1::GetQueueStatusRequest& asked);

absl::StatusOr<v1::ListTasksResponse> ListTasks(SimulatorCore& core,
                                                const v1::ListTasksRequest& asked);

}  // namespace mortise::simulator
