// Bearer tokens: JSON Web Tokens (RFC 7519) verified with public keys.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"

namespace mortise::gateway {

// Who a verified token speaks for.
struct TokenClaims {
  std::string subject;             // claim `sub`
  std::vector<std::string> roles;  // claim `roles`, as written
  absl::Time expires_at;           // claim `exp`
  absl::Time not_before = absl::InfinitePast();
};

struct TokenOptions {
  std::string issuer;                         // required value of `iss`; any if empty
  std::string audience;                       // required member of `aud`; any if empty
  absl::Duration leeway = absl::Seconds(30);  // allowed difference between clocks
};

// The public keys that tokens may be signed with. Immutable and thread safe.
//
// Algorithms: RS256 (RSA of at least 2048 bits), ES256 (P-256), EdDSA (Ed25519). The key's type
// decides which of them it may verify; "none" and the HMAC family are never accepted.
class TokenKeys {
 public:
  // Reads a JSON Web Key Set ({"keys":[…]}, RFC 7517), or PEM text with one or more PUBLIC KEY
  // blocks. A key of a set is chosen by the token's `kid`; PEM keys have none and are tried in
  // order. INVALID_ARGUMENT, naming the key at fault. Keys of other types and uses are skipped; a
  // set without any usable key is an error.
  static absl::StatusOr<TokenKeys> Parse(std::string_view text);

  // Returns the claims of a token with a valid signature whose time, issuer and audience fit.
  // UNAUTHENTICATED, saying why, otherwise.
  absl::StatusOr<TokenClaims> Verify(std::string_view token, const TokenOptions& options,
                                     absl::Time now) const;

  // Whether a key may be one that the token was signed with, by its `alg` and `kid`. True, too, for
  // what is no token, of which Verify says more.
  bool MayVerify(std::string_view token) const;

  // Returns the keys of both.
  static TokenKeys Join(const TokenKeys& first, const TokenKeys& second);

  std::size_t size() const { return keys_.size(); }

  struct Key;  // a public key with its algorithm and id

 private:
  std::vector<std::shared_ptr<const Key>> keys_;
};

// Returns the token of an `authorization` header: "Bearer <token>", the scheme in any case; nothing
// if the header is of another form.
std::optional<std::string_view> BearerToken(std::string_view authorization);

}  // namespace mortise::gateway
