// The indexes that are searched, each read once.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "absl/status/statusor.h"
#include "common/store/blob_folder.h"
#include "common/store/store.h"
#include "mortise/v1/retrieval.pb.h"
#include "services/retrieval/descriptors/descriptor.h"
#include "services/retrieval/index/file_stamp.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::retrieval {

// An index as it was stored, ready to be asked.
struct LoadedIndex {
  v1::ShapeIndex record;
  std::unique_ptr<Descriptor> descriptor;
  PrimitiveIndex primitives;
  FileStamp stamp = {};  // of the file that they are searched in
};

// Thread safe.
class LoadedIndexes {
 public:
  // Both outlive it.
  LoadedIndexes(store::Store* store, store::BlobFolder* blobs) : store_(store), blobs_(blobs) {}

  // The index of a descriptor as it is stored now. A file that was touched since it was read is
  // read and checked again. FAILED_PRECONDITION: INDEX_MISSING, where there is none; INDEX_EMPTY,
  // where it has no template; INDEX_DAMAGED,
  // where its file is damaged, gone or of another version, and building it again mends it;
  // INDEX_OUTDATED, where its record is of an earlier version, which the service is about to bring
  // up by itself. None of these is ever answered from.
  absl::StatusOr<std::shared_ptr<const LoadedIndex>> Get(v1::ShapeDescriptor descriptor);

 private:
  absl::StatusOr<std::shared_ptr<const LoadedIndex>> Load(v1::ShapeIndex record) const;

  store::Store* const store_;
  store::BlobFolder* const blobs_;
  std::mutex mutex_;
  std::map<v1::ShapeDescriptor, std::shared_ptr<const LoadedIndex>> loaded_;
};

}  // namespace mortise::retrieval
