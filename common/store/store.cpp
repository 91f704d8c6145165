// Chooses the driver by the URL.
#include "common/store/store.h"

#include <string_view>
#include <utility>

#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/store/postgresql_store.h"
#include "common/store/sqlite_store.h"

namespace mortise::store {
namespace {

absl::Status CheckOptions(const StoreOptions& options) {
  if (!IsResourceId(options.service)) {
    return InvalidField("service", "must be lower-case letters, digits and hyphens");
  }
  if (options.connections < 1 || options.connections > 1000) {
    return InvalidField("connections", "must be 1 to 1000");
  }
  if (!options.clock) return InvalidField("clock", "must be set");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<Store>> OpenStore(const StoreOptions& options) {
  constexpr std::string_view kSqlite = "sqlite:";
  MORTISE_RETURN_IF_ERROR(CheckOptions(options));
  std::unique_ptr<BlobFolder> blobs;
  if (!options.blob_folder.empty()) {
    MORTISE_ASSIGN_OR_RETURN(blobs, BlobFolder::Open(options.blob_folder));
  }
  if (options.url.starts_with(kSqlite) && options.url.size() > kSqlite.size()) {
    return OpenSqliteStore(options.url.substr(kSqlite.size()), options, std::move(blobs));
  }
  if (options.url.starts_with("postgresql://") || options.url.starts_with("postgres://")) {
    return OpenPostgresqlStore(options, std::move(blobs));
  }
  return InvalidField("url", "must be sqlite:<path> or postgresql://<connection>");
}

}  // namespace mortise::store
