// What a store will hold once records that are not written yet are: for the checks of many things
// that use each other, before any of them is stored.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/store/store.h"

namespace mortise::catalog {

// The store's records, and over them those that are pending, which only Get sees. They have no
// revision yet: theirs is 0.
class PendingRecords : public store::ReadTransaction {
 public:
  // `stored` must outlive it.
  explicit PendingRecords(store::ReadTransaction& stored) : stored_(stored) {}

  void Add(std::string_view kind, std::string_view key, std::string payload);

  absl::StatusOr<store::Record> Get(std::string_view kind, std::string_view key) override;
  absl::StatusOr<store::Record> GetRevision(std::string_view kind, std::string_view key,
                                            int64_t revision) override;
  absl::StatusOr<std::vector<store::Record>> List(std::string_view kind,
                                                  const store::ListOptions& options) override;
  absl::StatusOr<std::vector<store::NumberedEvent>> ReadEvents(int64_t after_number,
                                                               int limit) override;
  absl::StatusOr<int64_t> LatestEventNumber() override;
  absl::StatusOr<int64_t> Epoch() override;
  absl::StatusOr<store::Task> GetTask(std::string_view queue, std::string_view key) override;
  absl::StatusOr<std::vector<store::Task>> ListTasks(std::string_view queue,
                                                     const store::ListOptions& options) override;
  absl::StatusOr<store::QueueDepth> Depth(std::string_view queue) override;

 private:
  store::ReadTransaction& stored_;
  std::map<std::pair<std::string, std::string>, store::Record> pending_;  // by kind and key
};

}  // namespace mortise::catalog
