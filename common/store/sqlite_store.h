// The store in one SQLite file.
#pragma once

#include <filesystem>
#include <memory>

#include "absl/status/statusor.h"
#include "common/store/store.h"

namespace mortise::store {

// `path` is the part of the URL after "sqlite:". See OpenStore.
absl::StatusOr<std::unique_ptr<Store>> OpenSqliteStore(const std::filesystem::path& path,
                                                       const StoreOptions& options,
                                                       std::unique_ptr<BlobFolder> blobs);

}  // namespace mortise::store
