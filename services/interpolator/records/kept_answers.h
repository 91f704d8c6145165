// The answers of evaluators while a map is built, in the store.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "services/interpolator/building/map_building.h"

namespace mortise::interpolator {

// Returns all that is kept for the build of this id. DATA_LOSS where it cannot be read.
absl::StatusOr<KnownAnswers> LoadAnswers(store::Store& store, const std::string& id);

// Keeps the answers of one batch, as a record of its own.
absl::Status PutAnswers(store::Transaction& transaction, const std::string& id,
                        const KnownAnswers& answers);

// Forgets all that is kept for the build.
absl::Status DropAnswers(store::Transaction& transaction, const std::string& id);

}  // namespace mortise::interpolator
