// Operations as they lie in the store: a small JSON record that changes, and its bytes beside it.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/operations/operations.h"
#include "common/store/store.h"

namespace mortise::operations {

// Reads and writes inside the caller's transaction.
class OperationRecords {
 public:
  OperationRecords(std::string service, DescribeOperation describe);

  std::string NameOf(std::string_view id) const;

  // Returns the last part of "operations/<service>/<id>"; INVALID_ARGUMENT for another form or
  // service.
  absl::StatusOr<std::string> IdOf(std::string_view name) const;

  absl::StatusOr<Operation> Create(store::Transaction& transaction, const NewOperation& operation);

  // Returns the operation without request and result; NOT_FOUND naming it.
  absl::StatusOr<Operation> LoadState(store::ReadTransaction& transaction, std::string_view id);

  // Returns the whole operation.
  absl::StatusOr<Operation> Load(store::ReadTransaction& transaction, std::string_view id);

  // Newest first.
  absl::StatusOr<std::vector<Operation>> List(store::ReadTransaction& transaction,
                                              std::string_view after_id, int limit);

  // Newest first, one by one, until `visit` returns false.
  absl::Status Visit(store::ReadTransaction& transaction, std::string_view after_id,
                     const OperationFilter& filter,
                     const std::function<bool(const Operation&)>& visit);

  // Writes the state, sets operation->revision and appends the event operation.<event> (none if
  // empty).
  absl::Status Save(store::Transaction& transaction, std::string_view event, Operation* operation);

  absl::Status SaveResult(store::Transaction& transaction, std::string_view id,
                          std::string_view result);
  absl::Status SaveCheckpoint(store::Transaction& transaction, std::string_view id,
                              std::string_view checkpoint);

  // Empty if none was saved.
  absl::StatusOr<std::string> LoadCheckpoint(store::ReadTransaction& transaction,
                                             std::string_view id);

 private:
  absl::StatusOr<Operation> OperationOf(const store::Record& record) const;
  absl::Status LoadBytes(store::ReadTransaction& transaction, std::string_view id,
                         Operation* operation);

  std::string service_;
  DescribeOperation describe_;
};

}  // namespace mortise::operations
