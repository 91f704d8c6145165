// The tables of a store.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "common/store/sql.h"

namespace mortise::store {

// What the two databases call the same thing.
struct SchemaDialect {
  std::string bytes;     // a column of bytes
  std::string text;      // a column of text that compares by its bytes
  std::string number;    // an integer that is a primary key
  std::string identity;  // a primary key that numbers itself, rising
};

// Creates the tables where they are missing and notes the time, which also proves that the database
// can be written. FAILED_PRECONDITION, STORE_TOO_NEW if a later version of the program made it.
// Runs in the caller's transaction.
absl::Status PrepareSchema(const SchemaDialect& dialect, absl::Time now, SqlConnection* connection);

}  // namespace mortise::store
