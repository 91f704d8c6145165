#include "common/rpc/status_mapping.h"

#include <grpcpp/support/status.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/string_views.h"
#include "google/rpc/status.pb.h"

namespace mortise::rpc {
namespace {

constexpr char kDomain[] = "mortise.dev";
constexpr char kResource[] = "resource";

// A failure travels in HTTP/2 headers: its message percent-encoded, and once more in the details,
// base64. Clients accept 8 KiB of headers in all; a connection on which more came is of no use to
// other calls either. So long texts are cut off, and of many fields only the first are named.
constexpr std::size_t kMaxMessageLength = 1500;
constexpr std::size_t kMaxMessageOfSeveralLength = 700;  // leaves room for the violations
constexpr std::size_t kMaxFieldLength = 300;
constexpr std::size_t kMaxReasonLength = 100;
constexpr std::size_t kAllViolations = 3600;

// The length of the valid UTF-8 sequence at the start of `text`; 0 if there is none.
std::size_t Utf8SequenceLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xC0) != 0x80) return 0;
  }
  // Overlong forms, surrogates and code points past U+10FFFF.
  if (first == 0xE0 && byte(1) < 0xA0) return 0;
  if (first == 0xED && byte(1) > 0x9F) return 0;
  if (first == 0xF0 && byte(1) < 0x90) return 0;
  if (first == 0xF4 && byte(1) > 0x8F) return 0;
  return length;
}

// How many bytes `sequence` takes when percent-encoded.
std::size_t EncodedLength(std::string_view sequence) {
  const char first = sequence.front();
  return first >= ' ' && first <= '~' && first != '%' ? 1 : 3 * sequence.size();
}

// `text` as valid UTF-8 that takes about `limit` bytes at most when percent-encoded.
std::string Printable(std::string_view text, std::size_t limit) {
  std::string result;
  std::size_t encoded = 0;
  while (!text.empty()) {
    const std::size_t length = Utf8SequenceLength(text);
    const std::string_view next = length == 0 ? std::string_view("?") : text.substr(0, length);
    encoded += EncodedLength(next);
    if (encoded > limit) return result + "…";
    result += next;
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

// As many of the fields at fault as there is room for.
google::rpc::BadRequest ToBadRequest(const absl::Status& status, const ErrorDetail& detail) {
  google::rpc::BadRequest bad_request;
  std::vector<FieldViolation> violations = ViolationsOf(status);
  if (violations.empty()) violations.push_back({detail.field, std::string(status.message())});
  std::size_t length = 0;
  for (const FieldViolation& from : violations) {
    google::rpc::BadRequest::FieldViolation violation;
    violation.set_field(Printable(from.field, kMaxFieldLength));
    violation.set_description(Printable(from.message, kMaxMessageLength));
    length += violation.ByteSizeLong() + 4;
    if (length > kAllViolations) break;
    *bad_request.add_field_violations() = std::move(violation);
  }
  return bad_request;
}

absl::StatusCode WireCode(absl::StatusCode code) {
  return code == absl::StatusCode::kUnknown ? absl::StatusCode::kInternal : code;
}

}  // namespace

google::rpc::Status ToProto(const absl::Status& status) {
  google::rpc::Status proto;
  proto.set_code(static_cast<int>(WireCode(status.code())));
  const bool several = !ViolationsOf(status).empty();
  proto.set_message(Printable(StandardView(status.message()),
                              several ? kMaxMessageOfSeveralLength : kMaxMessageLength));
  const ErrorDetail detail = DetailOf(status);
  if (detail.reason.empty() && detail.field.empty()) return proto;

  const bool names_field = status.code() == absl::StatusCode::kInvalidArgument;
  google::rpc::ErrorInfo info;
  info.set_reason(Printable(detail.reason, kMaxReasonLength));
  info.set_domain(kDomain);
  if (!names_field && !detail.field.empty()) {
    (*info.mutable_metadata())[kResource] = Printable(detail.field, kMaxFieldLength);
  }
  proto.add_details()->PackFrom(info);
  if (names_field && !detail.field.empty()) {
    proto.add_details()->PackFrom(ToBadRequest(status, detail));
  }
  return proto;
}

namespace {

// The failure of several fields, with its message as it came.
absl::Status FromViolations(const google::rpc::Status& proto,
                            const google::rpc::BadRequest& bad_request) {
  std::vector<FieldViolation> violations;
  for (const auto& violation : bad_request.field_violations()) {
    violations.push_back({violation.field(), violation.description()});
  }
  absl::Status status(static_cast<absl::StatusCode>(proto.code()), proto.message());
  InvalidFields(violations).ForEachPayload([&](absl::string_view type, const absl::Cord& payload) {
    status.SetPayload(type, payload);
  });
  return status;
}

}  // namespace

absl::Status FromProto(const google::rpc::Status& proto) {
  if (proto.code() == 0) return absl::OkStatus();
  absl::Status status(static_cast<absl::StatusCode>(proto.code()), proto.message());
  ErrorDetail detail;
  for (const google::protobuf::Any& any : proto.details()) {
    google::rpc::ErrorInfo info;
    google::rpc::BadRequest bad_request;
    if (any.UnpackTo(&info)) {
      detail.reason = info.reason();
      const auto resource = info.metadata().find(kResource);
      if (resource != info.metadata().end()) detail.field = resource->second;
    } else if (any.UnpackTo(&bad_request) && bad_request.field_violations_size() > 0) {
      if (bad_request.field_violations_size() > 1) status = FromViolations(proto, bad_request);
      detail.field = bad_request.field_violations(0).field();
    }
  }
  if (detail.reason.empty() && detail.field.empty()) return status;
  return WithDetail(status, detail);
}

grpc::Status ToGrpc(const absl::Status& status) {
  if (status.ok()) return grpc::Status::OK;
  const google::rpc::Status proto = ToProto(status);
  return grpc::Status(static_cast<grpc::StatusCode>(proto.code()), proto.message(),
                      proto.details().empty() ? std::string() : proto.SerializeAsString());
}

absl::Status FromGrpc(const grpc::Status& status) {
  if (status.ok()) return absl::OkStatus();
  google::rpc::Status proto;
  if (!proto.ParseFromString(status.error_details())) proto.Clear();
  proto.set_code(status.error_code());
  proto.set_message(status.error_message());
  return FromProto(proto);
}

}  // namespace mortise::rpc
