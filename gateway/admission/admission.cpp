#include "gateway/admission/admission.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::gateway {
namespace {

constexpr std::size_t kMaximalRememberedTokens = 4096;
constexpr std::size_t kMaximalRememberedIdentities = 4096;

// Leaves four of the five minutes that an identity lives to the calls that carry it on.
constexpr absl::Duration kSignedAgainAfter = absl::Minutes(1);

std::string SubjectName(const std::string& subject) {
  return subject.find('/') == std::string::npos ? "users/" + subject : subject;
}

bool IsSubjectName(std::string_view name) {
  return name.size() <= 256 && std::all_of(name.begin(), name.end(), [](char c) {
           return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '/' || c == '.' ||
                  c == '_' || c == '-' || c == '@' || c == '|' || c == ':' || c == '+';
         });
}

rpc::Role HighestRole(const std::vector<std::string>& names) {
  rpc::Role highest = rpc::Role::kNone;
  for (const std::string& name : names) {
    const auto role = rpc::ParseRole(name, "roles");
    // Tokens may carry roles of other systems; they mean nothing here.
    if (role.ok()) highest = std::max(highest, *role);
  }
  return highest;
}

}  // namespace

Admission::Admission(AdmissionOptions options) : options_(std::move(options)) {
  if (options_.insecure_development) {
    developer_ = std::make_shared<const Caller>(Caller{"users/developer", rpc::Role::kAdmin});
  }
}

absl::StatusOr<std::shared_ptr<const Caller>> Admission::Authenticate(
    std::string_view authorization) {
  if (authorization.empty()) {
    if (developer_) return developer_;
    return IdentityInvalid("a bearer token is needed: authorization: Bearer <token>");
  }
  const auto token = BearerToken(authorization);
  if (!token) return IdentityInvalid("the authorization header is not of the form Bearer <token>");
  if (options_.keys == nullptr) {
    if (developer_) return developer_;
    return IdentityInvalid("this gateway has no keys to verify tokens with");
  }
  const absl::Time now = options_.clock();
  std::string key(*token);
  const std::shared_ptr<const TokenKeys> keys = options_.keys->keys();
  {
    std::lock_guard lock(mutex_);
    const auto found = verified_.find(key);
    if (found != verified_.end()) {
      const Verified& verified = found->second;
      if (now < verified.caller->expires_at && verified.keys == keys) return verified.caller;
      verified_.erase(found);
    }
  }
  const bool known = keys != nullptr && keys->MayVerify(*token);
  // Those that were never fetched are being fetched, or will be in moments.
  if (!known && (options_.keys->FetchAnew() || keys == nullptr)) {
    return WithDetail(absl::UnavailableError("the token's key is not known, and the keys of tokens "
                                             "are being fetched: try again in a moment"),
                      {kKeysBeingFetched, "authorization"});
  }
  MORTISE_ASSIGN_OR_RETURN(const TokenClaims claims, keys->Verify(*token, options_.token, now));
  auto caller = std::make_shared<Caller>();
  caller->subject = SubjectName(claims.subject);
  caller->role = HighestRole(claims.roles);
  caller->expires_at = claims.expires_at + options_.token.leeway;
  if (!IsSubjectName(caller->subject)) {
    return IdentityInvalid("the token's subject has characters that names may not have");
  }
  std::lock_guard lock(mutex_);
  if (verified_.size() >= kMaximalRememberedTokens) verified_.clear();
  verified_[std::move(key)] = {caller, keys};
  return caller;
}

absl::Status Admission::Authorize(const MethodRoute& method, const Caller& caller) const {
  const auto needed = static_cast<rpc::Role>(method.role);
  if (needed == rpc::Role::kNone || caller.role < needed) {
    return RoleRequired(method.full_name,
                        needed == rpc::Role::kNone ? "nobody's" : rpc::RoleName(needed));
  }
  return absl::OkStatus();
}

std::string Admission::SignedIdentity(const Caller& caller) {
  if (options_.signer == nullptr) return {};
  const absl::Time now = options_.clock();
  std::pair<std::string, rpc::Role> key(caller.subject, caller.role);
  {
    std::lock_guard lock(mutex_);
    const auto found = signed_.find(key);
    // A clock that was set back would make an identity of the future.
    if (found != signed_.end() && found->second.at <= now &&
        now < found->second.at + kSignedAgainAfter) {
      return found->second.identity;
    }
  }
  std::string identity = options_.signer->Sign(caller.subject, caller.role, "");
  std::lock_guard lock(mutex_);
  if (signed_.size() >= kMaximalRememberedIdentities) signed_.clear();
  signed_[std::move(key)] = {identity, now};
  return identity;
}

absl::Status SeveralTokens() {
  return IdentityInvalid("there is more than one authorization header");
}

bool IsRequestId(std::string_view text) {
  return !text.empty() && text.size() <= 128 && std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '_' || c == '-';
  });
}

}  // namespace mortise::gateway
