#include "tests/unit/gateway/contract/token_fixture.h"

#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/core_names.h>
#include <openssl/ecdsa.h>
#include <openssl/pem.h>
#include <openssl/rsa.h>

#include "absl/strings/escaping.h"

namespace mortise::gateway {
namespace {

std::string Number(EVP_PKEY* key, const char* name, int bytes) {
  BIGNUM* number = nullptr;
  EVP_PKEY_get_bn_param(key, name, &number);
  if (bytes == 0) bytes = BN_num_bytes(number);
  std::string text(static_cast<std::size_t>(bytes), '\0');
  BN_bn2binpad(number, reinterpret_cast<unsigned char*>(text.data()), bytes);
  BN_free(number);
  return text;
}

std::string DerToRaw(const std::string& der) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(der.data());
  ECDSA_SIG* signature = d2i_ECDSA_SIG(nullptr, &bytes, static_cast<long>(der.size()));
  std::string raw(64, '\0');
  auto* out = reinterpret_cast<unsigned char*>(raw.data());
  BN_bn2binpad(ECDSA_SIG_get0_r(signature), out, 32);
  BN_bn2binpad(ECDSA_SIG_get0_s(signature), out + 32, 32);
  ECDSA_SIG_free(signature);
  return raw;
}

}  // namespace

std::string Base64Url(const std::string& bytes) {
  std::string text;
  absl::WebSafeBase64Escape(bytes, &text);
  while (!text.empty() && text.back() == '=') text.pop_back();
  return text;
}

TokenSigner::TokenSigner(const std::string& algorithm) : algorithm_(algorithm) {
  EVP_PKEY* key = nullptr;
  if (algorithm == "RS256") {
    key = EVP_RSA_gen(2048);
  } else if (algorithm == "ES256") {
    key = EVP_EC_gen("P-256");
  } else {
    key = EVP_PKEY_Q_keygen(nullptr, nullptr, "ED25519");
  }
  key_.reset(key, EVP_PKEY_free);
}

std::string TokenSigner::Sign(const nlohmann::json& claims, const std::string& key_id) const {
  nlohmann::json header = {{"alg", algorithm_}, {"typ", "JWT"}};
  if (!key_id.empty()) header["kid"] = key_id;
  return SignWithHeader(header, claims);
}

std::string TokenSigner::SignWithHeader(const nlohmann::json& header,
                                        const nlohmann::json& claims) const {
  return SignTexts(header.dump(), claims.dump());
}

std::string TokenSigner::SignTexts(const std::string& header, const std::string& claims) const {
  const std::string message = Base64Url(header) + "." + Base64Url(claims);
  const std::shared_ptr<EVP_MD_CTX> context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  EVP_DigestSignInit(context.get(), nullptr, algorithm_ == "EdDSA" ? nullptr : EVP_sha256(),
                     nullptr, key_.get());
  const auto* bytes = reinterpret_cast<const unsigned char*>(message.data());
  std::size_t size = 0;
  EVP_DigestSign(context.get(), nullptr, &size, bytes, message.size());
  std::string signature(size, '\0');
  EVP_DigestSign(context.get(), reinterpret_cast<unsigned char*>(signature.data()), &size, bytes,
                 message.size());
  signature.resize(size);
  if (algorithm_ == "ES256") signature = DerToRaw(signature);
  return message + "." + Base64Url(signature);
}

std::string TokenSigner::Pem() const {
  const std::shared_ptr<BIO> bio(BIO_new(BIO_s_mem()), BIO_free);
  PEM_write_bio_PUBKEY(bio.get(), key_.get());
  char* data = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &data);
  return std::string(data, static_cast<std::size_t>(size));
}

nlohmann::json TokenSigner::Jwk(const std::string& key_id) const {
  nlohmann::json jwk = {{"kid", key_id}, {"use", "sig"}, {"alg", algorithm_}};
  if (algorithm_ == "RS256") {
    jwk["kty"] = "RSA";
    jwk["n"] = Base64Url(Number(key_.get(), OSSL_PKEY_PARAM_RSA_N, 0));
    jwk["e"] = Base64Url(Number(key_.get(), OSSL_PKEY_PARAM_RSA_E, 0));
  } else if (algorithm_ == "ES256") {
    jwk["kty"] = "EC";
    jwk["crv"] = "P-256";
    jwk["x"] = Base64Url(Number(key_.get(), OSSL_PKEY_PARAM_EC_PUB_X, 32));
    jwk["y"] = Base64Url(Number(key_.get(), OSSL_PKEY_PARAM_EC_PUB_Y, 32));
  } else {
    std::string x(32, '\0');
    std::size_t size = x.size();
    EVP_PKEY_get_raw_public_key(key_.get(), reinterpret_cast<unsigned char*>(x.data()), &size);
    jwk["kty"] = "OKP";
    jwk["crv"] = "Ed25519";
    jwk["x"] = Base64Url(x);
  }
  return jwk;
}

}  // namespace mortise::gateway
