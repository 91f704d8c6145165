// Fills an empty catalog with the collection that ships.
#pragma once

#include <filesystem>

#include "absl/status/status.h"
#include "common/store/store.h"

namespace mortise::catalog {

// Loads the folder into the store in one transaction, if the store has no materials, items,
// templates and assemblies yet; otherwise nothing happens. INVALID_ARGUMENT or NOT_FOUND with the
// file and what is wrong with it; nothing is stored then.
absl::Status LoadCollectionIfEmpty(store::Store& store, const std::filesystem::path& folder);

}  // namespace mortise::catalog
