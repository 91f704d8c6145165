#include <algorithm>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/rpc/identity.h"
#include "common/rpc/identity_keys.h"
#include "mortise/v1/access.pb.h"

namespace mortise::rpc {
namespace {

class KeySigner : public IdentitySigner {
 public:
  KeySigner(std::string issuer, std::shared_ptr<const IdentityKey> key, Clock clock)
      : issuer_(std::move(issuer)), key_(std::move(key)), clock_(std::move(clock)) {}

  std::string Sign(std::string_view subject, Role role, std::string_view trace_id,
                   absl::Duration lifetime) const override {
    const int64_t now = absl::ToUnixSeconds(clock_());
    v1::Identity identity;
    identity.set_subject(std::string(subject));
    if (role != Role::kNone) identity.add_roles(static_cast<v1::Role>(role));
    identity.set_trace_id(std::string(trace_id));
    identity.set_issuer(issuer_);
    identity.set_issued_at(now);
    identity.set_expires_at(now + absl::ToInt64Seconds(std::min(lifetime, kIdentityLifetime)));
    v1::SignedIdentity result;
    result.set_identity(identity.SerializeAsString());
    result.set_signature(key_->Sign(result.identity()));
    return result.SerializeAsString();
  }

  std::string SignService(Role role, std::string_view trace_id) const override {
    return Sign("services/" + issuer_, role, trace_id, kIdentityLifetime);
  }

  const std::string& issuer() const override { return issuer_; }

 private:
  const std::string issuer_;
  const std::shared_ptr<const IdentityKey> key_;
  const Clock clock_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<IdentitySigner>> IdentitySigner::Load(
    const std::filesystem::path& folder, std::string_view issuer, Clock clock) {
  const std::string name(issuer);
  MORTISE_ASSIGN_OR_RETURN(auto key, IdentityKey::ReadPrivate(folder / (name + ".key")));
  return std::make_unique<KeySigner>(name, std::move(key), std::move(clock));
}

}  // namespace mortise::rpc
