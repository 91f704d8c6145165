#include "common/operations/operation_records.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"

namespace mortise::operations {
namespace {

using nlohmann::json;

constexpr std::string_view kStates = "operations";
constexpr std::string_view kRequests = "operation-requests";
constexpr std::string_view kResults = "operation-results";
constexpr std::string_view kCheckpoints = "operation-checkpoints";
constexpr int kVisitedAtOnce = 100;  // states, which are small

// Text of libraries may not be UTF-8; what is not becomes a replacement character.
std::string Dump(const json& value) {
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

json JsonOf(const Progress& progress) {
  json value = {{"done", progress.done}, {"total", progress.total}, {"message", progress.message}};
  if (progress.has_best) value["best"] = progress.best_so_far;
  return value;
}

Progress ProgressOf(const json& value) {
  Progress progress{.done = value.at("done"), .total = value.at("total")};
  progress.message = value.at("message");
  // A best value that is not a number (JSON has none) reads as null.
  progress.has_best = value.contains("best") && value["best"].is_number();
  if (progress.has_best) progress.best_so_far = value["best"];
  return progress;
}

json JsonOf(const absl::Status& status) {
  const ErrorDetail detail = DetailOf(status);
  return {{"code", static_cast<int>(status.code())},
          {"message", std::string(status.message())},
          {"reason", detail.reason},
          {"field", detail.field}};
}

absl::Status StatusOf(const json& value) {
  const absl::Status status(static_cast<absl::StatusCode>(value.at("code").get<int>()),
                            value.at("message").get<std::string>());
  return WithDetail(status, {value.at("reason"), value.at("field")});
}

// Records of operations without tags are as they were before there were any.
void WriteTags(const OperationTags& tags, json* value) {
  if (!tags.external_ids.empty()) (*value)["external_ids"] = tags.external_ids;
  if (!tags.labels.empty()) (*value)["labels"] = tags.labels;
}

OperationTags TagsOf(const json& value) {
  return {.external_ids = value.value("external_ids", std::vector<std::string>()),
          .labels = value.value("labels", std::map<std::string, std::string>())};
}

std::string StateJson(const Operation& operation) {
  json value = {{"kind", operation.kind},
                {"subject", operation.subject},
                {"request_id", operation.trace_id},
                {"creator", operation.creator},
                {"method", operation.method},
                {"state", static_cast<int>(operation.state)},
                {"cancel_requested", operation.cancel_requested},
                {"progress", JsonOf(operation.progress)},
                {"error", JsonOf(operation.error)}};
  WriteTags(operation.tags, &value);
  return Dump(value);
}

void ReadStateJson(const std::string& text, Operation* operation) {
  const json value = json::parse(text);
  operation->kind = value.at("kind");
  operation->subject = value.at("subject");
  operation->trace_id = value.at("request_id");
  operation->creator = value.at("creator");
  operation->method = value.value("method", "");  // earlier versions did not keep it
  operation->tags = TagsOf(value);
  operation->state = static_cast<OperationState>(value.at("state").get<int>());
  operation->cancel_requested = value.at("cancel_requested");
  operation->progress = ProgressOf(value.at("progress"));
  operation->error = StatusOf(value.at("error"));
}

std::string DescribeAsJson(const Operation& operation) {
  json value = JsonOf(operation.progress);
  value["name"] = operation.name;
  value["kind"] = operation.kind;
  value["state"] = OperationStateName(operation.state);
  if (!operation.error.ok()) value["error"] = JsonOf(operation.error);
  return Dump(value);
}

bool Passes(const Operation& operation, const OperationFilter& filter) {
  const bool in_state =
      filter.states.empty() ||
      std::find(filter.states.begin(), filter.states.end(), operation.state) != filter.states.end();
  return in_state && (filter.kind.empty() || filter.kind == operation.kind) &&
         (filter.subject.empty() || filter.subject == operation.subject) &&
         (!filter.takes || filter.takes(operation));
}

absl::StatusOr<std::string> BytesOrNone(absl::StatusOr<store::Record> record) {
  if (record.ok()) return std::move(record->payload);
  if (absl::IsNotFound(record.status())) return std::string();
  return record.status();
}

}  // namespace

const char* OperationStateName(OperationState state) {
  switch (state) {
    case OperationState::kPending:
      return "pending";
    case OperationState::kRunning:
      return "running";
    case OperationState::kSucceeded:
      return "succeeded";
    case OperationState::kFailed:
      return "failed";
    case OperationState::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

bool IsFinal(OperationState state) {
  return state != OperationState::kPending && state != OperationState::kRunning;
}

OperationRecords::OperationRecords(std::string service, DescribeOperation describe)
    : service_(std::move(service)), describe_(std::move(describe)) {
  if (!describe_) describe_ = DescribeAsJson;
}

std::string OperationRecords::NameOf(std::string_view id) const {
  return absl::StrCat("operations/", service_, "/", std::string(id));
}

absl::StatusOr<std::string> OperationRecords::IdOf(std::string_view name) const {
  const std::string prefix = NameOf("");
  if (!name.starts_with(prefix) || !IsResourceId(name.substr(prefix.size()))) {
    return InvalidField("name", absl::StrCat("must have the form ", prefix, "<id>"));
  }
  return std::string(name.substr(prefix.size()));
}

absl::StatusOr<Operation> OperationRecords::Create(store::Transaction& transaction,
                                                   const NewOperation& request) {
  const std::string id = NewIdentifier();
  Operation operation{.name = NameOf(id),
                      .kind = request.kind,
                      .subject = request.subject,
                      .trace_id = request.trace_id,
                      .creator = request.creator,
                      .method = request.method,
                      .tags = request.tags,
                      .request = request.request,
                      .created_at = transaction.Now()};
  MORTISE_RETURN_IF_ERROR(
      transaction.Put(kRequests, id, request.request, {.expected_revision = 0}).status());
  MORTISE_RETURN_IF_ERROR(Save(transaction, "", &operation));
  return operation;
}

absl::StatusOr<Operation> OperationRecords::OperationOf(const store::Record& record) const {
  Operation operation{.name = NameOf(record.key),
                      .revision = record.revision,
                      .created_at = record.created_at,
                      .updated_at = record.updated_at};
  try {
    ReadStateJson(record.payload, &operation);
  } catch (const json::exception& error) {
    return StorageFailed(operation.name, error.what());
  }
  return operation;
}

absl::StatusOr<Operation> OperationRecords::LoadState(store::ReadTransaction& transaction,
                                                      std::string_view id) {
  absl::StatusOr<store::Record> record = transaction.Get(kStates, id);
  if (absl::IsNotFound(record.status())) return ResourceNotFound(NameOf(id));
  if (!record.ok()) return record.status();
  return OperationOf(*record);
}

absl::Status OperationRecords::LoadBytes(store::ReadTransaction& transaction, std::string_view id,
                                         Operation* operation) {
  MORTISE_ASSIGN_OR_RETURN(operation->request, BytesOrNone(transaction.Get(kRequests, id)));
  MORTISE_ASSIGN_OR_RETURN(operation->result, BytesOrNone(transaction.Get(kResults, id)));
  return absl::OkStatus();
}

absl::StatusOr<Operation> OperationRecords::Load(store::ReadTransaction& transaction,
                                                 std::string_view id) {
  MORTISE_ASSIGN_OR_RETURN(Operation operation, LoadState(transaction, id));
  MORTISE_RETURN_IF_ERROR(LoadBytes(transaction, id, &operation));
  return operation;
}

absl::StatusOr<std::vector<Operation>> OperationRecords::List(store::ReadTransaction& transaction,
                                                              std::string_view after_id,
                                                              int limit) {
  MORTISE_ASSIGN_OR_RETURN(
      const std::vector<store::Record> records,
      transaction.List(kStates,
                       {.after_key = std::string(after_id), .limit = limit, .descending = true}));
  std::vector<Operation> operations;
  for (const store::Record& record : records) {
    MORTISE_ASSIGN_OR_RETURN(Operation operation, OperationOf(record));
    MORTISE_RETURN_IF_ERROR(LoadBytes(transaction, record.key, &operation));
    operations.push_back(std::move(operation));
  }
  return operations;
}

absl::Status OperationRecords::Visit(store::ReadTransaction& transaction, std::string_view after_id,
                                     const OperationFilter& filter,
                                     const std::function<bool(const Operation&)>& visit) {
  store::ListOptions options{
      .after_key = std::string(after_id), .limit = kVisitedAtOnce, .descending = true};
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records,
                             transaction.List(kStates, options));
    for (const store::Record& record : records) {
      MORTISE_ASSIGN_OR_RETURN(Operation operation, OperationOf(record));
      if (!Passes(operation, filter)) continue;
      MORTISE_RETURN_IF_ERROR(LoadBytes(transaction, record.key, &operation));
      if (!visit(operation)) return absl::OkStatus();
    }
    if (static_cast<int>(records.size()) < options.limit) return absl::OkStatus();
    options.after_key = records.back().key;
  }
}

absl::Status OperationRecords::Save(store::Transaction& transaction, std::string_view event,
                                    Operation* operation) {
  MORTISE_ASSIGN_OR_RETURN(const std::string id, IdOf(operation->name));
  MORTISE_ASSIGN_OR_RETURN(operation->revision,
                           transaction.Put(kStates, id, StateJson(*operation)));
  operation->updated_at = transaction.Now();
  if (event.empty()) return absl::OkStatus();
  return transaction.AppendEvent({.type = absl::StrCat("operation.", std::string(event)),
                                  .subject = operation->name,
                                  .payload = describe_(*operation),
                                  .trace_id = operation->trace_id});
}

absl::Status OperationRecords::SaveResult(store::Transaction& transaction, std::string_view id,
                                          std::string_view result) {
  return transaction.Put(kResults, id, result).status();
}

absl::Status OperationRecords::SaveCheckpoint(store::Transaction& transaction, std::string_view id,
                                              std::string_view checkpoint) {
  return transaction.Put(kCheckpoints, id, checkpoint).status();
}

absl::StatusOr<std::string> OperationRecords::LoadCheckpoint(store::ReadTransaction& transaction,
                                                             std::string_view id) {
  return BytesOrNone(transaction.Get(kCheckpoints, id));
}

}  // namespace mortise::operations
