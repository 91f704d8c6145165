// Who may come in: from a bearer token to the identity that services trust.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/rpc/identity.h"
#include "gateway/admission/key_source.h"
#include "gateway/contract/contract.h"
#include "gateway/contract/token.h"

namespace mortise::gateway {

// Somebody whose token was verified.
struct Caller {
  std::string subject;  // "users/ada", "services/plm"
  rpc::Role role = rpc::Role::kNone;
  // When the token is good no more, the allowed difference between clocks included.
  absl::Time expires_at = absl::InfiniteFuture();
};

struct AdmissionOptions {
  KeySource* keys = nullptr;  // must outlive; null: only in development
  TokenOptions token;
  const rpc::IdentitySigner* signer = nullptr;  // must outlive; null: only in development
  // Calls without a token come from "users/developer", an admin. The doors are on loopback then.
  bool insecure_development = false;
  std::function<absl::Time()> clock = absl::Now;
};

// Thread safe. Remembers verified tokens until they expire, so that a client's further calls cost
// no signature check.
class Admission {
 public:
  explicit Admission(AdmissionOptions options);

  // Returns the caller that an `authorization` header speaks for. UNAUTHENTICATED, IDENTITY_INVALID
  // without a valid token; UNAVAILABLE, KEYS_BEING_FETCHED while nobody knows whether it is: its
  // key is not known, and the keys are being fetched. The subject is `sub`, put under "users/"
  // unless it names its collection
  // ("services/plm") itself; the role is the highest in `roles`.
  absl::StatusOr<std::shared_ptr<const Caller>> Authenticate(std::string_view authorization);

  // PERMISSION_DENIED, ROLE_REQUIRED if the method asks for more than the caller has.
  absl::Status Authorize(const MethodRoute& method, const Caller& caller) const;

  // Returns the caller's signed identity, good for every request within the next minutes; empty in
  // development. Signed again every minute, not for every call: a signature costs as much as the
  // rest of the way through the gateway.
  std::string SignedIdentity(const Caller& caller);

 private:
  // A caller, and the keys that the token was verified with: it is verified again once they change.
  struct Verified {
    std::shared_ptr<const Caller> caller;
    std::shared_ptr<const TokenKeys> keys;
  };
  struct Signed {
    std::string identity;
    absl::Time at;
  };

  AdmissionOptions options_;
  std::shared_ptr<const Caller> developer_;
  std::mutex mutex_;
  // By token; guarded by mutex_.
  std::unordered_map<std::string, Verified> verified_;
  std::map<std::pair<std::string, rpc::Role>, Signed> signed_;  // guarded by mutex_
};

// UNAUTHENTICATED, IDENTITY_INVALID: of two tokens, who looks at the first would know another
// caller than who looks at the last.
absl::Status SeveralTokens();

// The reason of a refusal of which nobody can say yet whether it is one.
inline constexpr char kKeysBeingFetched[] = "KEYS_BEING_FETCHED";

// Whether a client's `x-request-id` is used: 1 to 128 letters, digits, '.', '_' or '-'.
bool IsRequestId(std::string_view text);

}  // namespace mortise::gateway
