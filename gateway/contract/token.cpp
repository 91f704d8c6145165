#include "gateway/contract/token.h"

#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/core_names.h>
#include <openssl/ec.h>
#include <openssl/ecdsa.h>
#include <openssl/evp.h>
#include <openssl/param_build.h>
#include <openssl/pem.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/freed_by.h"
#include "common/base/string_views.h"

namespace mortise::gateway {
namespace {

using Json = nlohmann::json;

using EvpKey = std::unique_ptr<EVP_PKEY, FreedBy<EVP_PKEY_free>>;
using EvpKeyContext = std::unique_ptr<EVP_PKEY_CTX, FreedBy<EVP_PKEY_CTX_free>>;
using DigestContext = std::unique_ptr<EVP_MD_CTX, FreedBy<EVP_MD_CTX_free>>;
using ParamBuild = std::unique_ptr<OSSL_PARAM_BLD, FreedBy<OSSL_PARAM_BLD_free>>;
using Params = std::unique_ptr<OSSL_PARAM, FreedBy<OSSL_PARAM_free>>;
using BigNumber = std::unique_ptr<BIGNUM, FreedBy<BN_free>>;
using EcdsaSignature = std::unique_ptr<ECDSA_SIG, FreedBy<ECDSA_SIG_free>>;
using Bio = std::unique_ptr<BIO, FreedBy<BIO_free>>;

constexpr std::size_t kMaximalTokenBytes = 16 * 1024;
constexpr std::size_t kMaxNameLength = 64;    // of a caller's that is told back
constexpr double kLatestTime = 253402300799;  // the end of the year 9999

const unsigned char* Bytes(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

// Unpadded base64url only, as RFC 7515 demands.
std::optional<std::string> FromBase64Url(std::string_view text) {
  std::string decoded;
  const bool plain = std::all_of(text.begin(), text.end(), [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_';
  });
  if (!plain) return std::nullopt;
  if (!absl::WebSafeBase64Unescape(AbslView(text), &decoded)) return std::nullopt;
  return decoded;
}

std::string StringMember(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

BigNumber ToBigNumber(std::string_view bytes) {
  return BigNumber(BN_bin2bn(Bytes(bytes), static_cast<int>(bytes.size()), nullptr));
}

EvpKey KeyFromParameters(const char* type, OSSL_PARAM_BLD* build) {
  const Params params(OSSL_PARAM_BLD_to_param(build));
  const EvpKeyContext context(EVP_PKEY_CTX_new_from_name(nullptr, type, nullptr));
  EVP_PKEY* key = nullptr;
  if (!params || !context || EVP_PKEY_fromdata_init(context.get()) != 1 ||
      EVP_PKEY_fromdata(context.get(), &key, EVP_PKEY_PUBLIC_KEY, params.get()) != 1) {
    return nullptr;
  }
  return EvpKey(key);
}

EvpKey RsaKey(std::string_view modulus, std::string_view exponent) {
  const BigNumber n = ToBigNumber(modulus);
  const BigNumber e = ToBigNumber(exponent);
  const ParamBuild build(OSSL_PARAM_BLD_new());
  OSSL_PARAM_BLD_push_BN(build.get(), OSSL_PKEY_PARAM_RSA_N, n.get());
  OSSL_PARAM_BLD_push_BN(build.get(), OSSL_PKEY_PARAM_RSA_E, e.get());
  return KeyFromParameters("RSA", build.get());
}

EvpKey EllipticKey(std::string_view x, std::string_view y) {
  if (x.size() != 32 || y.size() != 32) return nullptr;
  const std::string point = absl::StrCat("\x04", AbslView(x), AbslView(y));
  const ParamBuild build(OSSL_PARAM_BLD_new());
  OSSL_PARAM_BLD_push_utf8_string(build.get(), OSSL_PKEY_PARAM_GROUP_NAME, "prime256v1", 0);
  OSSL_PARAM_BLD_push_octet_string(build.get(), OSSL_PKEY_PARAM_PUB_KEY, point.data(),
                                   point.size());
  return KeyFromParameters("EC", build.get());
}

EvpKey EdwardsKey(std::string_view x) {
  return EvpKey(EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, nullptr, Bytes(x), x.size()));
}

// The one algorithm a key may verify; empty for keys that are not usable.
std::string AlgorithmOf(const EVP_PKEY* key) {
  switch (EVP_PKEY_get_base_id(key)) {
    case EVP_PKEY_RSA:
      return EVP_PKEY_get_bits(key) >= 2048 ? "RS256" : "";
    case EVP_PKEY_ED25519:
      return "EdDSA";
    case EVP_PKEY_EC: {
      char group[64] = {};
      std::size_t length = 0;
      EVP_PKEY_get_group_name(key, group, sizeof(group), &length);
      return std::string_view(group, length) == "prime256v1" ? "ES256" : "";
    }
    default:
      return "";
  }
}

// JSON Web Signatures carry r and s side by side; OpenSSL wants them in DER.
std::optional<std::string> EcdsaSignatureToDer(std::string_view raw) {
  if (raw.size() != 64) return std::nullopt;
  const EcdsaSignature signature(ECDSA_SIG_new());
  BigNumber r = ToBigNumber(raw.substr(0, 32));
  BigNumber s = ToBigNumber(raw.substr(32));
  if (ECDSA_SIG_set0(signature.get(), r.get(), s.get()) != 1) return std::nullopt;
  (void)r.release();
  (void)s.release();
  unsigned char* der = nullptr;
  const int length = i2d_ECDSA_SIG(signature.get(), &der);
  if (length <= 0) return std::nullopt;
  std::string result(reinterpret_cast<char*>(der), static_cast<std::size_t>(length));
  OPENSSL_free(der);
  return result;
}

absl::StatusOr<EvpKey> KeyFromJwk(const Json& jwk, const std::string& where) {
  const std::string type = StringMember(jwk, "kty");
  const std::string curve = StringMember(jwk, "crv");
  auto number = [&jwk](const char* name) {
    return FromBase64Url(StringMember(jwk, name)).value_or("");
  };
  EvpKey key;
  if (type == "RSA") {
    key = RsaKey(number("n"), number("e"));
  } else if (type == "EC" && curve == "P-256") {
    key = EllipticKey(number("x"), number("y"));
  } else if (type == "OKP" && curve == "Ed25519") {
    key = EdwardsKey(number("x"));
  } else {
    return EvpKey();
  }
  if (!key || AlgorithmOf(key.get()).empty()) {
    return InvalidField(where, "is not a usable RSA (2048 bits or more), P-256 or Ed25519 key");
  }
  return key;
}

// A JSON object that has no member twice, at any depth: of two claims with one name, readers take
// the one or the other. `part` is what it is called in failures.
absl::StatusOr<Json> ParseObject(std::string_view text, const std::string& part) {
  std::vector<std::set<std::string>> names;
  std::string twice;
  const auto look = [&](int, Json::parse_event_t event, Json& parsed) {
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    if (event == Json::parse_event_t::key &&
        !names.back().insert(parsed.get<std::string>()).second) {
      twice = parsed.get<std::string>();
    }
    return true;
  };
  const Json object = Json::parse(text, look, false);
  if (!object.is_object()) return IdentityInvalid("the token's " + part + " is not a JSON object");
  if (twice.empty()) return object;
  return IdentityInvalid(
      absl::StrCat("the token's ", part, " has '", twice.substr(0, kMaxNameLength), "' twice"));
}

// Seconds since 1970, whole or not (RFC 7519, NumericDate).
absl::StatusOr<absl::Time> TimeClaim(const Json& claims, const std::string& name) {
  const Json& claim = claims.at(name);
  if (!claim.is_number()) {
    return IdentityInvalid(absl::StrCat("the token's ", name,
                                        " is not a number of seconds since "
                                        "1970, as times in tokens are"));
  }
  const double seconds = claim.get<double>();
  if (!(seconds >= 0 && seconds <= kLatestTime)) {
    return IdentityInvalid(
        absl::StrCat("the token's ", name, " is no time: not within 1970 and 9999"));
  }
  return absl::UnixEpoch() + absl::Seconds(seconds);
}

bool HasAudience(const Json& claims, const std::string& audience) {
  const auto found = claims.find("aud");
  if (found == claims.end()) return false;
  if (found->is_string()) return found->get<std::string>() == audience;
  if (!found->is_array()) return false;
  for (const Json& member : *found) {
    if (member.is_string() && member.get<std::string>() == audience) return true;
  }
  return false;
}

absl::StatusOr<std::vector<std::string>> RolesOf(const Json& claims) {
  std::vector<std::string> names;
  const auto roles = claims.find("roles");
  if (roles == claims.end()) return names;
  const bool texts =
      roles->is_array() &&
      std::all_of(roles->begin(), roles->end(), [](const Json& role) { return role.is_string(); });
  if (!texts) return IdentityInvalid("the token's roles are not a list of texts");
  for (const Json& role : *roles) names.push_back(role.get<std::string>());
  return names;
}

absl::StatusOr<TokenClaims> CheckClaims(const Json& claims, const TokenOptions& options,
                                        absl::Time now) {
  TokenClaims result;
  if (claims.contains("sub") && !claims.at("sub").is_string()) {
    return IdentityInvalid("the token's sub is not a text");
  }
  result.subject = StringMember(claims, "sub");
  if (result.subject.empty()) return IdentityInvalid("the token has no subject (sub)");
  if (!claims.contains("exp")) return IdentityInvalid("the token has no expiry (exp)");
  MORTISE_ASSIGN_OR_RETURN(result.expires_at, TimeClaim(claims, "exp"));
  if (now >= result.expires_at + options.leeway) {
    return IdentityInvalid(absl::StrCat("the token expired at ",
                                        absl::FormatTime(result.expires_at, absl::UTCTimeZone())));
  }
  if (claims.contains("nbf")) {
    MORTISE_ASSIGN_OR_RETURN(result.not_before, TimeClaim(claims, "nbf"));
    if (now + options.leeway < result.not_before) {
      return IdentityInvalid("the token is not valid yet (nbf)");
    }
  }
  if (!options.issuer.empty() && StringMember(claims, "iss") != options.issuer) {
    return IdentityInvalid(absl::StrCat("the token is not from the issuer ", options.issuer));
  }
  if (!options.audience.empty() && !HasAudience(claims, options.audience)) {
    return IdentityInvalid(absl::StrCat("the token is not for the audience ", options.audience));
  }
  MORTISE_ASSIGN_OR_RETURN(result.roles, RolesOf(claims));
  return result;
}

}  // namespace

struct TokenKeys::Key {
  std::string id;  // `kid`; empty for keys from PEM
  std::string algorithm;
  EvpKey key;
};

namespace {

bool IsAccepted(std::string_view algorithm) {
  return algorithm == "RS256" || algorithm == "ES256" || algorithm == "EdDSA";
}

// Whether a token's `kid` may mean the key: where either has none, only the signature tells.
bool IsNamed(const TokenKeys::Key& key, std::string_view key_id) {
  return key.id.empty() || key_id.empty() || key.id == key_id;
}

bool SignatureFits(const TokenKeys::Key& key, std::string_view signed_part,
                   std::string_view signature) {
  std::string der;
  if (key.algorithm == "ES256") {
    auto converted = EcdsaSignatureToDer(signature);
    if (!converted) return false;
    der = *std::move(converted);
    signature = der;
  }
  const DigestContext context(EVP_MD_CTX_new());
  const EVP_MD* digest = key.algorithm == "EdDSA" ? nullptr : EVP_sha256();
  return EVP_DigestVerifyInit(context.get(), nullptr, digest, nullptr, key.key.get()) == 1 &&
         EVP_DigestVerify(context.get(), Bytes(signature), signature.size(), Bytes(signed_part),
                          signed_part.size()) == 1;
}

absl::StatusOr<std::vector<std::shared_ptr<const TokenKeys::Key>>> KeysFromJwks(const Json& set) {
  std::vector<std::shared_ptr<const TokenKeys::Key>> keys;
  const auto members = set.find("keys");
  if (members == set.end() || !members->is_array()) {
    return InvalidField("keys", "a JSON Web Key Set needs an array `keys`");
  }
  for (std::size_t i = 0; i < members->size(); ++i) {
    const Json& jwk = (*members)[i];
    const std::string where = absl::StrCat("keys[", i, "]");
    if (!jwk.is_object()) return InvalidField(where, "is not an object");
    if (jwk.contains("d")) return InvalidField(where, "is a private key; only public ones belong");
    if (const std::string use = StringMember(jwk, "use"); !use.empty() && use != "sig") continue;
    MORTISE_ASSIGN_OR_RETURN(EvpKey key, KeyFromJwk(jwk, where));
    if (!key) continue;
    auto entry = std::make_shared<TokenKeys::Key>();
    entry->id = StringMember(jwk, "kid");
    entry->algorithm = AlgorithmOf(key.get());
    if (const std::string named = StringMember(jwk, "alg");
        !named.empty() && named != entry->algorithm) {
      return InvalidField(where + ".alg", absl::StrCat(named, " does not fit the key"));
    }
    entry->key = std::move(key);
    keys.push_back(std::move(entry));
  }
  return keys;
}

absl::StatusOr<std::vector<std::shared_ptr<const TokenKeys::Key>>> KeysFromPem(
    std::string_view text) {
  std::vector<std::shared_ptr<const TokenKeys::Key>> keys;
  const Bio bio(BIO_new_mem_buf(text.data(), static_cast<int>(text.size())));
  while (EVP_PKEY* raw = PEM_read_bio_PUBKEY(bio.get(), nullptr, nullptr, nullptr)) {
    auto entry = std::make_shared<TokenKeys::Key>();
    entry->key.reset(raw);
    entry->algorithm = AlgorithmOf(raw);
    if (entry->algorithm.empty()) {
      return InvalidField(absl::StrCat("key ", keys.size() + 1),
                          "is not an RSA (2048 bits or more), P-256 or Ed25519 key");
    }
    keys.push_back(std::move(entry));
  }
  return keys;
}

}  // namespace

absl::StatusOr<TokenKeys> TokenKeys::Parse(std::string_view text) {
  TokenKeys result;
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '{') {
    const Json set = Json::parse(text, nullptr, false);
    if (!set.is_object()) return InvalidField("keys", "is not valid JSON");
    MORTISE_ASSIGN_OR_RETURN(result.keys_, KeysFromJwks(set));
  } else {
    MORTISE_ASSIGN_OR_RETURN(result.keys_, KeysFromPem(text));
  }
  if (result.keys_.empty()) {
    return InvalidField("keys", "no usable RSA, P-256 or Ed25519 public key found");
  }
  return result;
}

absl::StatusOr<TokenClaims> TokenKeys::Verify(std::string_view token, const TokenOptions& options,
                                              absl::Time now) const {
  if (token.size() > kMaximalTokenBytes) return IdentityInvalid("the token is too long");
  const auto first_dot = token.find('.');
  const auto second_dot = token.find('.', first_dot + 1);
  if (first_dot == std::string_view::npos || second_dot == std::string_view::npos ||
      token.find('.', second_dot + 1) != std::string_view::npos) {
    return IdentityInvalid("the token does not have three parts");
  }
  const auto header_text = FromBase64Url(token.substr(0, first_dot));
  const auto claims_text = FromBase64Url(token.substr(first_dot + 1, second_dot - first_dot - 1));
  const auto signature = FromBase64Url(token.substr(second_dot + 1));
  if (!header_text || !claims_text || !signature) {
    return IdentityInvalid("the token is not base64url");
  }
  MORTISE_ASSIGN_OR_RETURN(const Json header, ParseObject(*header_text, "header"));
  if (header.contains("crit")) return IdentityInvalid("the token demands an unknown extension");
  const std::string algorithm = StringMember(header, "alg");
  if (!IsAccepted(algorithm)) {
    return IdentityInvalid(absl::StrCat(
        algorithm.empty() ? "the token names no algorithm (alg)"
                          : absl::StrCat("the token's algorithm '",
                                         algorithm.substr(0, kMaxNameLength), "' is not accepted"),
        "; RS256, ES256 and EdDSA are"));
  }
  const std::string key_id = StringMember(header, "kid");

  bool verified = false;
  for (const auto& key : keys_) {
    if (key->algorithm != algorithm || !IsNamed(*key, key_id)) continue;
    if (SignatureFits(*key, token.substr(0, second_dot), *signature)) {
      verified = true;
      break;
    }
  }
  if (!verified) {
    return IdentityInvalid("the token's signature does not fit any key of this gateway");
  }
  MORTISE_ASSIGN_OR_RETURN(const Json claims, ParseObject(*claims_text, "claims"));
  return CheckClaims(claims, options, now);
}

bool TokenKeys::MayVerify(std::string_view token) const {
  if (token.size() > kMaximalTokenBytes) return true;
  const auto header_text = FromBase64Url(token.substr(0, token.find('.')));
  if (!header_text) return true;
  const auto header = ParseObject(*header_text, "header");
  if (!header.ok()) return true;
  const std::string algorithm = StringMember(*header, "alg");
  if (!IsAccepted(algorithm)) return true;
  const std::string key_id = StringMember(*header, "kid");
  return std::any_of(keys_.begin(), keys_.end(), [&](const std::shared_ptr<const Key>& key) {
    return key->algorithm == algorithm && IsNamed(*key, key_id);
  });
}

TokenKeys TokenKeys::Join(const TokenKeys& first, const TokenKeys& second) {
  TokenKeys both = first;
  both.keys_.insert(both.keys_.end(), second.keys_.begin(), second.keys_.end());
  return both;
}

std::optional<std::string_view> BearerToken(std::string_view authorization) {
  constexpr std::string_view kScheme = "bearer ";
  if (authorization.size() <= kScheme.size() ||
      !absl::StartsWithIgnoreCase(AbslView(authorization), AbslView(kScheme))) {
    return std::nullopt;
  }
  authorization.remove_prefix(kScheme.size());
  while (!authorization.empty() && authorization.front() == ' ') authorization.remove_prefix(1);
  if (authorization.empty()) return std::nullopt;
  return authorization;
}

}  // namespace mortise::gateway
