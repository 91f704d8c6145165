// How far tasks are, as their workers tell with renewals: kept beside the task for whichever
// replica of the service is asked.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::simulator {

// Fails with INVALID_ARGUMENT naming "`field`.stage", ".done" or ".total".
absl::Status CheckProgress(const v1::TaskProgress& progress, const std::string& field);

// Keeps what an attempt tells. Within an attempt `done` never falls: what says less is left out. To
// be called in the transaction that renewed the attempt's lease, which keeps others from the task.
absl::Status KeepProgress(store::Transaction& transaction, const std::string& key,
                          const v1::TaskAttempt& told);

// Returns what the present attempt has told; absent if nothing, or if its lease is over.
absl::StatusOr<std::optional<v1::TaskProgress>> FindProgress(store::ReadTransaction& transaction,
                                                             const store::Task& task,
                                                             absl::Time now);

// Returns the keys of tasks of which something was told and that have ended or are gone.
absl::StatusOr<std::vector<std::string>> FindOldProgress(store::ReadTransaction& transaction);

// Removes what was told of a task; OK if nothing was.
absl::Status ForgetProgress(store::Transaction& transaction, const std::string& key);

}  // namespace mortise::simulator
