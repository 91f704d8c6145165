// Keeps which revision of a resource was shipped with the collection, with which content, and the
// number of the newest collection that was brought in. From it follows what a newer collection may
// change without overwriting what users changed, and that an older one, of a replica that is not up
// to date yet, changes nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/store.h"

namespace mortise::catalog {

// What was shipped of a resource.
struct ShippedRevision {
  std::string digest;    // of what was shipped, as the collection has it
  int64_t revision = 0;  // that it became; 0 where a user's own was kept instead
  // When the resource was made that has this revision: one that a user made under the same name,
  // after removing what was shipped, begins with revision 1 again.
  absl::Time created_at = absl::InfinitePast();
  // Whether this content could not be brought in; `revision` is then that of what was before.
  bool failed = false;
};

// The present record of a resource.
struct PresentRevision {
  int64_t revision = 0;
  absl::Time created_at = {};
};

// What becomes of a thing that a collection brings.
enum class Delivery {
  kNone,     // it is there already, or a user removed it, or it was found not to go in
  kCreate,   // it is new
  kUpdate,   // as it was shipped before: it is replaced
  kKeepOwn,  // a user changed it, or made it: it stays
};

// Returns whether the resource is still what was shipped.
bool IsAsShipped(const std::optional<ShippedRevision>& shipped,
                 const std::optional<PresentRevision>& present);

// What a decision is made from.
struct DeliveryQuestion {
  std::string digest;                      // of what the collection has
  std::optional<ShippedRevision> shipped;  // none if it was never shipped to this store
  std::optional<PresentRevision> present;  // none if there is no such resource
  // Stores that were filled before there were such records have none; there, what was written in
  // the store's first transaction, and never since, is as it was shipped. Asked only where it
  // matters.
  std::function<absl::StatusOr<absl::Time>()> filled_at;
  // Whether the collection is newer than all that were brought before: what could not be brought in
  // then may go in now.
  bool is_newer = false;
};

// Decides; fails as `filled_at` does.
absl::StatusOr<Delivery> DecideDelivery(const DeliveryQuestion& question);

// Returns the number of the newest collection that was brought into the store; 0 if none had one.
absl::StatusOr<int64_t> GetCollectionNumber(store::ReadTransaction& transaction);
absl::Status PutCollectionNumber(store::Transaction& transaction, int64_t number);

// Returns what was shipped of the resource `name` ("items/x"); nothing if nothing was.
absl::StatusOr<std::optional<ShippedRevision>> GetShippedRevision(
    store::ReadTransaction& transaction, const std::string& name);
absl::Status PutShippedRevision(store::Transaction& transaction, const std::string& name,
                                const ShippedRevision& shipped);

// Counts the next revision of a resource as what was shipped, since it says the same: somebody gave
// it external ids or labels. Does nothing where another revision than `from`, or none, was shipped.
absl::Status MoveShippedRevision(store::Transaction& transaction, const std::string& name,
                                 int64_t from, int64_t to);

// Returns the latest revision of the resource `kind/id`, if there is one.
absl::StatusOr<std::optional<PresentRevision>> FindPresent(store::ReadTransaction& transaction,
                                                           const char* kind,
                                                           const std::string& name);

// How the store came to what it holds.
struct StoreOrigin {
  bool is_empty = true;  // of materials, items, templates and assemblies
  // When a collection was loaded into the empty store: the time of its first records, if one
  // transaction wrote several, which no call does. Otherwise the infinite future.
  absl::Time filled_at = absl::InfiniteFuture();
};

// Says how the store came to what it holds, in O(records), without reading them.
absl::StatusOr<StoreOrigin> OriginOf(store::ReadTransaction& transaction);

}  // namespace mortise::catalog
