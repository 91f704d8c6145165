// Removes files of a service's blob folder that nothing refers to any more.
#pragma once

#include <filesystem>
#include <functional>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/blob_upkeep.h"
#include "common/store/store.h"

namespace mortise::operations {
class Operations;
struct Operation;
}  // namespace mortise::operations

namespace mortise::rpc {

// How long a file stays that nothing refers to: what was uploaded and is to be used by a request
// that has not come, and what belongs to work that failed.
inline constexpr absl::Duration kUnusedFileLife = absl::Hours(24);

// How long a part of a file stays that nobody writes to.
inline constexpr absl::Duration kAbandonedPartLife = absl::Hours(1);

// How long a file stays that nothing refers to, although its room is wanted: what was uploaded a
// moment ago is about to be named, what was named a moment ago is about to be fetched.
inline constexpr absl::Duration kLeastFileLife = absl::Minutes(1);

// Adds the digests of files that are named.
struct NamedFiles {
  // By the request of an unfinished operation; may be empty.
  std::function<void(const operations::Operation&, std::set<std::string>* named)> by_operation = {};
  // By what the store has.
  std::function<absl::Status(store::ReadTransaction&, std::set<std::string>* named)> by_store;
};

// Removes files that nothing names and that are older than their life and than an hour before every
// unfinished operation, whose files are not named before it ends.
absl::StatusOr<store::RemovedBlobs> RemoveUnusedFiles(store::Store& store,
                                                      operations::Operations& operations,
                                                      const std::filesystem::path& folder,
                                                      const NamedFiles& named);

// How much files may take together, in bytes, and how much less it shall be where that is too
// little: finding the oldest takes a look at all of them.
struct FileRoom {
  double most = 0;
  double ahead = 0;
};

struct TidiedFiles {
  store::RemovedBlobs removed;
  double left = 0;  // bytes of files that are there still
};

// Where files take more than `room.most`, removes those that nothing names, the oldest first, until
// they take `room.ahead` less than that or there are no more: none that is younger than
// kLeastFileLife, or than an hour before every unfinished operation.
absl::StatusOr<TidiedFiles> RemoveOldestFiles(store::Store& store,
                                              operations::Operations& operations,
                                              const std::filesystem::path& folder,
                                              const NamedFiles& named, const FileRoom& room);

}  // namespace mortise::rpc
