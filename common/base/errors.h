// The catalogue of expected failures: one named factory for each kind of thing that can go wrong.
//
// Every status made here carries, beside its canonical code and a message a person can act on, two
// machine-readable details: a `reason` (an upper-case constant, stable across releases) and the
// path of the field or resource at fault. common/rpc turns them into gRPC error details.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/status.h"

namespace mortise {

// The machine-readable part of a failure. Both may be empty.
struct ErrorDetail {
  std::string reason;  // e.g. "FIELD_INVALID"
  std::string field;   // e.g. "parameters[2].value", or the resource name
};

// Returns INVALID_ARGUMENT, reason FIELD_INVALID: the value of `field` (a proto field path) is
// not usable.
absl::Status InvalidField(std::string_view field, std::string_view message);

// Returns NOT_FOUND, reason RESOURCE_NOT_FOUND: no resource of this name.
absl::Status ResourceNotFound(std::string_view name);

// ALREADY_EXISTS, reason RESOURCE_EXISTS.
absl::Status ResourceExists(std::string_view name);

// ABORTED, reason STALE_REVISION: the caller based its change on `expected`, the store has
// `actual`.
absl::Status StaleRevision(std::string_view name, long expected, long actual);

// ABORTED, reason STALE_ATTEMPT: a worker reports a task that has been leased again since.
absl::Status StaleAttempt(std::string_view name, long attempt, long current);

// Returns RESOURCE_EXHAUSTED, reason TOO_LARGE.
absl::Status TooLarge(std::string_view what, std::string_view limit);

// Returns FAILED_PRECONDITION with a reason of the caller's.
absl::Status PreconditionFailed(std::string_view reason, std::string_view message,
                                std::string_view field = "");

// PERMISSION_DENIED, reason ROLE_REQUIRED.
absl::Status RoleRequired(std::string_view method, std::string_view role);

// UNAUTHENTICATED, reason IDENTITY_INVALID.
absl::Status IdentityInvalid(std::string_view message);

// Returns UNAVAILABLE, reason PEER_UNAVAILABLE: another process cannot be reached; retry later.
absl::Status PeerUnavailable(std::string_view peer, std::string_view message);

// INTERNAL, reason STORAGE_FAILED: the database or the file system refused.
absl::Status StorageFailed(std::string_view what, std::string_view message);

// UNIMPLEMENTED, reason NOT_BUILT: listed in the README's status table.
absl::Status NotBuilt(std::string_view what);

// Adds or replaces the machine-readable part of `status` (no effect on OK).
absl::Status WithDetail(absl::Status status, const ErrorDetail& detail);

// Reads the machine-readable part back; empty where `status` carries none.
ErrorDetail DetailOf(const absl::Status& status);

// The same failure with `prefix` put before the field path: "q[1]" becomes "requests[3].q[1]".
absl::Status UnderField(std::string_view prefix, const absl::Status& status);

#define MORTISE_CONCAT_INNER(a, b) a##b
#define MORTISE_CONCAT(a, b) MORTISE_CONCAT_INNER(a, b)

// MORTISE_RETURN_IF_ERROR(F()): returns the status from the enclosing function if it is not OK.
// (The numbered names let one of these stand in a lambda inside another.)
#define MORTISE_RETURN_IF_ERROR(expression) \
  MORTISE_RETURN_IF_ERROR_AS(MORTISE_CONCAT(mortise_status_, __COUNTER__), expression)
#define MORTISE_RETURN_IF_ERROR_AS(name, expression)               \
  do {                                                             \
    if (absl::Status name = (expression); !name.ok()) return name; \
  } while (false)

// MORTISE_ASSIGN_OR_RETURN(auto x, F()): takes the value out of a StatusOr or returns its status.
#define MORTISE_ASSIGN_OR_RETURN(declaration, expression) \
  MORTISE_ASSIGN_OR_RETURN_AS(MORTISE_CONCAT(mortise_or_, __COUNTER__), declaration, expression)
#define MORTISE_ASSIGN_OR_RETURN_AS(name, declaration, expression) \
  auto name = (expression);                                        \
  if (!name.ok()) return std::move(name).status();                 \
  declaration = *std::move(name)

}  // namespace mortise
