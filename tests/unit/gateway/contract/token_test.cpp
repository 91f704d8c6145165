// Bearer tokens: accepted only with a fitting signature, in time, from the right issuer.
#include "gateway/contract/token.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/evp.h>
#include <openssl/hmac.h>

#include "tests/unit/gateway/contract/token_fixture.h"

namespace mortise::gateway {
namespace {

using Json = nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

const absl::Time kNow = absl::FromUnixSeconds(1800000000);

Json Claims() {
  return {{"sub", "ada"},
          {"roles", {"designer", "operator"}},
          {"exp", absl::ToUnixSeconds(kNow) + 600},
          {"iss", "https://id.example"},
          {"aud", {"mortise", "other"}}};
}

class TokenAlgorithmTest : public testing::TestWithParam<const char*> {};

TEST_P(TokenAlgorithmTest, AcceptsASignedToken) {
  const TokenSigner signer(GetParam());
  const auto set = TokenKeys::Parse(Json{{"keys", {signer.Jwk("one")}}}.dump());
  ASSERT_TRUE(set.ok()) << set.status();
  const auto pem = TokenKeys::Parse(signer.Pem());
  ASSERT_TRUE(pem.ok()) << pem.status();
  for (const TokenKeys* keys : {&*set, &*pem}) {
    const auto claims =
        keys->Verify(signer.Sign(Claims(), "one"), {"https://id.example", "mortise"}, kNow);
    ASSERT_TRUE(claims.ok()) << claims.status();
    EXPECT_EQ(claims->subject, "ada");
    EXPECT_THAT(claims->roles, ElementsAre("designer", "operator"));
  }
}

TEST_P(TokenAlgorithmTest, RefusesAnotherKeysSignatureAndChangedTokens) {
  const TokenSigner signer(GetParam());
  const TokenSigner stranger(GetParam());
  const auto keys = TokenKeys::Parse(signer.Pem());
  EXPECT_EQ(keys->Verify(stranger.Sign(Claims()), {}, kNow).status().code(),
            absl::StatusCode::kUnauthenticated);
  const std::string token = signer.Sign(Claims());
  Json richer = Claims();
  richer["roles"] = {"admin"};
  const auto first = token.find('.');
  const auto second = token.rfind('.');
  const std::string changed =
      token.substr(0, first + 1) + Base64Url(richer.dump()) + token.substr(second);
  EXPECT_FALSE(keys->Verify(changed, {}, kNow).ok());
  EXPECT_FALSE(keys->Verify(token.substr(0, token.size() - 4), {}, kNow).ok());
  EXPECT_FALSE(keys->Verify(token.substr(0, second + 1), {}, kNow).ok());
}

TEST_P(TokenAlgorithmTest, RefusesOtherAlgorithmsThanTheKeys) {
  const TokenSigner signer(GetParam());
  const auto keys = TokenKeys::Parse(signer.Pem());
  for (const char* algorithm : {"none", "None", "HS256", "RS512", "ES384", ""}) {
    EXPECT_FALSE(keys->Verify(signer.SignWithHeader({{"alg", algorithm}}, Claims()), {}, kNow).ok())
        << algorithm;
  }
  EXPECT_FALSE(keys->Verify(Base64Url(R"({"alg":"none"})") + "." + Base64Url(Claims().dump()) + ".",
                            {}, kNow)
                   .ok());
  EXPECT_FALSE(
      keys->Verify(signer.SignWithHeader({{"alg", GetParam()}, {"crit", {"b64"}}}, Claims()), {},
                   kNow)
          .ok());
}

INSTANTIATE_TEST_SUITE_P(Algorithms, TokenAlgorithmTest,
                         testing::Values("RS256", "ES256", "EdDSA"));

TEST(Token, RefusesAnHmacMadeWithThePublicKey) {
  const TokenSigner signer("RS256");
  const auto keys = TokenKeys::Parse(signer.Pem());
  const std::string message = Base64Url(R"({"alg":"HS256"})") + "." + Base64Url(Claims().dump());
  const std::string secret = signer.Pem();
  unsigned char mac[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
       reinterpret_cast<const unsigned char*>(message.data()), message.size(), mac, &size);
  const std::string token =
      message + "." + Base64Url(std::string(reinterpret_cast<char*>(mac), size));
  EXPECT_EQ(keys->Verify(token, {}, kNow).status().code(), absl::StatusCode::kUnauthenticated);
}

TEST(Token, ChecksTimes) {
  const TokenSigner signer("EdDSA");
  const auto keys = TokenKeys::Parse(signer.Pem());
  const std::string token = signer.Sign(Claims());
  EXPECT_TRUE(keys->Verify(token, {}, kNow + absl::Seconds(600)).ok()) << "within the leeway";
  const absl::Status late = keys->Verify(token, {}, kNow + absl::Seconds(631)).status();
  EXPECT_THAT(std::string(late.message()), HasSubstr("expired"));
  Json claims = Claims();
  claims["nbf"] = absl::ToUnixSeconds(kNow) + 100;
  EXPECT_FALSE(keys->Verify(signer.Sign(claims), {}, kNow).ok());
  EXPECT_TRUE(keys->Verify(signer.Sign(claims), {}, kNow + absl::Seconds(100)).ok());
  claims = Claims();
  claims.erase("exp");
  EXPECT_FALSE(keys->Verify(signer.Sign(claims), {}, kNow).ok()) << "tokens must expire";
  claims["exp"] = "tomorrow";
  EXPECT_FALSE(keys->Verify(signer.Sign(claims), {}, kNow).ok());
}

TEST(Token, ChecksIssuerAudienceAndSubject) {
  const TokenSigner signer("EdDSA");
  const auto keys = TokenKeys::Parse(signer.Pem());
  const std::string token = signer.Sign(Claims());
  EXPECT_FALSE(keys->Verify(token, {"https://else.example", ""}, kNow).ok());
  EXPECT_FALSE(keys->Verify(token, {"", "another"}, kNow).ok());
  Json claims = Claims();
  claims.erase("sub");
  EXPECT_FALSE(keys->Verify(signer.Sign(claims), {}, kNow).ok());
}

TEST(Token, RefusesWhatIsNoToken) {
  const auto keys = TokenKeys::Parse(TokenSigner("EdDSA").Pem());
  for (const std::string& bad :
       {std::string(), std::string("."), std::string(".."), std::string("a.b"),
        std::string("a.b.c.d"), std::string("e30.e30."), std::string("!!.!!.!!"),
        std::string("e30=.e30=.AAAA"), std::string(20000, 'a') + ".b.c"}) {
    EXPECT_EQ(keys->Verify(bad, {}, kNow).status().code(), absl::StatusCode::kUnauthenticated);
  }
}

// A token signed by a key of ours that is refused all the same, and the words that say why.
struct RefusedToken {
  const char* name;
  std::string header;
  std::string claims;
  std::string words;
};

// Claims with `member` put before those that make a good token.
std::string With(const std::string& member) {
  return R"({)" + member + R"(,"sub":"ada","roles":["admin"]})";
}

std::vector<RefusedToken> RefusedTokens() {
  const std::string header = R"({"alg":"EdDSA"})";
  const std::string good = With(R"("exp":1800000600)");
  return {
      {"no algorithm", "{}", good, "names no algorithm"},
      {"algorithm none", R"({"alg":"none"})", good, "'none' is not accepted"},
      {"algorithm of a secret", R"({"alg":"HS256"})", good, "'HS256' is not accepted"},
      {"algorithm in another case", R"({"alg":"eddsa"})", good, "'eddsa' is not accepted"},
      {"algorithms", R"({"alg":["EdDSA"]})", good, "names no algorithm"},
      {"algorithm of another key", R"({"alg":"RS256"})", good, "does not fit any key"},
      {"two algorithms", R"({"alg":"none","alg":"EdDSA"})", good, "header has 'alg' twice"},
      {"extension", R"({"alg":"EdDSA","crit":["x"]})", good, "unknown extension"},
      {"header is a list", "[]", good, "header is not a JSON object"},
      {"header is empty", "", good, "header is not a JSON object"},
      {"claims are a list", header, "[]", "claims is not a JSON object"},
      {"claims are cut short", header, good.substr(0, 30), "claims is not a JSON object"},
      {"claims with a comment", header, "/**/" + good, "claims is not a JSON object"},
      {"two expiries", header, With(R"("exp":1,"exp":1800000600)"), "claims has 'exp' twice"},
      {"two subjects", header, With(R"("sub":"eve","exp":1800000600)"), "claims has 'sub' twice"},
      {"two roles", header, With(R"("roles":[],"exp":1800000600)"), "claims has 'roles' twice"},
      {"two within", header, With(R"("x":{"a":1,"a":2},"exp":1800000600)"), "has 'a' twice"},
      {"two by escapes", header, With(R"("e\u0078p":1,"exp":1800000600)"), "has 'exp' twice"},
      {"no expiry", header, With(R"("iat":1)"), "no expiry"},
      {"expiry as text", header, With(R"("exp":"1800000600")"), "exp is not a number"},
      {"expiry as list", header, With(R"("exp":[1800000600])"), "exp is not a number"},
      {"expiry null", header, With(R"("exp":null)"), "exp is not a number"},
      {"expiry true", header, With(R"("exp":true)"), "exp is not a number"},
      {"expiry NaN", header, With(R"("exp":NaN)"), "claims is not a JSON object"},
      {"expiry infinite", header, With(R"("exp":1e999)"), "token's"},
      {"expiry huge", header, With(R"("exp":1e300)"), "exp is no time"},
      {"expiry beyond integers", header, With(R"("exp":99999999999999999999)"), "exp is no time"},
      {"expiry in milliseconds", header, With(R"("exp":1800000600000)"), "exp is no time"},
      {"expiry negative", header, With(R"("exp":-1)"), "exp is no time"},
      {"expiry past", header, With(R"("exp":1700000000)"), "expired at"},
      {"expiry past with a fraction", header, With(R"("exp":1799999969.5)"), "expired at"},
      {"begin as text", header, With(R"("exp":1800000600,"nbf":"now")"), "nbf is not a number"},
      {"begin to come", header, With(R"("exp":1800000600,"nbf":1800000100)"), "not valid yet"},
      {"no subject", header, R"({"exp":1800000600})", "no subject"},
      {"subject empty", header, R"({"exp":1800000600,"sub":""})", "no subject"},
      {"subject a number", header, R"({"exp":1800000600,"sub":7})", "sub is not a text"},
      {"roles as text", header, R"({"exp":1800000600,"sub":"a","roles":"admin"})", "roles are not"},
      {"roles as object", header, R"({"exp":1800000600,"sub":"a","roles":{}})", "roles are not"},
      {"role a number", header, R"({"exp":1800000600,"sub":"a","roles":[4]})", "roles are not"},
  };
}

TEST(Token, SaysWhatIsWrongWithATokenThatIsSigned) {
  const TokenSigner signer("EdDSA");
  const auto keys = TokenKeys::Parse(signer.Pem());
  for (const RefusedToken& refused : RefusedTokens()) {
    const absl::Status status =
        keys->Verify(signer.SignTexts(refused.header, refused.claims), {}, kNow).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnauthenticated) << refused.name;
    EXPECT_THAT(std::string(status.message()), HasSubstr(refused.words)) << refused.name;
  }
}

TEST(Token, TakesTimesWithFractionsAndUnknownClaims) {
  const TokenSigner signer("EdDSA");
  const auto keys = TokenKeys::Parse(signer.Pem());
  for (const char* member :
       {R"("exp":1800000600)", R"("exp":1800000600.75)", R"("exp":1.8000006e9)",
        R"("exp":253402300799)", R"("exp":1800000600,"nbf":0)",
        R"("exp":1800000600,"x":[{"a":1},{"a":1}])", R"("exp":1800000600,"x":{"exp":"never"})"}) {
    const auto claims =
        keys->Verify(signer.SignTexts(R"({"alg":"EdDSA"})", With(member)), {}, kNow);
    EXPECT_TRUE(claims.ok()) << member << ": " << claims.status();
  }
}

TEST(Token, RefusesSignaturesThatAreWrittenOtherwise) {
  const TokenSigner signer("EdDSA");
  const auto keys = TokenKeys::Parse(signer.Pem());
  const std::string token = signer.Sign(Claims());
  ASSERT_TRUE(keys->Verify(token, {}, kNow).ok());
  for (const std::string& changed :
       {token + "=", token + " ", token + "\n", token + ".", " " + token,
        token.substr(0, token.size() - 1) + " " + token.back()}) {
    EXPECT_FALSE(keys->Verify(changed, {}, kNow).ok()) << changed;
  }
}

TEST(Token, ChoosesTheKeyByItsId) {
  const TokenSigner first("EdDSA");
  const TokenSigner second("EdDSA");
  const auto keys =
      TokenKeys::Parse(Json{{"keys", {first.Jwk("first"), second.Jwk("second")}}}.dump());
  ASSERT_TRUE(keys.ok()) << keys.status();
  EXPECT_TRUE(keys->Verify(second.Sign(Claims(), "second"), {}, kNow).ok());
  EXPECT_FALSE(keys->Verify(second.Sign(Claims(), "first"), {}, kNow).ok());
}

TEST(Token, NamesUnusableKeys) {
  EXPECT_FALSE(TokenKeys::Parse("").ok());
  EXPECT_FALSE(TokenKeys::Parse("{}").ok());
  EXPECT_FALSE(TokenKeys::Parse("{\"keys\":[]}").ok());
  EXPECT_FALSE(TokenKeys::Parse("{\"keys\":[3]}").ok());
  EXPECT_FALSE(TokenKeys::Parse("-----BEGIN PUBLIC KEY-----\nAAAA\n-----END PUBLIC KEY-----").ok());
  Json jwk = TokenSigner("EdDSA").Jwk("x");
  jwk["d"] = "c2VjcmV0";
  EXPECT_THAT(std::string(TokenKeys::Parse(Json{{"keys", {jwk}}}.dump()).status().message()),
              HasSubstr("private"));
  EXPECT_FALSE(TokenKeys::Parse(R"({"keys":[{"kty":"RSA","n":"AQAB","e":"AQAB"}]})").ok());
  EXPECT_FALSE(TokenKeys::Parse(R"({"keys":[{"kty":"oct","k":"c2VjcmV0"}]})").ok());
}

TEST(Token, FindsTheTokenOfAHeader) {
  EXPECT_EQ(BearerToken("Bearer abc"), "abc");
  EXPECT_EQ(BearerToken("bearer  abc"), "abc");
  EXPECT_FALSE(BearerToken("Basic abc").has_value());
  EXPECT_FALSE(BearerToken("Bearer ").has_value());
  EXPECT_FALSE(BearerToken("").has_value());
}

}  // namespace
}  // namespace mortise::gateway
