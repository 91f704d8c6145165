#include "common/host/operation_codec.h"

#include <google/protobuf/any.pb.h>
#include <google/protobuf/message.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/rpc/call.h"
#include "common/rpc/status_mapping.h"
#include "google/rpc/status.pb.h"
#include "mortise/v1/operations.pb.h"

namespace mortise::rpc {
namespace {

constexpr operations::OperationState kStates[] = {
    operations::OperationState::kPending, operations::OperationState::kRunning,
    operations::OperationState::kSucceeded, operations::OperationState::kFailed,
    operations::OperationState::kCancelled};

v1::Operation::State StateOf(operations::OperationState state) {
  switch (state) {
    case operations::OperationState::kPending:
      return v1::Operation::PENDING;
    case operations::OperationState::kRunning:
      return v1::Operation::RUNNING;
    case operations::OperationState::kSucceeded:
      return v1::Operation::SUCCEEDED;
    case operations::OperationState::kFailed:
      return v1::Operation::FAILED;
    case operations::OperationState::kCancelled:
      return v1::Operation::CANCELLED;
  }
  return v1::Operation::STATE_UNSPECIFIED;
}

google::protobuf::Timestamp Timestamp(absl::Time time) {
  return google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(time));
}

}  // namespace

operations::NewOperation OperationOf(const Call& call, const std::string& kind,
                                     const std::string& subject, std::string bytes) {
  return {.kind = kind,
          .request = std::move(bytes),
          .subject = subject,
          .trace_id = call.identity().trace_id,
          .creator = call.identity().subject,
          .method = call.method()};
}

std::string PackResult(const google::protobuf::Message& result) {
  google::protobuf::Any any;
  any.PackFrom(result);
  return any.SerializeAsString();
}

v1::Operation ToProto(const operations::Operation& operation) {
  v1::Operation proto;
  proto.set_name(operation.name);
  proto.set_kind(operation.kind);
  proto.set_subject(operation.subject);
  SetTagsAndCreator(operation, &proto);
  proto.set_method(operation.method);
  proto.set_cancel_requested(operation.cancel_requested);
  proto.set_state(StateOf(operation.state));
  v1::Progress* progress = proto.mutable_progress();
  progress->set_done(operation.progress.done);
  progress->set_total(operation.progress.total);
  if (operation.progress.has_best) progress->set_best(operation.progress.best_so_far);
  progress->set_message(operation.progress.message);
  if (!operation.result.empty() && !proto.mutable_result()->ParseFromString(operation.result)) {
    proto.clear_result();
  }
  if (!operation.error.ok()) *proto.mutable_error() = ToProto(operation.error);
  *proto.mutable_create_time() = Timestamp(operation.created_at);
  *proto.mutable_update_time() = Timestamp(operation.updated_at);
  return proto;
}

absl::StatusOr<std::vector<operations::OperationState>> StatesFrom(
    const google::protobuf::RepeatedField<int>& states) {
  std::vector<operations::OperationState> found;
  if (states.size() > static_cast<int>(std::size(kStates))) {
    return InvalidField("states", absl::StrCat("has ", states.size(), " entries; there are ",
                                               std::size(kStates), " states"));
  }
  for (int i = 0; i < states.size(); ++i) {
    const auto* const known =
        std::find_if(std::begin(kStates), std::end(kStates),
                     [&](operations::OperationState state) { return StateOf(state) == states[i]; });
    if (known == std::end(kStates)) {
      return InvalidField(absl::StrCat("states[", i, "]"), "must be a state of operations");
    }
    found.push_back(*known);
  }
  return found;
}

}  // namespace mortise::rpc
