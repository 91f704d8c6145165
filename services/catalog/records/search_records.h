// What the searches of parametrisations came to (common/assembly/trial/search_outcome.h), kept in
// the store under the digest of the content that they were made for. So a design that has been
// parametrised once is parametrised again at once, after a restart and by other replicas, too.
#pragma once

#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/assembly/trial/search_outcome.h"
#include "common/store/store.h"

namespace mortise::catalog {

// How long what nobody asks for is kept: of imports that were refused, and of content that no
// revision has any more. Searching once more costs no more than the first time did.
inline constexpr absl::Duration kUnusedSearchLife = absl::Hours(24 * 60);

// What was searched: an assembly's content, or the sub-tree below a group of it.
struct Searched {
  std::string digest;  // of the assembly with all that it uses (parametric::BundleDigest)
  std::string group;   // empty for all of it
};

// Returns what the searches came to before; nothing if nobody knows, or only an earlier version of
// them does. What cannot be read is not known either: it is found anew.
std::optional<parametric::SearchOutcome> FindSearchOutcome(store::Store& store,
                                                           const Searched& searched);

// Keeps what the searches came to, in place of what an earlier version came to. Fails as
// Store::Transact does, so within a transaction of the same thread with TRANSACTION_NESTED.
absl::Status KeepSearchOutcome(store::Store& store, const Searched& searched,
                               const parametric::SearchOutcome& outcome);

// Removes what was not asked for within kUnusedSearchLife; returns how many.
absl::StatusOr<int> SweepSearches(store::Store& store);

}  // namespace mortise::catalog
