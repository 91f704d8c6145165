// The narrow door through which the tables of a store talk to SQLite or PostgreSQL.
//
// Statements are written in PostgreSQL's dialect and kept to what both understand; the SQLite
// connection drops the row-locking clauses, since it has one writer. Parameters are $1, $2 … in the
// order of their first use.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/types/span.h"

namespace mortise::store {

// Marks bytes that are not text.
struct SqlBytes {
  std::string_view bytes;
};

using SqlValue = std::variant<int64_t, std::string_view, SqlBytes>;

// One value of a result: `integer` of BIGINT columns, `text` of the others. NULL is 0 and empty.
struct SqlCell {
  int64_t integer = 0;
  std::string text;
};

using SqlRow = std::vector<SqlCell>;

struct SqlResult {
  std::vector<SqlRow> rows;
  int64_t changed = 0;  // rows inserted, updated or deleted
};

class SqlConnection {
 public:
  virtual ~SqlConnection() = default;

  // Runs one statement. `sql` stays as long as the process: its address names the prepared
  // statement. A failure is remembered, so that the transaction cannot be committed by a caller who
  // ignores it.
  virtual absl::StatusOr<SqlResult> Run(const char* sql,
                                        absl::Span<const SqlValue> values = {}) = 0;

  // Runs a statement without values or result: transaction control and table definitions.
  virtual absl::Status Execute(const std::string& sql) = 0;
};

}  // namespace mortise::store
