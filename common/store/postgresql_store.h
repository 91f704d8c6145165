// The store in a PostgreSQL database.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "common/store/store.h"

namespace mortise::store {

// See OpenStore.
absl::StatusOr<std::unique_ptr<Store>> OpenPostgresqlStore(const StoreOptions& options,
                                                           std::unique_ptr<BlobFolder> blobs);

}  // namespace mortise::store
