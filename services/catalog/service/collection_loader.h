// Brings the collection that ships into the catalog, and later what a newer one has.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/store/store.h"
#include "services/catalog/records/parametrization_cache.h"

namespace mortise::catalog {

// What came of it, by name.
struct CollectionReport {
  std::vector<std::string> created;
  std::vector<std::string> updated;
  std::vector<std::string>
      kept;  // a user's own, or changed by a user, where the collection differs
  std::vector<std::string> failed;  // "items/x: why": cannot be brought in beside what is there
};

// Loads the folder into the store in one transaction. An empty store takes all of it:
// INVALID_ARGUMENT or NOT_FOUND with the file and what is wrong with it, and nothing is stored. A
// store that is not empty takes what is new, and new revisions of what is still as it was shipped;
// what users changed, made or removed stays as it is, and the template that exposes an assembly
// goes with it. External ids and labels are users': they stay in any case, and what has got some
// still is as it was shipped. Shapes come with the items and assemblies that name them. Templates
// and assemblies keep the items and materials that they were made with until they are replaced
// themselves. What a store already has of the folder it does not take again. Of a folder with a
// lower number than one that was loaded before, nothing is taken. What cannot be brought in is in
// `failed` once, and tried again when it or the number has changed. A folder that cannot be read is
// said to be in `failed`, and leaves such a store as it is. Several may load into one store at the
// same time; UNAVAILABLE if others get in the way for minutes. Assemblies are parametrised on the
// way, and stay so in `parametrized`.
absl::StatusOr<CollectionReport> LoadCollection(store::Store& store,
                                                const std::filesystem::path& folder,
                                                ParametrizationCache& parametrized);

}  // namespace mortise::catalog
