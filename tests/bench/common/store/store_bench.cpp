// How many transactions and task leases a second the two drivers of the store manage.
//
// Every figure is the work of eight threads for two seconds; on PostgreSQL the server is a private
// one with fsync off, so its figures are those of the code, not of a disk.
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/base/errors.h"
#include "common/store/store.h"
#include "tests/support/private_postgresql.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace mortise;

constexpr int kThreads = 8;
constexpr absl::Duration kDuration = absl::Seconds(2);

// Calls `work(thread, round)` from all threads until the time is over; returns calls a second that
// were OK.
double Rate(const std::function<absl::Status(int, int)>& work) {
  std::atomic<int64_t> done = 0;
  const absl::Time start = absl::Now();
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int round = 0; absl::Now() < start + kDuration; ++round) {
        const absl::Status status = work(t, round);
        if (status.ok()) ++done;
        if (!status.ok()) std::fprintf(stderr, "store_bench: %s\n", status.ToString().c_str());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return static_cast<double>(done) / absl::ToDoubleSeconds(absl::Now() - start);
}

void Measure(const std::string& name, const std::string& url) {
  auto opened = store::OpenStore({.url = url, .connections = kThreads});
  if (!opened.ok()) {
    std::fprintf(stderr, "store_bench: %s\n", opened.status().ToString().c_str());
    std::exit(1);
  }
  store::Store* store = opened->get();
  const std::string payload(1000, 'x');
  const double puts = Rate([&](int thread, int round) {
    return store->Transact([&](store::Transaction& transaction) -> absl::Status {
      const std::string key = std::to_string(thread) + "-" + std::to_string(round);
      MORTISE_RETURN_IF_ERROR(transaction.Put("things", key, payload).status());
      return transaction.AppendEvent({.type = "thing.created", .subject = key});
    });
  });
  const double gets = Rate([&](int thread, int) {
    return store->Read([&](store::ReadTransaction& transaction) {
      return transaction.Get("things", std::to_string(thread) + "-0").status();
    });
  });
  const double enqueued = Rate([&](int thread, int round) {
    return store->Transact(
        [&](store::Transaction& transaction) {
          return transaction.EnqueueTask(
              {.queue = "q", .key = std::to_string(thread) + "-" + std::to_string(round)});
        },
        store::Isolation::kReadCommitted);
  });
  std::atomic<int64_t> leased = 0;
  const double leases = Rate([&](int thread, int) {
    return store->Transact(
        [&](store::Transaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(
              const store::LeaseResult result,
              transaction.LeaseTasks("q", "w" + std::to_string(thread), 1, absl::Minutes(1)));
          leased += static_cast<int64_t>(result.leased.size());
          return absl::OkStatus();
        },
        store::Isolation::kReadCommitted);
  });
  std::printf(
      "store %-10s: record and event %.0f/s, read %.0f/s, enqueue %.0f/s, lease %.0f/s "
      "(%lld tasks)\n",
      name.c_str(), puts, gets, enqueued, leases, static_cast<long long>(leased));
}

}  // namespace

int main() {
  const testing::TemporaryFolder folder;
  Measure("sqlite", "sqlite:" + (folder.path() / "s.db").string());
  const auto cluster = testing::PrivatePostgresql::Start();
  if (!cluster.ok()) {
    std::fprintf(stderr, "store_bench: %s\n", cluster.status().ToString().c_str());
    return 1;
  }
  Measure("postgresql", (*cluster)->url());
  return 0;
}
