// Makes signed tokens and their public keys for tests.
#pragma once

#include <openssl/evp.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

namespace mortise::gateway {

// A fresh key pair of one of the algorithms "RS256", "ES256", "EdDSA".
class TokenSigner {
 public:
  explicit TokenSigner(const std::string& algorithm);

  // header.claims.signature
  std::string Sign(const nlohmann::json& claims, const std::string& key_id = "") const;

  // The public key as PEM, and as a member of a JSON Web Key Set.
  std::string Pem() const;
  nlohmann::json Jwk(const std::string& key_id) const;

  // A token with this header and these claims whose signature this key made, whatever `alg` says.
  std::string SignWithHeader(const nlohmann::json& header, const nlohmann::json& claims) const;

  // The same of any texts, which need not be JSON.
  std::string SignTexts(const std::string& header, const std::string& claims) const;

 private:
  std::string algorithm_;
  std::shared_ptr<EVP_PKEY> key_;
};

std::string Base64Url(const std::string& bytes);

}  // namespace mortise::gateway
