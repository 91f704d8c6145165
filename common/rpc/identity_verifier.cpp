#include <algorithm>
#include <map>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/rpc/identity.h"
#include "common/rpc/identity_keys.h"
#include "mortise/v1/access.pb.h"

namespace mortise::rpc {
namespace {

using Keys = std::map<std::string, std::shared_ptr<const IdentityKey>>;

// Unknown issuers may be forged; they do not get to read the disk more often than this.
constexpr absl::Duration kReloadInterval = absl::Seconds(1);

constexpr std::size_t kMaximalRemembered = 4096;

absl::StatusOr<Keys> ReadKeys(const std::filesystem::path& folder) {
  Keys keys;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".pub") continue;
    MORTISE_ASSIGN_OR_RETURN(auto key, IdentityKey::ReadPublic(entry.path()));
    keys[entry.path().stem().string()] = std::move(key);
  }
  if (error) return StorageFailed(folder.string(), error.message());
  if (keys.empty()) {
    return PreconditionFailed(
        "NO_TRUSTED_ISSUER",
        absl::StrCat(folder.string(), " holds no *.pub file: no issuer could be trusted"),
        folder.string());
  }
  return keys;
}

Role HighestRole(const v1::Identity& identity) {
  int highest = 0;
  for (const int role : identity.roles()) {
    if (v1::Role_IsValid(role)) highest = std::max(highest, role);
  }
  return static_cast<Role>(highest);
}

class KeyVerifier : public IdentityVerifier {
 public:
  KeyVerifier(VerifierOptions options, Keys keys)
      : options_(std::move(options)), keys_(std::move(keys)), loaded_at_(options_.clock()) {}

  absl::StatusOr<Identity> Verify(std::string_view signed_identity) override {
    std::string bytes(signed_identity);
    if (const std::optional<Identity> known = Find(bytes)) {
      MORTISE_RETURN_IF_ERROR(CheckTimes(*known));
      return *known;
    }
    MORTISE_ASSIGN_OR_RETURN(Identity identity, VerifySignature(signed_identity));
    std::lock_guard lock(mutex_);
    if (verified_.size() >= kMaximalRemembered) verified_.clear();
    verified_[std::move(bytes)] = identity;
    return identity;
  }

 private:
  std::optional<Identity> Find(const std::string& bytes) {
    std::lock_guard lock(mutex_);
    const auto found = verified_.find(bytes);
    return found == verified_.end() ? std::nullopt : std::optional(found->second);
  }

  absl::StatusOr<Identity> VerifySignature(std::string_view signed_identity) {
    v1::SignedIdentity envelope;
    v1::Identity claim;
    if (!envelope.ParseFromArray(signed_identity.data(),
                                 static_cast<int>(signed_identity.size())) ||
        !claim.ParseFromString(envelope.identity())) {
      return IdentityInvalid("the identity is malformed");
    }
    const std::shared_ptr<const IdentityKey> key = FindKey(claim.issuer());
    if (!key) return IdentityInvalid("the identity's issuer is not trusted");
    if (!key->Verify(envelope.identity(), envelope.signature())) {
      return IdentityInvalid("the identity's signature is wrong");
    }
    Identity identity{.subject = claim.subject(),
                      .role = HighestRole(claim),
                      .trace_id = claim.trace_id(),
                      .issuer = claim.issuer(),
                      .issued_at = absl::FromUnixSeconds(claim.issued_at()),
                      .expires_at = absl::FromUnixSeconds(claim.expires_at())};
    MORTISE_RETURN_IF_ERROR(CheckTimes(identity));
    if (identity.subject.empty()) return IdentityInvalid("the identity names no subject");
    if (identity.issuer != kGatewayIssuer && identity.subject != "services/" + identity.issuer) {
      return IdentityInvalid("the identity's issuer may not vouch for its subject");
    }
    return identity;
  }

  absl::Status CheckTimes(const Identity& identity) const {
    const absl::Time now = options_.clock();
    if (now > identity.expires_at + options_.clock_skew) {
      return IdentityInvalid("the identity has expired");
    }
    if (identity.issued_at > now + options_.clock_skew) {
      return IdentityInvalid("the identity is from the future; compare the clocks of the hosts");
    }
    if (identity.expires_at - identity.issued_at > kIdentityLifetime) {
      return IdentityInvalid("the identity lives longer than 300 s");
    }
    return absl::OkStatus();
  }

  std::shared_ptr<const IdentityKey> FindKey(const std::string& issuer) {
    std::lock_guard lock(mutex_);
    auto found = keys_.find(issuer);
    if (found == keys_.end() && options_.clock() >= loaded_at_ + kReloadInterval) {
      Reload();
      found = keys_.find(issuer);
    }
    return found == keys_.end() ? nullptr : found->second;
  }

  void Reload() {
    loaded_at_ = options_.clock();
    absl::StatusOr<Keys> keys = ReadKeys(options_.folder);
    if (keys.ok()) {
      keys_ = *std::move(keys);
      verified_.clear();  // some may be of issuers that are not trusted any more
    } else {
      Log(LogLevel::kWarning, "identity keys cannot be read again",
          {{"error", keys.status().message()}});
    }
  }

  const VerifierOptions options_;
  std::mutex mutex_;
  Keys keys_;  // guarded by mutex_
  // By the bytes that were verified: an identity travels with many calls, and a signature takes
  // longer to verify than a small call to answer.
  std::unordered_map<std::string, Identity> verified_;  // guarded by mutex_
  absl::Time loaded_at_;                                // guarded by mutex_
};

}  // namespace

absl::StatusOr<std::unique_ptr<IdentityVerifier>> IdentityVerifier::Load(
    const VerifierOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(Keys keys, ReadKeys(options.folder));
  return std::make_unique<KeyVerifier>(options, std::move(keys));
}

}  // namespace mortise::rpc
