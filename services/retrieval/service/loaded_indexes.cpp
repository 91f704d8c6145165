#include "services/retrieval/service/loaded_indexes.h"

#include <google/protobuf/util/time_util.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

absl::Status Damaged(const v1::ShapeIndex& record, const absl::Status& status) {
  return PreconditionFailed(
      "INDEX_DAMAGED",
      absl::StrCat("the index cannot be used, and must be built again: ", status.message()),
      record.name());
}

// Whether an index has families that can be searched, and says of them what answers need.
absl::Status CheckRecord(const v1::ShapeIndex& record, const Descriptor& descriptor) {
  if (!IsOfThisVersion(record, descriptor)) {
    return PreconditionFailed(
        "INDEX_OUTDATED",
        "the index is of another version of the service, and is being built again", record.name());
  }
  if (record.sha256().empty()) {
    return PreconditionFailed("INDEX_EMPTY", "the index has no template that could be covered",
                              record.name());
  }
  return absl::OkStatus();
}

// Every family that can be found is one of the record.
absl::Status CheckFamilies(const v1::ShapeIndex& record, const PrimitiveIndex& primitives) {
  const auto& families = primitives.arrays().families;  // ascending, from 0 on
  if (families.empty() || families.back() < record.families_size()) return absl::OkStatus();
  return absl::DataLossError("its file has more families than its record");
}

}  // namespace

LoadedIndexes::LoadedIndexes(store::Store* store, store::BlobFolder* blobs, Reader read)
    : store_(store), blobs_(blobs), read_(std::move(read)) {
  for (const v1::ShapeDescriptor each : AllShapeDescriptors()) slots_[IndexIdOf(each)];
}

absl::StatusOr<std::shared_ptr<const LoadedIndex>> LoadedIndexes::Load(
    v1::ShapeIndex record) const {
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<Descriptor> descriptor,
                           MakeDescriptor(IndexIdOf(record.shape_descriptor())));
  MORTISE_RETURN_IF_ERROR(CheckRecord(record, *descriptor));
  const absl::StatusOr<std::filesystem::path> path = blobs_->PathOf(record.sha256());
  if (!path.ok()) return Damaged(record, path.status());
  // From before it is read: what happens to it meanwhile shows later.
  const FileStamp stamp = StampOf(*path);
  absl::StatusOr<StoredIndex> stored = read_(*path, FormatOf(*descriptor));
  if (!stored.ok()) return Damaged(record, stored.status());
  const absl::Status fits = CheckFamilies(record, stored->index);
  if (!fits.ok()) return Damaged(record, fits);
  return std::make_shared<const LoadedIndex>(LoadedIndex{.record = std::move(record),
                                                         .descriptor = std::move(descriptor),
                                                         .primitives = std::move(stored->index),
                                                         .stamp = stamp});
}

absl::StatusOr<std::shared_ptr<const LoadedIndex>> LoadedIndexes::Get(
    v1::ShapeDescriptor descriptor) {
  const std::string id = IndexIdOf(descriptor);
  const std::string name = absl::StrCat(kIndexes.names, "/", id);
  absl::StatusOr<v1::ShapeIndex> record = kIndexes.Get(*store_, name);
  if (absl::IsNotFound(record.status())) {
    const std::lock_guard lock(slots_.at(id).mutex);
    slots_.at(id).loaded = nullptr;
    return PreconditionFailed("INDEX_MISSING",
                              absl::StrCat("there is no index by ", id,
                                           " yet: build it first, as with 'mortise index build "
                                           "--descriptor ",
                                           id, "'"),
                              name);
  }
  MORTISE_RETURN_IF_ERROR(record.status());
  const absl::StatusOr<std::filesystem::path> path = blobs_->PathOf(record->sha256());
  Slot& slot = slots_.at(id);
  const std::lock_guard lock(slot.mutex);
  std::shared_ptr<const LoadedIndex>& loaded = slot.loaded;
  const bool is_current = loaded != nullptr && loaded->record.sha256() == record->sha256() &&
                          loaded->record.build_time() == record->build_time() &&
                          loaded->record.current() == record->current() && path.ok() &&
                          loaded->stamp == StampOf(*path);
  if (!is_current) {
    loaded = nullptr;
    MORTISE_ASSIGN_OR_RETURN(loaded, Load(*std::move(record)));
  }
  return loaded;
}

}  // namespace mortise::retrieval
