#include "services/retrieval/service/loaded_indexes.h"

#include <google/protobuf/util/time_util.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/retrieval/index/index_file.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

absl::StatusOr<std::shared_ptr<const LoadedIndex>> Load(v1::ShapeIndex record,
                                                        store::BlobFolder& blobs) {
  const std::string id = IndexIdOf(record.shape_descriptor());
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<Descriptor> descriptor, MakeDescriptor(id));
  const auto damaged = [&](const absl::Status& status) {
    return PreconditionFailed(
        "INDEX_DAMAGED",
        absl::StrCat("the index cannot be used, and must be built again: ", status.message()),
        record.name());
  };
  if (record.sha256().empty()) {
    return PreconditionFailed("INDEX_EMPTY", "the index has no template that could be covered",
                              record.name());
  }
  const absl::StatusOr<std::filesystem::path> path = blobs.PathOf(record.sha256());
  if (!path.ok()) return damaged(path.status());
  absl::StatusOr<StoredIndex> stored = ReadIndex(*path, id);
  if (!stored.ok()) return damaged(stored.status());
  return std::make_shared<const LoadedIndex>(LoadedIndex{.record = std::move(record),
                                                         .descriptor = std::move(descriptor),
                                                         .primitives = std::move(stored->index)});
}

}  // namespace

absl::StatusOr<std::shared_ptr<const LoadedIndex>> LoadedIndexes::Get(
    v1::ShapeDescriptor descriptor) {
  const std::string name = absl::StrCat(kIndexes.names, "/", IndexIdOf(descriptor));
  absl::StatusOr<v1::ShapeIndex> record = kIndexes.Get(*store_, name);
  if (absl::IsNotFound(record.status())) {
    return PreconditionFailed(
        "INDEX_MISSING",
        absl::StrCat("there is no index by ", IndexIdOf(descriptor), " yet: build it first"), name);
  }
  MORTISE_RETURN_IF_ERROR(record.status());
  const std::lock_guard lock(mutex_);
  std::shared_ptr<const LoadedIndex>& loaded = loaded_[descriptor];
  const bool is_current = loaded != nullptr && loaded->record.sha256() == record->sha256() &&
                          loaded->record.build_time() == record->build_time();
  if (!is_current) {
    MORTISE_ASSIGN_OR_RETURN(loaded, Load(*std::move(record), *blobs_));
  }
  return loaded;
}

}  // namespace mortise::retrieval
