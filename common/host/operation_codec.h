// Operations of common/operations as mortise.v1.Operation.
#pragma once

#include <google/protobuf/message.h>
#include <google/protobuf/repeated_field.h>

#include <concepts>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "common/operations/operations.h"

namespace mortise::v1 {
class Operation;
}

namespace mortise::rpc {

class Call;

// Returns the operation that a call starts: `bytes` are its request, as its handler reads it.
operations::NewOperation OperationOf(const Call& call, const std::string& kind,
                                     const std::string& subject, std::string bytes);

// Returns the external ids and labels that a request gives the resource it makes. They are as they
// came: resources::CheckTags says what is wrong with them.
template <typename Request>
operations::OperationTags TagsOf(const Request& request) {
  return {.external_ids = {request.external_ids().begin(), request.external_ids().end()},
          .labels = {request.labels().begin(), request.labels().end()}};
}

// The same with the tags of `request`, where the handler reads other bytes than those of the
// request.
template <typename Request>
operations::NewOperation OperationOf(const Call& call, const std::string& kind,
                                     const std::string& subject, const Request& request,
                                     std::string bytes) {
  operations::NewOperation operation = OperationOf(call, kind, subject, std::move(bytes));
  operation.tags = TagsOf(request);
  return operation;
}

// The same where the handler reads the request itself.
template <typename Request>
requires std::derived_from<Request, google::protobuf::Message> operations::NewOperation OperationOf(
    const Call& call, const std::string& kind, const std::string& subject, const Request& request) {
  return OperationOf(call, kind, subject, request, request.SerializeAsString());
}

// Gives a resource that an operation made the operation's tags and creator, in place of its own.
template <typename Resource>
void SetTagsAndCreator(const operations::Operation& operation, Resource* resource) {
  resource->mutable_external_ids()->Assign(operation.tags.external_ids.begin(),
                                           operation.tags.external_ids.end());
  resource->mutable_labels()->clear();
  resource->mutable_labels()->insert(operation.tags.labels.begin(), operation.tags.labels.end());
  resource->set_creator(operation.creator);
}

// Returns what an operation's handler returns: `result`, packed with its type.
std::string PackResult(const google::protobuf::Message& result);

// Returns the operation as clients see it. A result that was not made by PackResult is left out.
v1::Operation ToProto(const operations::Operation& operation);

// Returns the states of common/operations that `states` names; INVALID_ARGUMENT naming the entry
// that is none.
absl::StatusOr<std::vector<operations::OperationState>> StatesFrom(
    const google::protobuf::RepeatedField<int>& states);

}  // namespace mortise::rpc
