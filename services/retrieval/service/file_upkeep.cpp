#include "services/retrieval/service/file_upkeep.h"

#include <chrono>
#include <set>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/host/unused_files.h"
#include "common/operations/operations.h"
#include "services/retrieval/service/index_records.h"
#include "services/retrieval/service/uploaded_meshes.h"

namespace mortise::retrieval {
namespace {

constexpr std::chrono::hours kPause{1};
constexpr int kPage = 1000;

absl::Status AddIndexes(store::ReadTransaction& read, std::set<std::string>* named) {
  for (const v1::ShapeDescriptor kind : AllShapeDescriptors()) {
    const std::string id = IndexIdOf(kind);
    MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::ShapeIndex> covers, ListCovers(read, id));
    for (const v1::ShapeIndex& cover : covers) named->insert(cover.sha256());
    const absl::StatusOr<store::Record> record = read.Get(kIndexes.kind, id);
    if (absl::IsNotFound(record.status())) continue;
    MORTISE_RETURN_IF_ERROR(record.status());
    MORTISE_ASSIGN_OR_RETURN(const v1::ShapeIndex index,
                             resources::ParseRecord<v1::ShapeIndex>(kIndexes.kind, *record));
    named->insert(index.sha256());
  }
  return absl::OkStatus();
}

// Their keys are their digests. They are forgotten by UploadedMeshes, with their files.
absl::Status AddMeshes(store::ReadTransaction& read, std::set<std::string>* named) {
  store::ListOptions list{.limit = kPage, .without_payloads = true};
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> page, read.List(kMeshRecords, list));
    for (const store::Record& record : page) named->insert(record.key);
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    list.after_key = page.back().key;
  }
}

}  // namespace

absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      operations::Operations& operations,
                                                      const std::filesystem::path& folder) {
  rpc::NamedFiles files;
  files.by_store = [](store::ReadTransaction& read, std::set<std::string>* named) -> absl::Status {
    MORTISE_RETURN_IF_ERROR(AddIndexes(read, named));
    return AddMeshes(read, named);
  };
  return rpc::RemoveUnusedFiles(store, operations, folder, files);
}

FileUpkeep::FileUpkeep(const rpc::ServiceEnvironment& environment)
    : work_(kPause, [store = environment.store, operations = environment.operations,
                     folder = environment.options.blobs] {
        const auto removed = RemoveUnusedFiles(*store, *operations, folder);
        if (!removed.ok()) {
          Log(LogLevel::kWarning, "unused files could not be removed",
              {{"error", removed.status().ToString()}});
        } else if (removed->count > 0) {
          Log(LogLevel::kInfo, "removed files that nothing refers to",
              {{"files", removed->count}, {"bytes", removed->bytes}});
        }
      }) {}

}  // namespace mortise::retrieval
