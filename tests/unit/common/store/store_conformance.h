// What every driver of the store must do, told once: the tests in store_conformance_*_test.cpp run
// against SQLite and against a private PostgreSQL.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "common/base/errors.h"
#include "common/store/store.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::store {

enum class Driver { kSqlite, kPostgresql };

inline std::string DriverName(const ::testing::TestParamInfo<Driver>& info) {
  return info.param == Driver::kSqlite ? "Sqlite" : "Postgresql";
}

// One cluster for the whole test program, started when first needed.
inline const std::string& SharedPostgresqlUrl() {
  static const auto cluster = testing::PrivatePostgresql::Start();
  static const std::string url = cluster.ok() ? (*cluster)->url() : "";
  if (!cluster.ok()) ADD_FAILURE() << cluster.status();
  return url;
}

// A fresh store in each test, with a clock that the test moves.
class StoreConformance : public ::testing::TestWithParam<Driver> {
 protected:
  void SetUp() override {
    static std::atomic<int> last_service = 0;
    service_ = "test-" + std::to_string(++last_service);
    store_ = OpenAgain();
    ASSERT_NE(store_, nullptr);
  }

  // Another store object on the same data, as another process would have.
  std::unique_ptr<Store> OpenAgain() {
    StoreOptions options;
    options.url = GetParam() == Driver::kSqlite ? "sqlite:" + (folder_.path() / "store.db").string()
                                                : SharedPostgresqlUrl();
    options.service = service_;
    options.blob_folder = folder_.path() / "blobs";
    options.connections = 8;
    options.clock = [this] { return absl::FromUnixMicros(now_microseconds_.load()); };
    absl::StatusOr<std::unique_ptr<Store>> store = OpenStore(options);
    EXPECT_TRUE(store.ok()) << store.status();
    return store.ok() ? *std::move(store) : nullptr;
  }

  void Advance(absl::Duration duration) {
    now_microseconds_ += absl::ToInt64Microseconds(duration);
  }
  absl::Time Now() const { return absl::FromUnixMicros(now_microseconds_.load()); }

  // One call in a transaction of its own.
  absl::StatusOr<int64_t> Put(const std::string& kind, const std::string& key,
                              const std::string& payload, const PutOptions& options = {}) {
    int64_t revision = 0;
    MORTISE_RETURN_IF_ERROR(store_->Transact([&](Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(revision, transaction.Put(kind, key, payload, options));
      return absl::OkStatus();
    }));
    return revision;
  }

  absl::StatusOr<Record> Get(const std::string& kind, const std::string& key) {
    Record record;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(record, transaction.Get(kind, key));
      return absl::OkStatus();
    }));
    return record;
  }

  testing::TemporaryFolder folder_;
  std::string service_;
  std::atomic<int64_t> now_microseconds_ = int64_t{1'700'000'000} * 1'000'000;
  std::unique_ptr<Store> store_;
};

}  // namespace mortise::store
