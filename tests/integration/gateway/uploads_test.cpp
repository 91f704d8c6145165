// Files by PUT and POST, of any size.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "absl/strings/escaping.h"
#include "common/base/digest.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

const std::string kUpload = "/mortise.v1.SimulatorService/UploadBlob";

class UploadsTest : public GatewayTest {
 protected:
  HttpAnswer Send(const std::string& method, const std::string& bytes,
                  std::map<std::string, std::string> headers = {}) {
    if (!token_.empty()) headers.emplace("Authorization", "Bearer " + token_);
    return Http(gateway_->addresses().http, method, kUpload, headers, bytes);
  }

  // The head of an upload of so many bytes, and the first of them.
  std::unique_ptr<HttpStream> Begin(std::size_t bytes, const std::string& more = "",
                                    const std::string& first = "") {
    return HttpStream::Send(gateway_->addresses().http,
                            "PUT " + kUpload + " HTTP/1.1\r\nHost: localhost\r\nContent-Length: " +
                                std::to_string(bytes) + "\r\n" + more + "\r\n" + first);
  }

  const TokenSigner signer_{"EdDSA"};
  std::string token_;
};

TEST_F(UploadsTest, MayBeLargerThanAMessage) {
  StartGateway(Options());
  const std::string bytes(20 << 20, 'x');
  for (const char* method : {"PUT", "POST"}) {
    const HttpAnswer answer = Send(method, bytes, {{"Content-Type", "model/stl"}});
    EXPECT_EQ(answer.status, 200) << answer.body;
    EXPECT_EQ(Json::parse(answer.body)["sha256"], std::to_string(bytes.size()) + "model/stl");
  }
}

TEST_F(UploadsTest, StateTheirDigestAndSize) {
  StartGateway(Options());
  const std::string bytes = "solid nothing";
  const std::string digest = Sha256Hex(bytes);
  const std::string header = "sha-256=:" + absl::Base64Escape(absl::HexStringToBytes(digest)) + ":";
  const HttpAnswer answer =
      Send("PUT", bytes, {{"Content-Type", "a/b"}, {"Content-Digest", header}});
  EXPECT_EQ(Json::parse(answer.body)["sha256"], "13a/b" + digest);
  EXPECT_EQ(Json::parse(Send("PUT", "").body)["sha256"], "0application/octet-stream");
}

TEST_F(UploadsTest, TakeTheTokenAndTheRoleOfTheCallBeforeTheirBytes) {
  StartGateway(SecureOptions(signer_));
  const auto stranger = Begin(1 << 30, "Expect: 100-continue\r\n");
  const std::string answer = stranger->ReadUntil("}");
  EXPECT_THAT(answer, HasSubstr("401 Unauthorized"));
  EXPECT_THAT(answer, Not(HasSubstr("100 Continue")));
  const std::string viewer = signer_.Sign(
      {{"sub", "vera"}, {"roles", {"viewer"}}, {"exp", absl::ToUnixSeconds(absl::Now()) + 600}});
  const auto refused = Begin(1 << 30, "Authorization: Bearer " + viewer + "\r\n");
  EXPECT_THAT(refused->ReadUntil("}"), HasSubstr("ROLE_REQUIRED"));
  token_ = signer_.Sign(
      {{"sub", "ada"}, {"roles", {"designer"}}, {"exp", absl::ToUnixSeconds(absl::Now()) + 600}});
  EXPECT_EQ(Send("PUT", "abc").status, 200);
}

TEST_F(UploadsTest, WhatTheServiceRefusesEndsAtOnce) {
  StartGateway(Options());
  const auto stream = Begin(std::size_t{2} << 30);
  stream->Write(std::string(300000, 'x'));  // and nothing more, as the answer is waited for
  const std::string answer = stream->ReadUntil("}]");
  EXPECT_THAT(answer, HasSubstr("429"));
  EXPECT_THAT(answer, HasSubstr("TOO_LARGE"));
  EXPECT_THAT(answer, HasSubstr("Connection: close"));
}

TEST_F(UploadsTest, WhoLeavesInTheMiddleCancelsTheCall) {
  StartGateway(Options());
  const auto stream = Begin(10 << 20);
  stream->Write(std::string(1 << 20, 'x'));
  ASSERT_TRUE(house_.WaitForUploaded(1));
  stream->Close();
  EXPECT_TRUE(house_.WaitForCancelled(1));
}

TEST_F(UploadsTest, WhoSendsTooSlowlyIsToldSo) {
  GatewayOptions options = Options();
  options.http_patience.body = std::chrono::milliseconds(50);
  StartGateway(options);
  const auto stream = Begin(10 << 20);
  EXPECT_THAT(stream->ReadUntil("}"), HasSubstr("408 Request Timeout"));
}

TEST_F(UploadsTest, AServiceThatTakesItsTimeIsNoFaultOfTheClients) {
  GatewayOptions options = Options();
  options.http_patience.body = std::chrono::milliseconds(50);
  StartGateway(options);
  const auto stream = Begin(100, "Content-Type: test/stall\r\n", std::string(100, 'x'));
  ASSERT_TRUE(house_.WaitForUploaded(1));
  // Its answer is waited for, until somebody leaves.
  stream->Close();
  EXPECT_TRUE(house_.WaitForCancelled(1));
}

TEST_F(UploadsTest, TheConnectionGoesOn) {
  StartGateway(Options());
  const auto stream = Begin(3);
  stream->Write("abcGET /version HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const std::string answers = stream->ReadUntil("version\"");
  EXPECT_THAT(answers, HasSubstr("3application/octet-stream"));
  EXPECT_THAT(answers, HasSubstr("version"));
}

}  // namespace
}  // namespace mortise::gateway
