#include "common/base/errors.h"

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"

namespace mortise {
namespace {

constexpr std::string_view kReasonPayload = "mortise/reason";
constexpr std::string_view kFieldPayload = "mortise/field";

absl::Status Make(absl::StatusCode code, std::string_view reason, std::string_view field,
                  std::string_view message) {
  return WithDetail(absl::Status(code, absl::string_view(message.data(), message.size())),
                    {std::string(reason), std::string(field)});
}

absl::string_view View(std::string_view text) { return {text.data(), text.size()}; }

}  // namespace

absl::Status InvalidField(std::string_view field, std::string_view message) {
  return Make(absl::StatusCode::kInvalidArgument, "FIELD_INVALID", field,
              absl::StrCat(View(field), ": ", View(message)));
}

absl::Status ResourceNotFound(std::string_view name) {
  return Make(absl::StatusCode::kNotFound, "RESOURCE_NOT_FOUND", name,
              absl::StrCat("there is no '", View(name), "'"));
}

absl::Status ResourceExists(std::string_view name) {
  return Make(absl::StatusCode::kAlreadyExists, "RESOURCE_EXISTS", name,
              absl::StrCat("'", View(name), "' exists already"));
}

absl::Status StaleRevision(std::string_view name, long expected, long actual) {
  return Make(absl::StatusCode::kAborted, "STALE_REVISION", name,
              absl::StrCat("'", View(name), "' is at revision ", actual, ", not ", expected,
                           "; read it again and repeat the change"));
}

absl::Status StaleAttempt(std::string_view name, long attempt, long current) {
  return Make(absl::StatusCode::kAborted, "STALE_ATTEMPT", name,
              absl::StrCat("'", View(name), "' is at attempt ", current, "; the result of attempt ",
                           attempt, " is refused"));
}

absl::Status TooLarge(std::string_view what, std::string_view limit) {
  return Make(absl::StatusCode::kResourceExhausted, "TOO_LARGE", what,
              absl::StrCat(View(what), " is larger than ", View(limit)));
}

absl::Status PreconditionFailed(std::string_view reason, std::string_view message,
                                std::string_view field) {
  return Make(absl::StatusCode::kFailedPrecondition, reason, field, message);
}

absl::Status RoleRequired(std::string_view method, std::string_view role) {
  return Make(absl::StatusCode::kPermissionDenied, "ROLE_REQUIRED", method,
              absl::StrCat(View(method), " needs the role '", View(role), "'"));
}

absl::Status IdentityInvalid(std::string_view message) {
  return Make(absl::StatusCode::kUnauthenticated, "IDENTITY_INVALID", "authorization", message);
}

absl::Status PeerUnavailable(std::string_view peer, std::string_view message) {
  return Make(absl::StatusCode::kUnavailable, "PEER_UNAVAILABLE", peer,
              absl::StrCat(View(peer), ": ", View(message)));
}

absl::Status StorageFailed(std::string_view what, std::string_view message) {
  return Make(absl::StatusCode::kInternal, "STORAGE_FAILED", what,
              absl::StrCat(View(what), ": ", View(message)));
}

absl::Status NotBuilt(std::string_view what) {
  return Make(absl::StatusCode::kUnimplemented, "NOT_BUILT", what,
              absl::StrCat(View(what), " is not built yet"));
}

absl::Status WithDetail(absl::Status status, const ErrorDetail& detail) {
  status.SetPayload(View(kReasonPayload), absl::Cord(detail.reason));
  status.SetPayload(View(kFieldPayload), absl::Cord(detail.field));
  return status;
}

ErrorDetail DetailOf(const absl::Status& status) {
  ErrorDetail detail;
  if (auto reason = status.GetPayload(View(kReasonPayload))) detail.reason = std::string(*reason);
  if (auto field = status.GetPayload(View(kFieldPayload))) detail.field = std::string(*field);
  return detail;
}

absl::Status UnderField(std::string_view prefix, const absl::Status& status) {
  if (status.ok()) return status;
  ErrorDetail detail = DetailOf(status);
  detail.field =
      detail.field.empty() ? std::string(prefix) : absl::StrCat(View(prefix), ".", detail.field);
  return WithDetail(absl::Status(status.code(), absl::StrCat(View(prefix), ".", status.message())),
                    detail);
}

}  // namespace mortise
