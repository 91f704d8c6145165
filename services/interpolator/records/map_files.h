// Which files the shapes of a map are in, in the store: so that the upkeep knows them without
// reading the map, and whatever becomes of its own file.
#pragma once

#include <set>
#include <string>

#include "absl/status/status.h"
#include "common/store/store.h"
#include "services/interpolator/records/stored_map.h"

namespace mortise::interpolator {

// Writes the digests of all files that the shapes of the map of this id are in.
absl::Status PutMapFiles(store::Transaction& transaction, const std::string& id,
                         const std::vector<StoredShapes>& shapes);

// Forgets them; OK where there are none.
absl::Status DropMapFiles(store::Transaction& transaction, const std::string& id);

// Adds those of all maps. DATA_LOSS where they cannot be read.
absl::Status AddMapFiles(store::ReadTransaction& transaction, std::set<std::string>* named);

}  // namespace mortise::interpolator
