// Files by GET, as curl, browsers and spreadsheets ask for them.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "common/base/digest.h"
#include "gateway/http/compression.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr std::size_t kBytes = 600000;  // three pieces
const std::string kExport = "/mortise.v1.CatalogService/ExportDesign";

std::string FileTarget(std::size_t bytes = kBytes, const std::string& name = "templates/file") {
  return kExport + "?name=" + name + "&format=STEP&revision=" + std::to_string(bytes);
}

class FilesTest : public GatewayTest {
 protected:
  HttpAnswer Ask(const std::string& method, const std::string& target,
                 std::map<std::string, std::string> headers = {}) {
    if (!token_.empty()) headers.emplace("Authorization", "Bearer " + token_);
    return Http(gateway_->addresses().http, method, target, headers);
  }

  HttpAnswer Get(const std::string& target, std::map<std::string, std::string> headers = {}) {
    return Ask("GET", target, std::move(headers));
  }

  void StartInDevelopment() { StartGateway(Options()); }

  void StartFor(const std::string& role) {
    StartGateway(SecureOptions(signer_));
    token_ = signer_.Sign(
        {{"sub", "ada"}, {"roles", {role}}, {"exp", absl::ToUnixSeconds(absl::Now()) + 600}});
  }

  const TokenSigner signer_{"EdDSA"};
  std::string token_;
};

TEST_F(FilesTest, ComeWholeWithNameTypeAndDigest) {
  StartFor("viewer");
  const HttpAnswer answer = Get(FileTarget());
  ASSERT_EQ(answer.status, 200) << answer.body;
  const std::string bytes = FakeHouse::FileBytes(kBytes);
  EXPECT_TRUE(answer.body == bytes);
  EXPECT_EQ(answer.headers.at("content-length"), std::to_string(kBytes));
  EXPECT_EQ(answer.headers.at("content-type"), "model/step");
  EXPECT_EQ(answer.headers.at("content-disposition"), "attachment; filename=\"table.step\"");
  EXPECT_EQ(answer.headers.at("etag"), "\"" + Sha256Hex(bytes) + "\"");
  EXPECT_EQ(answer.headers.at("accept-ranges"), "bytes");
  EXPECT_EQ(answer.headers.at("x-content-type-options"), "nosniff");
  const HttpAnswer empty = Get(FileTarget(0));
  EXPECT_EQ(empty.status, 200);
  EXPECT_EQ(empty.body, "");
}

TEST_F(FilesTest, TakeTheTokenAndTheRoleOfTheCall) {
  StartFor("nothing");
  EXPECT_EQ(Get(FileTarget()).status, 403);
  EXPECT_EQ(Ask("HEAD", FileTarget()).status, 403);
  token_ = "none";
  EXPECT_EQ(Get(FileTarget()).status, 401);
}

TEST_F(FilesTest, AreNotSentToWhoHasThem) {
  StartInDevelopment();
  const std::string tag = Get(FileTarget()).headers.at("etag");
  for (const std::string& known : {tag, "W/" + tag, "\"other\", " + tag, std::string("*")}) {
    const HttpAnswer answer = Get(FileTarget(), {{"If-None-Match", known}});
    EXPECT_EQ(answer.status, 304) << known;
    EXPECT_EQ(answer.body, "");
    EXPECT_EQ(answer.headers.at("etag"), tag);
    EXPECT_EQ(answer.headers.count("content-length"), 0u);
  }
  EXPECT_EQ(Get(FileTarget(), {{"If-None-Match", "\"other\""}}).status, 200);
}

TEST_F(FilesTest, ComeInRanges) {
  StartInDevelopment();
  const std::string bytes = FakeHouse::FileBytes(kBytes);
  const std::string tag = Get(FileTarget()).headers.at("etag");
  const struct {
    const char* range;
    std::size_t first, last;
  } kRanges[] = {{"bytes=0-0", 0, 0},
                 {"bytes=262143-262144", 262143, 262144},
                 {"bytes=300000-", 300000, kBytes - 1},
                 {"bytes=-10", kBytes - 10, kBytes - 1},
                 {"bytes=0-99999999", 0, kBytes - 1}};
  for (const auto& [range, first, last] : kRanges) {
    const HttpAnswer answer = Get(FileTarget(), {{"Range", range}, {"If-Range", tag}});
    EXPECT_EQ(answer.status, 206) << range;
    EXPECT_TRUE(answer.body == bytes.substr(first, last - first + 1)) << range;
    EXPECT_EQ(answer.headers.at("content-range"), "bytes " + std::to_string(first) + "-" +
                                                      std::to_string(last) + "/" +
                                                      std::to_string(kBytes));
  }
  EXPECT_EQ(Get(FileTarget(), {{"Range", "bytes=5-9"}, {"If-Range", "\"old\""}}).status, 200);
  EXPECT_EQ(Get(FileTarget(), {{"Range", "bytes=0-1,5-6"}}).status, 200) << "one range at a time";
  const HttpAnswer beyond = Get(FileTarget(), {{"Range", "bytes=600000-"}});
  EXPECT_EQ(beyond.status, 416);
  EXPECT_EQ(beyond.headers.at("content-range"), "bytes */600000");
  EXPECT_EQ(Json::parse(beyond.body)["code"], "out_of_range");
}

