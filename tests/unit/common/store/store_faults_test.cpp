// What a store says, and keeps, when disk, file, process or server fail it.
#include <gtest/gtest.h>
#include <signal.h>
#include <sqlite3.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <string>

#include "common/base/errors.h"
#include "common/store/store.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::store {
namespace {

// The first column of the first row.
std::string Query(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  std::string answer;
  EXPECT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const auto take = [](void* text, int, char** values, char**) {
    *static_cast<std::string*>(text) = values[0] == nullptr ? "" : values[0];
    return 0;
  };
  EXPECT_EQ(sqlite3_exec(database, sql.c_str(), take, &answer, nullptr), SQLITE_OK);
  sqlite3_close(database);
  return answer;
}

void ExpectStorageFailed(const absl::Status& status, const std::string& path) {
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal) << status;
  EXPECT_EQ(DetailOf(status).reason, "STORAGE_FAILED");
  EXPECT_NE(status.message().find(path), std::string::npos) << status;
}

// Runs `body` in a child process; its result is the exit code, or minus the signal.
int InChild(const std::function<int()>& body) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(body());
  int result = 0;
  EXPECT_EQ(::waitpid(child, &result, 0), child);
  return WIFSIGNALED(result) ? -WTERMSIG(result) : WEXITSTATUS(result);
}

// Stands in for a full disk: files of this process cannot grow beyond so many bytes.
void LimitFileSize(rlim_t bytes) {
  ::signal(SIGXFSZ, SIG_IGN);
  const rlimit limit{.rlim_cur = bytes, .rlim_max = RLIM_INFINITY};
  ::setrlimit(RLIMIT_FSIZE, &limit);
}

absl::Status Put(Store* store, const std::string& key, const std::string& payload) {
  return store->Transact(
      [&](Transaction& transaction) { return transaction.Put("things", key, payload).status(); });
}

class SqliteFaults : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_.path() / "store.db";
  const StoreOptions options_{.url = "sqlite:" + file_.string()};
};

TEST_F(SqliteFaults, AMissingFolderIsMade) {
  const std::filesystem::path deep = folder_.path() / "a" / "b" / "store.db";
  EXPECT_OK(OpenStore({.url = "sqlite:" + deep.string()}));
  EXPECT_TRUE(std::filesystem::exists(deep));
}

TEST_F(SqliteFaults, AnUnusableFolderIsNamed) {
  std::ofstream(folder_.path() / "file") << "x";
  const std::string under_a_file = (folder_.path() / "file" / "store.db").string();
  ExpectStorageFailed(OpenStore({.url = "sqlite:" + under_a_file}).status(),
                      (folder_.path() / "file").string());
  ExpectStorageFailed(OpenStore({.url = "sqlite:/proc/store.db"}).status(), "/proc/store.db");
  ExpectStorageFailed(OpenStore({.url = "sqlite:" + folder_.path().string()}).status(),
                      folder_.path().string());
}

TEST_F(SqliteFaults, AFileThatIsNoDatabaseIsLeftAlone) {
  const std::string text = "this is somebody's letter, not a database, and must not be harmed";
  std::ofstream(file_) << text;
  ExpectStorageFailed(OpenStore(options_).status(), file_.string());
  std::ifstream in(file_);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), text);
}

TEST_F(SqliteFaults, AFullDiskAtTheStartIsToldAndHarmless) {
  { ASSERT_OK(Put(OpenStore(options_).value().get(), "a", "kept")); }
  const int result = InChild([&] {
    LimitFileSize(0);
    const absl::Status status = OpenStore(options_).status();
    return DetailOf(status).reason == "STORAGE_FAILED" &&
                   status.message().find(file_.string()) != std::string::npos
               ? 0
               : 1;
  });
  EXPECT_EQ(result, 0);
  auto store = OpenStore(options_);
  ASSERT_OK(store);
  EXPECT_OK((*store)->Read(
      [](ReadTransaction& transaction) { return transaction.Get("things", "a").status(); }));
  EXPECT_EQ(Query(file_, "PRAGMA integrity_check"), "ok");
}

