// Builds of indexes, as operations: which are under way, whose turn it is, and which the service
// is not to start again.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "common/operations/operations.h"
#include "mortise/v1/retrieval.pb.h"

namespace mortise::retrieval {

// Who builds that the service starts by itself are created by.
inline constexpr char kUpkeepCreator[] = "services/retrieval";

// Of templates, by name.
using Revisions = std::map<std::string, std::int64_t>;

// Returns what tells builds of the service apart by the templates that they were started for.
operations::OperationTags TagsOf(const Revisions& templates);

// Returns the name of an operation that builds the index of a descriptor, or waits to; nothing if
// there is none.
absl::StatusOr<std::optional<std::string>> BuildUnderWay(operations::Operations& operations,
                                                         v1::ShapeDescriptor descriptor);

// Whether somebody cancelled the build of an index that the service had started for the templates
// as they are, and nobody has asked for another since that came to its end.
absl::StatusOr<bool> IsGivenUp(operations::Operations& operations, v1::ShapeDescriptor descriptor,
                               const Revisions& templates);

// One build goes on at a time: two of different δ would mix their covers. Thread safe.
class BuildTurn {
 public:
  // Returns when no other build goes on, and tells as the operation's progress which one it waits
  // for; others wait until what is returned goes away. CANCELLED when the operation is to stop.
  absl::StatusOr<std::unique_lock<std::timed_mutex>> Take(operations::OperationContext& context);

 private:
  std::timed_mutex turn_;
  std::mutex mutex_;
  std::string holder_;  // the operation that had the turn last; guarded by mutex_
};

// "3 templates have left indexes/d2, …" for each index before and after a build whose delta is
// another; empty where none has left it that `present` has.
std::string WhoLeft(const v1::ShapeIndex& before, const v1::ShapeIndex& after,
                    const Revisions& present);

}  // namespace mortise::retrieval
