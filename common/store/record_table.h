// The records of a store and their kept revisions, in SQL.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/store/sql.h"
#include "common/store/types.h"

namespace mortise::store {

// The methods are those of Transaction.
class RecordTable {
 public:
  explicit RecordTable(SqlConnection* connection) : connection_(connection) {}

  absl::StatusOr<Record> Get(std::string_view kind, std::string_view key);
  absl::StatusOr<Record> GetRevision(std::string_view kind, std::string_view key, int64_t revision);
  absl::StatusOr<std::vector<Record>> List(std::string_view kind, const ListOptions& options);
  absl::StatusOr<int64_t> Put(std::string_view kind, std::string_view key, std::string_view payload,
                              const PutOptions& options, absl::Time now);
  absl::Status Delete(std::string_view kind, std::string_view key,
                      std::optional<int64_t> expected_revision);

 private:
  absl::StatusOr<int64_t> CurrentRevision(std::string_view kind, std::string_view key);

  SqlConnection* connection_;
};

// Returns the text before which every name that starts with `prefix` sorts.
std::string EndOfPrefix(std::string_view prefix);

}  // namespace mortise::store
