// The indexes that are searched, each read once.
#pragma once

#include <filesystem>
#include <functional>
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
#include "services/retrieval/index/index_file.h"
#include "services/retrieval/index/primitive_index.h"

namespace mortise::retrieval {

// An index as it was stored, ready to be asked.
struct LoadedIndex {
  v1::ShapeIndex record;
  std::unique_ptr<Descriptor> descriptor;
  PrimitiveIndex primitives;
  FileStamp stamp = {};  // of the file that they are searched in
};

// Thread safe. An index that is being read and checked keeps nobody from the others.
class LoadedIndexes {
 public:
  // Reads the file of an index by the descriptor of this id: ReadIndex.
  using Reader = std::function<absl::StatusOr<StoredIndex>(const std::filesystem::path&,
                                                           const std::string& id)>;

  // Both outlive it.
  LoadedIndexes(store::Store* store, store::BlobFolder* blobs, Reader read = ReadIndex);

  // Returns the index of a descriptor as it is stored now. A file that was touched since it was
  // read is read and checked again. FAILED_PRECONDITION: INDEX_MISSING, where there is none;
  // INDEX_EMPTY, where it has no template; INDEX_DAMAGED, where its file is damaged, gone or of
  // another version, and building it again mends it; INDEX_OUTDATED, where its record is of an
  // earlier version, which the service is about to bring up by itself. None of these is ever
  // answered from.
  absl::StatusOr<std::shared_ptr<const LoadedIndex>> Get(v1::ShapeDescriptor descriptor);

 private:
  absl::StatusOr<std::shared_ptr<const LoadedIndex>> Load(v1::ShapeIndex record) const;

  // What is loaded of one descriptor.
  struct Slot {
    std::mutex mutex;
    std::shared_ptr<const LoadedIndex> loaded;
  };

  store::Store* const store_;
  store::BlobFolder* const blobs_;
  const Reader read_;
  std::map<std::string, Slot> slots_;  // by id, one for each descriptor there is from the start on
};

}  // namespace mortise::retrieval
