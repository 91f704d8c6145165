// Tasks of the store as messages of mortise/v1/simulator.proto.
#pragma once

#include "absl/status/statusor.h"
#include "common/store/types.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::simulator {

// Returns the task's payload (a serialised v1.Task without its name) with name, attempt, lease and
// state. INTERNAL, STORAGE_FAILED naming the task, if the payload is damaged.
absl::StatusOr<v1::Task> ToProto(const store::Task& task);

}  // namespace mortise::simulator