TEST_F(FilesTest, TellTheirHeadersAlone) {
  StartInDevelopment();
  const auto stream = HttpStream::Send(gateway_->addresses().http,
                                       "HEAD " + FileTarget() +
                                           " HTTP/1.1\r\nHost: localhost\r\n\r\n"
                                           "GET /version HTTP/1.1\r\nHost: localhost\r\n\r\n");
  const std::string answers = stream->ReadUntil("version\"");
  EXPECT_THAT(answers, HasSubstr("Content-Length: 600000"));
  EXPECT_THAT(answers, HasSubstr("etag: \""));
  EXPECT_THAT(answers, HasSubstr("\r\n\r\nHTTP/1.1 200 OK")) << "no body between the answers";
}

TEST_F(FilesTest, AreCompressedForWhoTakesIt) {
  StartInDevelopment();
  const HttpAnswer answer = Get(FileTarget(), {{"Accept-Encoding", "gzip, br"}});
  ASSERT_EQ(answer.status, 200);
  EXPECT_EQ(answer.headers.at("content-encoding"), "gzip");
  EXPECT_THAT(answer.headers.at("etag"), HasSubstr("-gzip\""));
  EXPECT_LT(answer.body.size(), kBytes / 10);
  const auto expanded = ExpandGzip(answer.body, kBytes);
  ASSERT_TRUE(expanded.ok()) << expanded.status();
  EXPECT_TRUE(*expanded == FakeHouse::FileBytes(kBytes));
  const HttpAnswer known = Get(
      FileTarget(), {{"Accept-Encoding", "gzip"}, {"If-None-Match", answer.headers.at("etag")}});
  EXPECT_EQ(known.status, 304);
  EXPECT_EQ(Get(FileTarget(100), {{"Accept-Encoding", "gzip"}}).headers.count("content-encoding"),
            0u);
  const HttpAnswer range =
      Get(FileTarget(), {{"Accept-Encoding", "gzip"}, {"Range", "bytes=0-4999"}});
  EXPECT_EQ(range.status, 206);
  EXPECT_EQ(range.body.size(), 5000u);
}

TEST_F(FilesTest, NamesAndTypesOfServicesAreNoHeaders) {
  StartInDevelopment();
  const HttpAnswer answer = Get(FileTarget(10, "templates/page"));
  ASSERT_EQ(answer.status, 200);
  EXPECT_EQ(answer.headers.count("set-cookie"), 0u);
  EXPECT_EQ(answer.headers.count("x-evil"), 0u);
  EXPECT_EQ(answer.headers.at("content-type"), "application/octet-stream");
  EXPECT_THAT(answer.headers.at("content-disposition"), Not(HasSubstr("/")));
  EXPECT_THAT(answer.headers.at("content-security-policy"), HasSubstr("sandbox"));
}

TEST_F(FilesTest, FailuresHaveTheirStatus) {
  StartInDevelopment();
  const HttpAnswer missing = Get("/mortise.v1.ParetoService/ExportFront?name=fronts/x&format=CSV");
  EXPECT_EQ(missing.status, 503);
  EXPECT_EQ(Json::parse(missing.body)["reason"], "PEER_UNAVAILABLE");
  EXPECT_EQ(Get(kExport + "?name=templates/file&parameters[1].name=x").status, 400);
  const HttpAnswer listed = Get(kExport +
                                "?name=templates/file&revision=3&parameters%5B0%5D.name=length&"
                                "parameters%5B0%5D.value=1.5");
  EXPECT_EQ(listed.body, FakeHouse::FileBytes(3));
  const HttpAnswer whole =
      Get(kExport + "?message=%7B%22name%22:%22templates/file%22,%22revision%22:%223%22%7D");
  EXPECT_EQ(whole.body, FakeHouse::FileBytes(3));
}

TEST_F(FilesTest, AFileThatEndsEarlyIsNotTakenForWhole) {
  StartInDevelopment();
  const auto stream =
      HttpStream::Send(gateway_->addresses().http, "GET " + FileTarget(1000, "templates/short") +
                                                       " HTTP/1.1\r\nHost: localhost\r\n\r\n");
  EXPECT_TRUE(stream->AwaitClose());
  EXPECT_THAT(stream->ReadUntil("\r\n\r\n"), HasSubstr("Content-Length: 1001"));
}

TEST_F(FilesTest, WhoLeavesOrReadsSlowlyStopsTheService) {
  StartInDevelopment();
  const auto stream =
      HttpStream::Send(gateway_->addresses().http, "GET " + kExport +
                                                       "?name=templates/endless HTTP/1.1\r\n"
                                                       "Host: localhost\r\n\r\n");
  EXPECT_THAT(stream->ReadUntil("xxx"), HasSubstr("200 OK"));
  // Nothing more is read: what is on its way is bounded by windows and buffers, not by the file.
  EXPECT_LT(house_.counts().written, 400);
  stream->Close();
  EXPECT_TRUE(house_.WaitForCancelled(1));
}

}  // namespace
}  // namespace mortise::gateway
