#include "common/rpc/call_state.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/logging.h"
#include "common/base/violation_lists.h"
#include "common/rpc/message_check.h"
#include "mortise/v1/access.pb.h"

namespace mortise::rpc {
namespace {

constexpr std::size_t kMaxTraceIdLength = 128;

std::string Metadata(const grpc::CallbackServerContext& context, const char* key) {
  const auto found = context.client_metadata().find(key);
  if (found == context.client_metadata().end()) return "";
  return std::string(found->second.data(), found->second.size());
}

// Streams that clients send to are calls: a machine's bridge, say, must be heard.
Lane LaneOf(const v1::Access& access, const google::protobuf::MethodDescriptor& method) {
  if (access.urgent()) return Lane::kUrgent;
  const bool streams = method.server_streaming() && !method.client_streaming();
  return streams || access.waits() ? Lane::kStreams : Lane::kCalls;
}

bool IsTraceId(const std::string& text) {
  return !text.empty() && text.size() <= kMaxTraceIdLength &&
         std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c < 127; });
}

absl::Status Undeclared(const std::string& method) {
  return WithDetail(absl::PermissionDeniedError(absl::StrCat(method, " has no access rule")),
                    {"ACCESS_UNDECLARED", method});
}

// Whether `path` is `field` or lies in it: "price.amount" in "price".
bool LiesIn(const std::string& path, const std::string& field) {
  if (!path.starts_with(field)) return false;
  return path.size() == field.size() || path[field.size()] == '.' || path[field.size()] == '[';
}

// A refusal for numbers, with what else is wrong.
absl::Status WithAllElse(const absl::Status& numbers, const absl::Status& checked) {
  std::vector<FieldViolation> all = AllViolationsOf(numbers);
  const std::vector<FieldViolation> told = all;
  for (FieldViolation& violation : AllViolationsOf(checked)) {
    if (std::none_of(told.begin(), told.end(), [&](const FieldViolation& other) {
          return LiesIn(violation.field, other.field) || LiesIn(other.field, violation.field);
        })) {
      all.push_back(std::move(violation));
    }
  }
  return InvalidFields(all);
}

}  // namespace

MethodInfo FindMethod(std::string_view service, std::string_view method) {
  MethodInfo info;
  info.name = absl::StrCat(std::string(service), "/", std::string(method));
  const auto* descriptor =
      google::protobuf::DescriptorPool::generated_pool()->FindServiceByName(std::string(service));
  const auto* found =
      descriptor == nullptr ? nullptr : descriptor->FindMethodByName(std::string(method));
  if (found == nullptr || !found->options().HasExtension(v1::access)) {
    info.usable = Undeclared(info.name);
    return info;
  }
  const v1::Access& access = found->options().GetExtension(v1::access);
  info.role = static_cast<Role>(access.role());
  info.mutates = access.mutates();
  info.lane = LaneOf(access, *found);
  if (info.role == Role::kNone) info.usable = Undeclared(info.name);
  return info;
}

CallState::CallState(Dispatcher* dispatcher, const MethodInfo* method,
                     const grpc::CallbackServerContext& context)
    : dispatcher_(dispatcher),
      method_(method),
      begun_at_(absl::Now()),
      deadline_(absl::FromChrono(context.deadline())),
      signed_identity_(Metadata(context, kIdentityMetadata)),
      trace_id_(Metadata(context, kTraceMetadata)) {
  // "No deadline" arrives as a date centuries away.
  if (deadline_ > begun_at_ + absl::Hours(24 * 365 * 10)) deadline_ = absl::InfiniteFuture();
}

absl::Status CallState::Begin() {
  {
    std::lock_guard lock(mutex_);
    begun_ = true;
  }
  return dispatcher_->Begin(shared_from_this());
}

absl::Status CallState::Authenticate() {
  IdentityVerifier* verifier = dispatcher_->options().verifier;
  if (verifier == nullptr) {
    identity_.subject = "users/developer";
    identity_.role = Role::kAdmin;
    identity_.trace_id = IsTraceId(trace_id_) ? trace_id_ : NewIdentifier();
    signed_identity_.clear();
    return absl::OkStatus();
  }
  if (signed_identity_.empty()) {
    return IdentityInvalid("the call carries no identity; call through the gateway");
  }
  MORTISE_ASSIGN_OR_RETURN(identity_, verifier->Verify(signed_identity_));
  if (identity_.trace_id.empty()) identity_.trace_id = trace_id_;
  if (!IsTraceId(identity_.trace_id)) identity_.trace_id = NewIdentifier();
  return absl::OkStatus();
}

absl::Status CallState::Admit() {
  MORTISE_RETURN_IF_ERROR(Authenticate());
  MORTISE_RETURN_IF_ERROR(method_->usable);
  if (identity_.role < method_->role) return RoleRequired(method_->name, RoleName(method_->role));
  if (cancelled_) return absl::CancelledError("the caller went away");
  if (cancelled()) return absl::DeadlineExceededError("the deadline passed before the call began");
  return absl::OkStatus();
}

absl::Status CallState::CheckRequest(const google::protobuf::Message& request,
                                     const std::function<absl::Status()>& explanation) const {
  const absl::Status numbers = CheckMessage(request);
  if (numbers.ok() || !explanation) return numbers;
  return WithAllElse(numbers, RunGuarded(explanation));
}

absl::Status CallState::RunGuarded(const std::function<absl::Status()>& work) const {
  TraceScope trace(identity_.trace_id);
  std::string what;
  try {
    return work();
  } catch (const std::exception& exception) {
    what = exception.what();
  } catch (...) {
    what = "unknown exception";
  }
  Log(LogLevel::kError, "a handler threw", {{"method", method_->name}, {"what", what}});
  return WithDetail(
      absl::InternalError(absl::StrCat(method_->name, " failed; trace id ", identity_.trace_id)),
      {"HANDLER_FAILED", ""});
}

void CallState::Cancel() {
  cancelled_ = true;
  Stop();
}

void CallState::Stop() {
  std::vector<std::function<void()>> callbacks;
  {
    std::lock_guard lock(mutex_);
    if (ended_) return;
    stopped_ = true;
    callbacks = std::exchange(stop_callbacks_, {});
  }
  for (auto& callback : callbacks) dispatcher_->Submit(std::move(callback), method_->lane);
}

void CallState::OnStop(std::function<void()> callback) {
  {
    std::lock_guard lock(mutex_);
    if (ended_) return;
    if (!stopped_) {
      stop_callbacks_.push_back(std::move(callback));
      return;
    }
  }
  dispatcher_->Submit(std::move(callback), method_->lane);
}

void CallState::End(const absl::Status& status) {
  std::vector<std::function<void()>> dropped;
  {
    std::lock_guard lock(mutex_);
    if (ended_ || !begun_) return;
    ended_ = true;
    dropped = std::exchange(stop_callbacks_, {});
  }
  TraceScope trace(identity_.trace_id);
  dispatcher_->End(shared_from_this(), status);
}

bool CallState::cancelled() const { return cancelled_ || absl::Now() > deadline_; }

}  // namespace mortise::rpc
