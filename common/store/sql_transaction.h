// The Transaction of both drivers: the tables over one connection, at one time.
#pragma once

#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "common/store/event_table.h"
#include "common/store/record_table.h"
#include "common/store/store.h"
#include "common/store/task_table.h"

namespace mortise::store {

class SqlTransaction final : public Transaction {
 public:
  SqlTransaction(SqlConnection* connection, absl::Time now)
      : now_(now), records_(connection), events_(connection), tasks_(connection, now) {}

  // Whether it did something that commit listeners wait for.
  bool wakes_listeners() const { return wakes_listeners_; }

  // What AfterCommit was given.
  std::vector<std::function<void()>> TakeCallbacks() { return std::move(callbacks_); }

  absl::StatusOr<Record> Get(std::string_view kind, std::string_view key) override;
  absl::StatusOr<Record> GetRevision(std::string_view kind, std::string_view key,
                                     int64_t revision) override;
  absl::StatusOr<std::vector<Record>> List(std::string_view kind,
                                           const ListOptions& options) override;
  absl::StatusOr<std::vector<NumberedEvent>> ReadEvents(int64_t after_number, int limit) override;
  absl::StatusOr<int64_t> LatestEventNumber() override;
  absl::StatusOr<int64_t> Epoch() override;
  absl::StatusOr<Task> GetTask(std::string_view queue, std::string_view key) override;
  absl::StatusOr<std::vector<Task>> ListTasks(std::string_view queue,
                                              const ListOptions& options) override;
  absl::StatusOr<QueueDepth> Depth(std::string_view queue) override;

  absl::StatusOr<int64_t> Put(std::string_view kind, std::string_view key, std::string_view payload,
                              const PutOptions& options) override;
  absl::Status Delete(std::string_view kind, std::string_view key,
                      std::optional<int64_t> expected_revision) override;
  absl::Status AppendEvent(const NewEvent& event) override;
  absl::Status EnqueueTask(const NewTask& task) override;
  absl::StatusOr<std::vector<bool>> EnqueueTasks(const std::vector<NewTask>& tasks) override;
  absl::StatusOr<LeaseResult> LeaseTasks(std::string_view queue, std::string_view worker, int limit,
                                         absl::Duration lease) override;
  absl::Status RenewLease(std::string_view queue, std::string_view key, int64_t attempt,
                          absl::Duration lease) override;
  absl::StatusOr<Task> CompleteTask(std::string_view queue, std::string_view key, int64_t attempt,
                                    std::string_view result) override;
  absl::Status FailTask(std::string_view queue, std::string_view key, int64_t attempt,
                        std::string_view error, bool retry, absl::Duration delay) override;
  absl::Status ReleaseTask(std::string_view queue, std::string_view key, int64_t attempt) override;
  absl::StatusOr<int64_t> ExpireLeases(std::string_view queue, std::string_view worker) override;
  absl::Status CancelTask(std::string_view queue, std::string_view key) override;
  absl::Status DeleteTask(std::string_view queue, std::string_view key) override;
  void AfterCommit(std::function<void()> callback) override;
  absl::Time Now() const override { return now_; }

 private:
  absl::Time now_;
  RecordTable records_;
  EventTable events_;
  TaskTable tasks_;
  bool wakes_listeners_ = false;
  std::vector<std::function<void()>> callbacks_;
};

}  // namespace mortise::store
