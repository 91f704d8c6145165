#include "gateway/forwarding/proxied_call.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "gateway/admission/strangers.h"
#include "gateway/forwarding/inflate.h"
#include "gateway/forwarding/wire.h"

namespace mortise::gateway {
namespace {

constexpr char kRequestIdHeader[] = "x-request-id";

std::string_view View(const grpc::string_ref& text) { return {text.data(), text.size()}; }

std::string_view Find(const std::multimap<grpc::string_ref, grpc::string_ref>& metadata,
                      const char* key) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? std::string_view() : View(found->second);
}

bool IsPassedOn(std::string_view key, std::string_view value) {
  return !IsReservedMetadata(key) && IsLegalMetadata(key, value);
}

// A failure to connect is gRPC's own words about sockets, without the details our services attach.
bool IsUnreachable(const grpc::Status& status) {
  return status.error_code() == grpc::StatusCode::UNAVAILABLE && status.error_details().empty();
}

// gRPC's servers answer a message that they cannot decode as if there were no such method.
bool MayBeUnreadable(const grpc::Status& status) {
  return status.error_code() == grpc::StatusCode::UNIMPLEMENTED && status.error_details().empty();
}

}  // namespace

ProxiedCall::ProxiedCall(const ProxyOptions& proxy, const MethodRoute* method,
                         grpc::GenericCallbackServerContext* context)
    : proxy_(proxy), method_(method), context_(context) {
  proxy_.log->Begin();
  const std::string_view given = Find(context_->client_metadata(), kRequestIdHeader);
  request_id_ = IsRequestId(given) ? std::string(given) : NewIdentifier();
  context_->AddInitialMetadata(kRequestIdHeader, request_id_);
}

absl::Status ProxiedCall::Admit() {
  if (method_ == nullptr) {
    return NotBuilt(absl::StrCat("the method ", context_->method()));
  }
  if (context_->client_metadata().count("authorization") > 1) return SeveralTokens();
  MORTISE_ASSIGN_OR_RETURN(
      caller_, proxy_.admission->Authenticate(Find(context_->client_metadata(), "authorization")));
  MORTISE_RETURN_IF_ERROR(proxy_.admission->Authorize(*method_, *caller_));
  MORTISE_RETURN_IF_ERROR(CheckMetadata());
  // The HTTP door counts what it must answer before this call begins.
  const std::string_view pass = Find(context_->client_metadata(), kCountedMetadata);
  if (pass == proxy_.open_calls->pass()) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(place_, proxy_.open_calls->Enter(method_->kind, caller_->subject));
  if (proxy_.strangers->MayBe()) proxy_.strangers->Admit(context_->peer());
  return absl::OkStatus();
}

absl::Status ProxiedCall::CheckMetadata() const {
  PassedMetadata passed;
  for (const auto& [key, value] : context_->client_metadata()) {
    if (IsPassedOn(View(key), View(value))) passed.Add(View(key), View(value));
  }
  return passed.Check("metadata");
}

absl::Status ProxiedCall::Expand(grpc::ByteBuffer& message) {
  room_.reset();
  MORTISE_ASSIGN_OR_RETURN(const bool expanded, Inflate(message));
  if (!expanded || !IsLarge(message)) return absl::OkStatus();
  room_ = proxy_.bodies->Take(caller_->subject, static_cast<int64_t>(message.Length()));
  return room_ != nullptr ? absl::OkStatus() : TooManyAtATime("large messages");
}

GenericStub* ProxiedCall::Prepare(const grpc::ByteBuffer* first, absl::Status& error) {
  std::string request;
  if (first != nullptr && method_->destination != Destination::kService) request = ToString(*first);
  absl::StatusOr<std::string> service = ServiceOf(*method_, request, *proxy_.upstreams);
  if (!service.ok()) {
    error = service.status();
    return nullptr;
  }
  if (first != nullptr && IsLarge(*first) &&
      !proxy_.contract->IsRequest(*method_, ToString(*first))) {
    error = UnreadableRequest();
    return nullptr;
  }
  service_ = *std::move(service);
  if (place_ != nullptr) error = place_->EnterService(service_);
  if (!error.ok()) return nullptr;
  const bool endless = method_->kind == CallKind::kStream;
  upstream_.set_deadline(endless ? std::min(context_->deadline(), ExpiryOf(*caller_))
                                 : context_->deadline());
  if (endless) token_end_.emplace(*context_, *caller_);
  for (const auto& [key, value] : context_->client_metadata()) {
    if (!IsPassedOn(View(key), View(value))) continue;
    upstream_.AddMetadata(std::string(View(key)), std::string(View(value)));
  }
  upstream_.AddMetadata(rpc::kTraceMetadata, request_id_);
  const std::string identity = proxy_.admission->SignedIdentity(*caller_);
  if (!identity.empty()) upstream_.AddMetadata(rpc::kIdentityMetadata, identity);
  connection_ = proxy_.upstreams->Take(service_, method_->kind);
  patience_.emplace(connection_->channel, upstream_,
                    absl::ToChronoMilliseconds(proxy_.upstreams->options().patience));
  return connection_->stub.get();
}

void ProxiedCall::CopyInitialMetadata() {
  for (const auto& [key, value] : upstream_.GetServerInitialMetadata()) {
    if (!IsPassedOn(View(key), View(value))) continue;
    context_->AddInitialMetadata(std::string(View(key)), std::string(View(value)));
  }
}

grpc::Status ProxiedCall::Conclude(const grpc::Status& upstream, const grpc::ByteBuffer* request) {
  for (const auto& [key, value] : upstream_.GetServerTrailingMetadata()) {
    // The status details are among these as `grpc-status-details-bin`; they travel in the status.
    if (!IsPassedOn(View(key), View(value))) continue;
    context_->AddTrailingMetadata(std::string(View(key)), std::string(View(value)));
  }
  if (ExpiredWith(upstream)) {
    return rpc::ToGrpc(IdentityInvalid("the token expired, and the stream ends with it"));
  }
  if (request != nullptr && MayBeUnreadable(upstream) &&
      !proxy_.contract->IsRequest(*method_, ToString(*request))) {
    return rpc::ToGrpc(UnreadableRequest());
  }
  if (patience_ && patience_->exhausted()) {
    return rpc::ToGrpc(PeerUnavailable(
        service_, absl::StrCat("the ", service_, " service cannot be reached; waited ",
                               absl::FormatDuration(proxy_.upstreams->options().patience))));
  }
  if (!IsUnreachable(upstream)) return upstream;
  return rpc::ToGrpc(PeerUnavailable(
      service_,
      absl::StrCat("the ", service_, " service cannot be reached: ", upstream.error_message())));
}

// A stream ends with its token by its deadline, which a service may also notice and say so.
bool ProxiedCall::ExpiredWith(const grpc::Status& upstream) const {
  const auto now = std::chrono::system_clock::now();
  const bool ended_for_time = upstream.error_code() == grpc::StatusCode::DEADLINE_EXCEEDED ||
                              upstream.error_code() == grpc::StatusCode::CANCELLED;
  return method_->kind == CallKind::kStream && ended_for_time && now >= ExpiryOf(*caller_) &&
         now < context_->deadline();
}

void ProxiedCall::Record(const grpc::Status& status) {
  CallRecord record;
  record.method = method_;
  record.path = context_->method();
  if (caller_ != nullptr) record.subject = caller_->subject;
  record.request_id = request_id_;
  record.code = status.error_code();
  record.duration = std::chrono::steady_clock::now() - begin_;
  proxy_.log->End(record);
}

}  // namespace mortise::gateway
