// A PostgreSQL cluster of a test's own: in a temporary folder, reached through a Unix socket there,
// gone with the object. As root it runs as the user `postgres`, since the server refuses root.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {

class PrivatePostgresql {
 public:
  // Makes and starts a cluster (one or two seconds). NOT_FOUND if PostgreSQL is not installed:
  // tests that need it then fail, they are not skipped. Call from a thread that outlives it.
  static absl::StatusOr<std::unique_ptr<PrivatePostgresql>> Start();
  ~PrivatePostgresql();
  PrivatePostgresql(const PrivatePostgresql&) = delete;
  PrivatePostgresql& operator=(const PrivatePostgresql&) = delete;

  // A connection string for StoreOptions::url.
  std::string url() const;

  // Kills every process of the server without warning, as a crash would, and starts it again.
  absl::Status CrashAndRestart();

 private:
  PrivatePostgresql() = default;

  absl::Status StartServer();
  bool Ready() const;

  TemporaryFolder folder_;
  std::string programs_;  // the folder of initdb and postgres
  std::unique_ptr<ChildProcess> server_;
};

}  // namespace mortise::testing
