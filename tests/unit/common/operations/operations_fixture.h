// Operations on both store drivers.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/match.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/operations/operations.h"
#include "common/store/postgresql_connection.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::operations {

enum class Driver { kSqlite, kPostgresql };

inline const std::string& SharedPostgresqlUrl() {
  static const auto cluster = testing::PrivatePostgresql::Start();
  static const std::string url = cluster.ok() ? (*cluster)->url() : "";
  if (!cluster.ok()) ADD_FAILURE() << cluster.status();
  return url;
}

// Lets one thread wait until another says so.
class Gate {
 public:
  void Open() {
    std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void Pass() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return open_; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
};

// Runs until told to stop.
inline absl::StatusOr<std::string> RunUntilStopped(OperationContext& context) {
  std::mutex mutex;
  std::condition_variable_any nothing;
  std::unique_lock lock(mutex);
  nothing.wait(lock, context.stop_token(), [] { return false; });
  EXPECT_TRUE(context.Cancelled());
  return absl::CancelledError("stopped");
}

class OperationsTest : public ::testing::TestWithParam<Driver> {
 protected:
  void SetUp() override {
    static std::atomic<int> last_service = 0;
    service_ = "jobs-" + std::to_string(++last_service);
    if (GetParam() == Driver::kPostgresql) SharedPostgresqlUrl();
    store_ = OpenStoreAgain();
    ASSERT_NE(store_, nullptr);
  }

  // Ends every connection to the server, if there is one.
  static void LoseDatabase() {
    if (GetParam() != Driver::kPostgresql) return;
    const auto other = store::PostgresqlConnection::Open(SharedPostgresqlUrl(), "public");
    ASSERT_OK(other);
    EXPECT_OK(
        (*other)->Execute("SELECT pg_terminate_backend(pid) FROM pg_stat_activity"
                          " WHERE pid <> pg_backend_pid() AND"
                          " backend_type = 'client backend'"));
  }

  std::unique_ptr<store::Store> OpenStoreAgain() {
    store::StoreOptions options;
    options.url = GetParam() == Driver::kSqlite ? "sqlite:" + (folder_.path() / "store.db").string()
                                                : SharedPostgresqlUrl();
    options.service = service_;
    options.clock = [this] { return absl::Now() + absl::Microseconds(ahead_.load()); };
    auto store = store::OpenStore(options);
    EXPECT_OK(store);
    return store.ok() ? *std::move(store) : nullptr;
  }

  OperationsOptions Options() const {
    OperationsOptions options;
    options.service = "pareto";
    options.lease = absl::Hours(1);  // the clock moves only when a test says so
    options.poll = absl::Milliseconds(10);
    options.progress_interval = absl::Milliseconds(5);
    return options;
  }

  std::unique_ptr<Operations> Create(const OperationsOptions& options, const std::string& kind,
                                     OperationHandler handler) {
    auto operations = Operations::Create(options, store_.get());
    EXPECT_OK(operations);
    (*operations)->Register(kind, std::move(handler));
    EXPECT_OK((*operations)->Resume());
    return *std::move(operations);
  }

  std::string Start(Operations* operations, const std::string& kind,
                    const std::string& request = "") {
    std::string name;
    EXPECT_OK(store_->Transact([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(const Operation operation,
                               operations->Start(transaction, {.kind = kind,
                                                               .request = request,
                                                               .subject = "templates/table",
                                                               .trace_id = "r1",
                                                               .creator = "users/ada"}));
      name = operation.name;
      return absl::OkStatus();
    }));
    return name;
  }

  Operation WaitFor(Operations* operations, const std::string& name) {
    auto operation = operations->Wait(name, absl::Now() + absl::Seconds(30));
    EXPECT_OK(operation);
    return operation.ok() ? *operation : Operation{};
  }

  // The types of all events so far, progress left out.
  std::vector<std::string> EventTypes() {
    std::vector<std::string> types;
    auto numbering = store_->TakeEventNumbering();
    EXPECT_OK(numbering);
    const auto events = (*numbering)->NumberEvents(10000);
    EXPECT_OK(events);
    for (const store::NumberedEvent& event : *events) {
      EXPECT_TRUE(absl::StartsWith(event.subject, "operations/pareto/"));
      EXPECT_EQ(event.trace_id, "r1");
      if (event.type != "operation.progressed") types.push_back(event.type);
    }
    return types;
  }

  testing::TemporaryFolder folder_;
  std::string service_;
  std::atomic<int64_t> ahead_ = 0;  // microseconds the store's clock is ahead
  std::unique_ptr<store::Store> store_;
};

}  // namespace mortise::operations
