// What a build has estimated of noise, in the store, beside the answers of evaluators.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "services/interpolator/building/mesh_noise.h"

namespace mortise::interpolator {

// Returns what is kept for the build of this id, by the sampling and mapping of this version;
// nothing before it was estimated. DATA_LOSS where it cannot be read.
absl::StatusOr<std::optional<MeshNoise>> LoadNoise(store::Store& store, const std::string& id);

absl::Status PutNoise(store::Transaction& transaction, const std::string& id,
                      const MeshNoise& noise);

// Forgets it.
absl::Status DropNoise(store::Transaction& transaction, const std::string& id);

}  // namespace mortise::interpolator
