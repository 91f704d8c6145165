// Pending records over stored ones.
#include "services/catalog/records/pending_records.h"

namespace mortise::catalog {

void PendingRecords::Add(std::string_view kind, std::string_view key, std::string payload) {
  store::Record& record = pending_[{std::string(kind), std::string(key)}];
  record.kind = kind;
  record.key = key;
  record.payload = std::move(payload);
}

absl::StatusOr<store::Record> PendingRecords::Get(std::string_view kind, std::string_view key) {
  const auto found = pending_.find({std::string(kind), std::string(key)});
  if (found != pending_.end()) return found->second;
  return stored_.Get(kind, key);
}

absl::StatusOr<store::Record> PendingRecords::GetRevision(std::string_view kind,
                                                          std::string_view key, int64_t revision) {
  return stored_.GetRevision(kind, key, revision);
}

absl::StatusOr<std::vector<store::Record>> PendingRecords::List(std::string_view kind,
                                                                const store::ListOptions& options) {
  return stored_.List(kind, options);
}

absl::StatusOr<std::vector<store::NumberedEvent>> PendingRecords::ReadEvents(int64_t after_number,
                                                                             int limit) {
  return stored_.ReadEvents(after_number, limit);
}

absl::StatusOr<int64_t> PendingRecords::LatestEventNumber() { return stored_.LatestEventNumber(); }

absl::StatusOr<int64_t> PendingRecords::Epoch() { return stored_.Epoch(); }

absl::StatusOr<store::Task> PendingRecords::GetTask(std::string_view queue, std::string_view key) {
  return stored_.GetTask(queue, key);
}

absl::StatusOr<std::vector<store::Task>> PendingRecords::ListTasks(
    std::string_view queue, const store::ListOptions& options) {
  return stored_.ListTasks(queue, options);
}

absl::StatusOr<store::QueueDepth> PendingRecords::Depth(std::string_view queue) {
  return stored_.Depth(queue);
}

}  // namespace mortise::catalog
