// What a build has found out of shapes, in the store, beside the answers of evaluators.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "services/interpolator/building/known_shapes.h"

namespace mortise::interpolator {

// Returns all that is kept for the build of this id, by the sampling and mapping of this version.
// DATA_LOSS where it cannot be read.
absl::StatusOr<KnownShapes> LoadShapes(store::Store& store, const std::string& id);

// Keeps what was found out since the last time, each thing once, as a record of its own.
absl::Status PutShapes(store::Transaction& transaction, const std::string& id,
                       const KnownShapes& known);

// Forgets all that is kept for the build.
absl::Status DropShapes(store::Transaction& transaction, const std::string& id);

}  // namespace mortise::interpolator
