// The public keys of tokens from an identity provider's address: a JSON Web Key Set, fetched again
// and again, so that keys can be exchanged while the gateway runs.
#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "gateway/admission/key_source.h"

namespace mortise::gateway {

struct KeyAddressOptions {
  std::string url = {};  // https, or http of this machine
  // Whom to trust there, PEM; whom the system trusts if empty.
  std::filesystem::path authority = {};
  std::optional<TokenKeys> also = {};         // keys of a file, which are good besides
  std::chrono::milliseconds refresh{300000};  // between two fetches
  std::chrono::milliseconds retry{15000};     // after one that failed
  // The least time between two fetches because of tokens whose key is not known.
  std::chrono::milliseconds pause{10000};
  std::chrono::milliseconds timeout{10000};  // of each step of a fetch
};

// Fetches on a thread of its own. As long as a fetch fails, the keys of the last one that did not
// stay good; the log says why. A key that the set has no more is good no more. Redirects are not
// followed.
class KeyAddress : public KeySource {
 public:
  // INVALID_ARGUMENT naming `jwks-url` or `jwks-authority`. Whether the address answers shows
  // later: until it has, there are the keys of the file alone.
  static absl::StatusOr<std::unique_ptr<KeyAddress>> Start(const KeyAddressOptions& options);
};

}  // namespace mortise::gateway
