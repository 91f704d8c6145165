#include "common/rpc/status_mapping.h"

#include <grpcpp/support/status.h>

#include <string>
#include <string_view>

#include "common/base/errors.h"
#include "google/rpc/status.pb.h"

namespace mortise::rpc {
namespace {

constexpr char kDomain[] = "mortise.dev";
constexpr char kResource[] = "resource";

// Messages travel in HTTP/2 headers, twice; clients accept 8 KiB of those in all.
constexpr std::size_t kLongestMessage = 2000;

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

// `text` as valid UTF-8 of bounded length.
std::string Printable(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = Utf8SequenceLength(text);
    if (result.size() + length > kLongestMessage) return result + "…";
    result += length == 0 ? "?" : std::string(text.substr(0, length));
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result;
}

absl::StatusCode WireCode(absl::StatusCode code) {
  return code == absl::StatusCode::kUnknown ? absl::StatusCode::kInternal : code;
}

}  // namespace

google::rpc::Status ToProto(const absl::Status& status) {
  google::rpc::Status proto;
  proto.set_code(static_cast<int>(WireCode(status.code())));
  proto.set_message(Printable({status.message().data(), status.message().size()}));
  const ErrorDetail detail = DetailOf(status);
  if (detail.reason.empty() && detail.field.empty()) return proto;

  const bool names_field = status.code() == absl::StatusCode::kInvalidArgument;
  google::rpc::ErrorInfo info;
  info.set_reason(Printable(detail.reason));
  info.set_domain(kDomain);
  if (!names_field && !detail.field.empty()) {
    (*info.mutable_metadata())[kResource] = Printable(detail.field);
  }
  proto.add_details()->PackFrom(info);
  if (names_field && !detail.field.empty()) {
    google::rpc::BadRequest bad_request;
    auto* violation = bad_request.add_field_violations();
    violation->set_field(Printable(detail.field));
    violation->set_description(proto.message());
    proto.add_details()->PackFrom(bad_request);
  }
  return proto;
}

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
