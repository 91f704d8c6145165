#include "common/host/unused_files.h"

#include <algorithm>
#include <vector>

#include "common/base/errors.h"
#include "common/operations/operations.h"

namespace mortise::rpc {
namespace {

constexpr int kPage = 100;
// By how much the clocks of store and file system may differ, and more.
constexpr absl::Duration kClockMargin = absl::Hours(1);

// What files are named, and since when there may be some that are not named yet.
struct FileUse {
  std::set<std::string> named;
  absl::Time oldest_work = absl::InfiniteFuture();
};

absl::Status AddOperations(operations::Operations& operations, const NamedFiles& named,
                           FileUse& use) {
  std::string after;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const auto page, operations.List(after, kPage));
    for (const operations::Operation& operation : page) {
      if (operations::IsFinal(operation.state)) continue;
      use.oldest_work = std::min(use.oldest_work, operation.created_at);
      if (named.by_operation) named.by_operation(operation, &use.named);
    }
    if (static_cast<int>(page.size()) < kPage) return absl::OkStatus();
    after = page.back().name;
  }
}

absl::StatusOr<FileUse> FindUse(store::Store& store, operations::Operations& operations,
                                const NamedFiles& named) {
  FileUse use;
  // Operations first: one that ends meanwhile has named its files before the store is looked at.
  MORTISE_RETURN_IF_ERROR(AddOperations(operations, named, use));
  MORTISE_RETURN_IF_ERROR(
      store.Read([&](store::ReadTransaction& read) { return named.by_store(read, &use.named); }));
  return use;
}

}  // namespace

absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      operations::Operations& operations,
                                                      const std::filesystem::path& folder,
                                                      const NamedFiles& named) {
  const absl::Time now = store.Now();
  MORTISE_ASSIGN_OR_RETURN(const FileUse use, FindUse(store, operations, named));
  MORTISE_RETURN_IF_ERROR(store::RemoveAbandonedParts(folder, now - kAbandonedPartLife).status());
  return store::RemoveUnusedBlobs(
      folder, std::min(now - kUnusedFileLife, use.oldest_work - kClockMargin),
      [&use](const std::string& digest) { return use.named.contains(digest); });
}

absl::StatusOr<TidiedFiles> RemoveOldestFiles(store::Store& store,
                                              operations::Operations& operations,
                                              const std::filesystem::path& folder,
                                              const NamedFiles& named, const FileRoom& room) {
  const absl::Time now = store.Now();
  TidiedFiles tidied;
  MORTISE_ASSIGN_OR_RETURN(std::vector<store::BlobEntry> files, store::ListBlobs(folder));
  for (const store::BlobEntry& file : files) tidied.left += file.bytes;
  if (tidied.left <= room.most) return tidied;
  MORTISE_ASSIGN_OR_RETURN(const FileUse use, FindUse(store, operations, named));
  const absl::Time before = std::min(now - kLeastFileLife, use.oldest_work - kClockMargin);
  std::erase_if(files, [&](const store::BlobEntry& file) {
    return file.written_at >= before || use.named.contains(file.digest);
  });
  std::ranges::sort(files, {}, &store::BlobEntry::written_at);
  for (const store::BlobEntry& file : files) {
    if (tidied.left <= room.most - room.ahead) break;
    MORTISE_ASSIGN_OR_RETURN(const bool is_gone,
                             store::RemoveBlobIfOld(folder, file.digest, before));
    if (!is_gone) continue;
    ++tidied.removed.count;
    tidied.removed.bytes += file.bytes;
    tidied.left -= file.bytes;
  }
  return tidied;
}

}  // namespace mortise::rpc
