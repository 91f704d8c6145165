// The outbox and the numbered events of a store, in SQL.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/sql.h"
#include "common/store/types.h"

namespace mortise::store {

class EventTable {
 public:
  explicit EventTable(SqlConnection* connection) : connection_(connection) {}

  // As Transaction has them.
  absl::Status Append(const NewEvent& event, absl::Time now);
  absl::StatusOr<std::vector<NumberedEvent>> Read(int64_t after_number, int limit);
  absl::StatusOr<int64_t> LatestNumber();
  absl::StatusOr<int64_t> Epoch();

  // Begins and returns a new epoch, greater than every earlier one, even of a store since restored
  // from an older backup: epochs are at least the time in milliseconds.
  absl::StatusOr<int64_t> BeginEpoch(absl::Time now);

  // Moves up to `limit` events out of the outbox and numbers them. ABORTED, RELAY_SUPERSEDED if
  // `epoch` is over. On PostgreSQL the transaction must be REPEATABLE READ: all statements here
  // must see the same outbox, or an event that commits in between would be removed unnumbered.
  absl::StatusOr<std::vector<NumberedEvent>> Number(int64_t epoch, int limit);

 private:
  SqlConnection* connection_;
};

}  // namespace mortise::store
