#include "common/base/errors.h"

#include <algorithm>

#include "absl/strings/cord.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/field_violations.h"
#include "common/base/string_views.h"

namespace mortise {
namespace {

constexpr std::string_view kReasonPayload = "mortise/reason";
constexpr std::string_view kFieldPayload = "mortise/field";
constexpr std::string_view kViolationsPayload = "mortise/violations";  // texts with their lengths

absl::Status Make(absl::StatusCode code, std::string_view reason, std::string_view field,
                  std::string_view message) {
  return WithDetail(absl::Status(code, absl::string_view(message.data(), message.size())),
                    {std::string(reason), std::string(field)});
}

// Takes a text written as "5:hello" off the front of `rest`.
std::string TakeText(std::string_view& rest) {
  const std::size_t colon = rest.find(':');
  std::size_t length = 0;
  if (colon == std::string_view::npos ||
      !absl::SimpleAtoi(AbslView(rest.substr(0, colon)), &length)) {
    rest = {};
    return "";
  }
  std::string text(rest.substr(colon + 1, length));
  rest.remove_prefix(std::min(rest.size(), colon + 1 + length));
  return text;
}

}  // namespace

absl::Status InvalidField(std::string_view field, std::string_view message) {
  return Make(absl::StatusCode::kInvalidArgument, "FIELD_INVALID", field,
              absl::StrCat(AbslView(field), ": ", AbslView(message)));
}

absl::Status InvalidFields(const std::vector<FieldViolation>& violations) {
  if (violations.size() == 1) return InvalidField(violations[0].field, violations[0].message);
  std::string message = absl::StrCat(violations.size(), " findings");
  std::string payload;
  for (const FieldViolation& violation : violations) {
    absl::StrAppend(&message, payload.empty() ? ": " : "; ", violation.field, ": ",
                    violation.message);
    absl::StrAppend(&payload, violation.field.size(), ":", violation.field,
                    violation.message.size(), ":", violation.message);
  }
  absl::Status status = Make(absl::StatusCode::kInvalidArgument, "FIELD_INVALID",
                             violations.empty() ? "" : violations[0].field, message);
  status.SetPayload(AbslView(kViolationsPayload), absl::Cord(payload));
  return status;
}

absl::Status ResourceNotFound(std::string_view name) {
  return Make(absl::StatusCode::kNotFound, "RESOURCE_NOT_FOUND", name,
              absl::StrCat("there is no '", AbslView(name), "'"));
}

absl::Status ResourceExists(std::string_view name) {
  return Make(absl::StatusCode::kAlreadyExists, "RESOURCE_EXISTS", name,
              absl::StrCat("'", AbslView(name), "' exists already"));
}

absl::Status StaleRevision(std::string_view name, long expected, long actual) {
  return Make(absl::StatusCode::kAborted, "STALE_REVISION", name,
              absl::StrCat("'", AbslView(name), "' is at revision ", actual, ", not ", expected,
                           "; read it again and repeat the change"));
}

absl::Status StaleAttempt(std::string_view name, long attempt, long current) {
  return Make(absl::StatusCode::kAborted, "STALE_ATTEMPT", name,
              absl::StrCat("'", AbslView(name), "' is at attempt ", current,
                           "; the result of attempt ", attempt, " is refused"));
}

absl::Status TooLarge(std::string_view what, std::string_view limit) {
  return Make(absl::StatusCode::kResourceExhausted, "TOO_LARGE", what,
              absl::StrCat(AbslView(what), " is larger than ", AbslView(limit)));
}

absl::Status PreconditionFailed(std::string_view reason, std::string_view message,
                                std::string_view field) {
  return Make(absl::StatusCode::kFailedPrecondition, reason, field, message);
}

absl::Status RoleRequired(std::string_view method, std::string_view role) {
  return Make(absl::StatusCode::kPermissionDenied, "ROLE_REQUIRED", method,
              absl::StrCat(AbslView(method), " needs the role '", AbslView(role), "'"));
}

absl::Status IdentityInvalid(std::string_view message) {
  return Make(absl::StatusCode::kUnauthenticated, "IDENTITY_INVALID", "authorization", message);
}

absl::Status PeerUnavailable(std::string_view peer, std::string_view message) {
  return Make(absl::StatusCode::kUnavailable, "PEER_UNAVAILABLE", peer,
              absl::StrCat(AbslView(peer), ": ", AbslView(message)));
}

absl::Status StorageFailed(std::string_view what, std::string_view message) {
  return Make(absl::StatusCode::kInternal, "STORAGE_FAILED", what,
              absl::StrCat(AbslView(what), ": ", AbslView(message)));
}

absl::Status NotBuilt(std::string_view what) {
  return Make(absl::StatusCode::kUnimplemented, "NOT_BUILT", what,
              absl::StrCat(AbslView(what), " is not built yet"));
}

absl::Status WithDetail(absl::Status status, const ErrorDetail& detail) {
  status.SetPayload(AbslView(kReasonPayload), absl::Cord(detail.reason));
  status.SetPayload(AbslView(kFieldPayload), absl::Cord(detail.field));
  return status;
}

ErrorDetail DetailOf(const absl::Status& status) {
  ErrorDetail detail;
  if (auto reason = status.GetPayload(AbslView(kReasonPayload)))
    detail.reason = std::string(*reason);
  if (auto field = status.GetPayload(AbslView(kFieldPayload))) detail.field = std::string(*field);
  return detail;
}

std::vector<FieldViolation> ViolationsOf(const absl::Status& status) {
  std::vector<FieldViolation> violations;
  const auto payload = status.GetPayload(AbslView(kViolationsPayload));
  if (!payload) return violations;
  const std::string text(*payload);
  for (std::string_view rest = text; !rest.empty();) {
    std::string field = TakeText(rest);
    violations.push_back({std::move(field), TakeText(rest)});
  }
  return violations;
}

absl::Status UnderField(std::string_view prefix, const absl::Status& status) {
  if (status.ok()) return status;
  std::vector<FieldViolation> violations = ViolationsOf(status);
  for (FieldViolation& violation : violations) {
    violation.field = absl::StrCat(AbslView(prefix), ".", violation.field);
  }
  if (!violations.empty()) return InvalidFields(violations);
  ErrorDetail detail = DetailOf(status);
  const char* const separator = detail.field.empty() ? ": " : ".";
  detail.field = detail.field.empty() ? std::string(prefix)
                                      : absl::StrCat(AbslView(prefix), ".", detail.field);
  return WithDetail(
      absl::Status(status.code(), absl::StrCat(AbslView(prefix), separator, status.message())),
      detail);
}

}  // namespace mortise