TEST_F(SqliteFaults, ADiskThatFillsUpLosesNothingCommitted) {
  constexpr int kEnough = 200;
  const std::string payload(100'000, 'x');
  const int committed = InChild([&] {
    auto store = OpenStore(options_).value();
    LimitFileSize(4 << 20);
    for (int i = 0; i < kEnough; ++i) {
      const absl::Status status = Put(store.get(), std::to_string(i), payload);
      if (status.ok()) continue;
      const bool told = DetailOf(status).reason == "STORAGE_FAILED";
      const bool readable = store
                                ->Read([](ReadTransaction& transaction) {
                                  return transaction.Get("things", "0").status();
                                })
                                .ok();
      return told && readable ? i : 255;
    }
    return 255;
  });
  ASSERT_GT(committed, 0);
  ASSERT_LT(committed, kEnough);
  auto store = OpenStore(options_);
  ASSERT_OK(store);
  EXPECT_OK((*store)->Read([&](ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.List("things", {.limit = 1000})->size(),
              static_cast<std::size_t>(committed));
    return absl::OkStatus();
  }));
  EXPECT_OK(Put(store->get(), "more", payload));
  EXPECT_EQ(Query(file_, "PRAGMA integrity_check"), "ok");
}

// Each transaction writes two records; a process killed at any moment leaves both or neither, and
// all that it reported as committed.
TEST_F(SqliteFaults, KillMinusNineLeavesWholeTransactions) {
  int channel[2];
  ASSERT_EQ(::pipe(channel), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    auto store = OpenStore(options_).value();
    for (int i = 1;; ++i) {
      const absl::Status status = store->Transact([&](Transaction& transaction) -> absl::Status {
        MORTISE_RETURN_IF_ERROR(transaction.Put("left", "x", std::to_string(i)).status());
        return transaction.Put("right", "x", std::to_string(i)).status();
      });
      if (!status.ok() || ::write(channel[1], &i, sizeof(i)) != sizeof(i)) ::_exit(1);
    }
  }
  ::close(channel[1]);
  int reported = 0;
  while (reported < 300) ASSERT_EQ(::read(channel[0], &reported, sizeof(reported)), 4);
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  while (::read(channel[0], &reported, sizeof(reported)) == 4) {
  }
  ::close(channel[0]);

  auto store = OpenStore(options_);
  ASSERT_OK(store);
  EXPECT_OK((*store)->Read([&](ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const Record left, transaction.Get("left", "x"));
    MORTISE_ASSIGN_OR_RETURN(const Record right, transaction.Get("right", "x"));
    EXPECT_EQ(left.payload, right.payload);
    EXPECT_GE(std::stoi(left.payload), reported);
    return absl::OkStatus();
  }));
  EXPECT_EQ(Query(file_, "PRAGMA integrity_check"), "ok");
}

TEST_F(SqliteFaults, AStoreOfALaterVersionIsRefused) {
  { ASSERT_OK(OpenStore(options_)); }
  Query(file_, "UPDATE store_version SET version = 99");
  const absl::Status status = OpenStore(options_).status();
  EXPECT_EQ(DetailOf(status).reason, "STORE_TOO_NEW") << status;
}

TEST(StoreOptions, BadOnesAreNamed) {
  const auto field = [](const StoreOptions& options) {
    return DetailOf(OpenStore(options).status()).field;
  };
  EXPECT_EQ(field({.url = ""}), "url");
  EXPECT_EQ(field({.url = "sqlite:"}), "url");
  EXPECT_EQ(field({.url = "mysql://x"}), "url");
  EXPECT_EQ(field({.url = "sqlite:/x", .service = "No Good"}), "service");
  EXPECT_EQ(field({.url = "sqlite:/x", .connections = 0}), "connections");
  EXPECT_EQ(field({.url = "sqlite:/x", .clock = nullptr}), "clock");
}

TEST(PostgresqlFaults, AnAbsentServerIsUnavailableAndThePasswordStaysSecret) {
  const absl::Status status =
      OpenStore({.url = "postgresql://me:hunter2@127.0.0.1:1/none?connect_timeout=2"}).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable) << status;
  EXPECT_EQ(status.message().find("hunter2"), std::string::npos);
}

TEST(PostgresqlFaults, AServerThatCrashedIsUsedAgain) {
  auto cluster = testing::PrivatePostgresql::Start();
  ASSERT_OK(cluster);
  auto store = OpenStore({.url = (*cluster)->url()});
  ASSERT_OK(store);
  ASSERT_OK(Put(store->get(), "a", "before"));
  ASSERT_OK((*cluster)->CrashAndRestart());
  EXPECT_OK(Put(store->get(), "b", "after"));
  EXPECT_OK((*store)->Read([](ReadTransaction& transaction) -> absl::Status {
    EXPECT_EQ(transaction.Get("things", "a")->payload, "before");
    EXPECT_EQ(transaction.Get("things", "b")->payload, "after");
    return absl::OkStatus();
  }));
}

}  // namespace
}  // namespace mortise::store
