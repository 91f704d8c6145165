// The methods of SimulatorService by which workers get tasks and tell of them, and by which others
// look at the queue.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/rpc/handler.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/service/simulator.h"

namespace mortise::simulator::methods {

// Answers when there are tasks, when the caller's patience is over, or when it has gone.
absl::Status LeaseTasks(const Simulator& simulator, const rpc::Call& call,
                        const v1::LeaseTasksRequest& asked,
                        rpc::Responder<v1::LeaseTasksResponse> respond);

absl::StatusOr<v1::RenewLeasesResponse> RenewLeases(const Simulator& simulator,
                                                    const rpc::Call& call,
                                                    const v1::RenewLeasesRequest& asked);

// Takes what a worker says of its attempt, which becomes the task's end or its next try. It may
// hold numbers that are not finite: then the task has failed with NOT_FINITE, and the report is
// INVALID_ARGUMENT with their fields.
absl::StatusOr<v1::ReportTaskResponse> ReportTask(const Simulator& simulator, const rpc::Call& call,
                                                  const v1::ReportTaskRequest& asked);

// Refuses a report with numbers that are not finite. It is settled all the same: whoever
// waits for the task shall hear of it at once, not when the worker's lease has run out.
absl::Status RefuseReport(const Simulator& simulator, const rpc::Call& call,
                          const v1::ReportTaskRequest& asked);

absl::StatusOr<v1::QueueStatus> GetQueueStatus(const Simulator& simulator, const rpc::Call& call,
                                               const v1::GetQueueStatusRequest& asked);

absl::StatusOr<v1::ListTasksResponse> ListTasks(const Simulator& simulator, const rpc::Call& call,
                                                const v1::ListTasksRequest& asked);

}  // namespace mortise::simulator::methods
