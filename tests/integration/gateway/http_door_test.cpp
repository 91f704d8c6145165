// JSON over HTTP: calls, failures, documents, and what happens to malformed input.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "gateway/contract/connect_protocol.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

constexpr char kGetItem[] = "/mortise.v1.CatalogService/GetItem";
constexpr char kExport[] = "/mortise.v1.CatalogService/ExportDesign";
constexpr char kUpload[] = "/mortise.v1.SimulatorService/UploadBlob";

class HttpDoorTest : public GatewayTest {
 protected:
  void SetUp() override { StartGateway(Options()); }

  HttpAnswer Post(const std::string& path, const std::string& body,
                  std::map<std::string, std::string> headers = {}) {
    headers.emplace("Content-Type", "application/json");
    return Http(gateway_->addresses().http, "POST", path, headers, body);
  }

  HttpAnswer Get(const std::string& path) { return Http(gateway_->addresses().http, "GET", path); }

  static void ExpectError(const HttpAnswer& answer, int status, const std::string& code,
                          const std::string& word = "") {
    EXPECT_EQ(answer.status, status) << answer.body;
    const Json json = Json::parse(answer.body, nullptr, false);
    ASSERT_TRUE(json.is_object()) << answer.body;
    EXPECT_EQ(json["code"], code);
    EXPECT_THAT(json.value("message", ""), HasSubstr(word));
  }
};

TEST_F(HttpDoorTest, AnswersUnaryCalls) {
  const HttpAnswer answer = Post(kGetItem, R"({"name":"items/echo"})",
                                 {{"X-Custom", "blue"}, {"X-Request-Id", "request-9"}});
  ASSERT_EQ(answer.status, 200) << answer.body;
  const Json item = Json::parse(answer.body);
  EXPECT_EQ(item["title"], "blue");
  EXPECT_EQ(item["revision"], "1152921504606846976") << "64-bit numbers are strings";
  EXPECT_EQ(item["supplier"], "request-9");
  EXPECT_EQ(answer.headers.at("x-request-id"), "request-9");
  EXPECT_EQ(answer.headers.at("x-lead"), "first");
  EXPECT_EQ(answer.headers.at("trailer-x-trail"), "last");
  EXPECT_EQ(answer.headers.at("content-type"), "application/json");
}

TEST_F(HttpDoorTest, AnswersStreams) {
  const HttpAnswer answer = Post(kExport, Envelope(0, R"({"revision":"600000"})"),
                                 {{"Content-Type", "application/connect+json"}});
  ASSERT_EQ(answer.status, 200) << answer.body;
  std::string_view body = answer.body;
  std::vector<Json> messages;
  std::string last_flags;
  while (body.size() >= kEnvelopeHeaderBytes) {
    last_flags = body[0];
    std::size_t size = 0;
    for (int i = 1; i < 5; ++i) size = size << 8 | static_cast<unsigned char>(body[i]);
    messages.push_back(Json::parse(body.substr(5, size)));
    body.remove_prefix(5 + size);
  }
  ASSERT_EQ(messages.size(), 4u);
  EXPECT_EQ(messages[1]["offset"], "262144");
  EXPECT_EQ(last_flags[0], static_cast<char>(kEndStreamFlag));
  EXPECT_FALSE(messages.back().contains("error"));
}

TEST_F(HttpDoorTest, TakesStreamsOfMessagesInOneBody) {
  const std::map<std::string, std::string> streaming = {
      {"Content-Type", "application/connect+json"}};
  // "abcd", "e" and nothing, in base64.
  const std::string chunks = Envelope(0, R"({"totalSize":"5","data":"YWJjZA=="})") +
                             Envelope(0, R"({"offset":"4","data":"ZQ=="})") +
                             Envelope(0, R"({"offset":5})");
  const HttpAnswer answer = Post(kUpload, chunks, streaming);
  ASSERT_EQ(answer.status, 200) << answer.body;
  EXPECT_EQ(answer.headers.at("content-type"), "application/connect+json");
  EXPECT_THAT(answer.body, HasSubstr(R"({"sha256":"5"})")) << "the number of bytes that came";
  EXPECT_THAT(answer.body, Not(HasSubstr("error")));
  // A stream of none is one, too.
  EXPECT_THAT(Post(kUpload, "", streaming).body, HasSubstr(R"({"sha256":"0"})"));

  const auto refusal = [&](const std::string& body) { return Post(kUpload, body, streaming).body; };
  EXPECT_THAT(refusal(Envelope(0, R"({"data":"?"})")), HasSubstr("data"));
  EXPECT_THAT(refusal(Envelope(0, R"({"data":"YQ=="})") + Envelope(0, R"({"size":1})")),
              HasSubstr("size"));
  EXPECT_THAT(refusal(chunks.substr(0, chunks.size() - 3)), HasSubstr("invalid_argument"));
  ExpectError(Post(kUpload, R"({"data":"YQ=="})"), 415, "invalid_argument",
              "application/connect+json");
}

TEST_F(HttpDoorTest, NamesTheFieldOfBadInput) {
  ExpectError(Post(kGetItem, R"({"nmae":"x"})"), 400, "invalid_argument", "nmae");
  ExpectError(Post(kGetItem, R"({"name":7})"), 400, "invalid_argument", "name");
  ExpectError(Post(kGetItem, "{"), 400, "invalid_argument");
  ExpectError(Post(kGetItem, "\xff\xfe"), 400, "invalid_argument");
  ExpectError(Post("/mortise.v1.CatalogService/CreateItem", R"({"item":{"kind":"DANCING"}})"), 400,
              "invalid_argument", "kind");
  ExpectError(Post("/mortise.v1.CatalogService/EvaluateTemplate",
                   R"({"parameters":[{"name":"a","value":"wide"}]})"),
              400, "invalid_argument", "parameters[0].value");
  const HttpAnswer details = Post(kGetItem, R"({"nmae":"x"})");
  EXPECT_FALSE(Json::parse(details.body)["details"].empty());
}

TEST_F(HttpDoorTest, NamesEveryFieldOfBadInput) {
  const HttpAnswer answer = Post("/mortise.v1.CatalogService/EvaluateTemplate",
                                 R"({"nmae":"a","parameters":[{"name":"a","value":"wide"},
                                     {"name":"b","value":1,"value":2}]})");
  ExpectError(answer, 400, "invalid_argument", "3 findings");
  for (const char* field : {"nmae: ", "parameters[0].value: ", "parameters[1].value: "}) {
    ExpectError(answer, 400, "invalid_argument", field);
  }
  ExpectError(Post(kGetItem, R"({"name":"items/echo","name":"items/echo"})"), 400,
              "invalid_argument", "name: is there twice");
}

TEST_F(HttpDoorTest, TellsFailuresOfServices) {
  const HttpAnswer missing = Post(kGetItem, R"({"name":"items/missing"})");
  ExpectError(missing, 404, "not_found", "items/missing");
  EXPECT_EQ(Json::parse(missing.body)["reason"], "RESOURCE_NOT_FOUND");
  EXPECT_EQ(Json::parse(missing.body)["details"][0]["debug"]["reason"], "RESOURCE_NOT_FOUND");
  ExpectError(Post("/mortise.v1.ParetoService/GetFront", "{}"), 503, "unavailable", "pareto");
  ExpectError(Post("/mortise.v1.OperationService/GetOperation", R"({"name":"operations/x/1"})"),
              404, "not_found");
}

TEST_F(HttpDoorTest, KeepsToLimits) {
  const std::string large = R"({"name":")" + std::string(5 << 20, 'x') + R"("})";
  ExpectError(Post(kGetItem, large), 429, "resource_exhausted");
  // A streaming client looks for failures in the last envelope only.
  const HttpAnswer stream =
      Post(kExport, Envelope(0, large), {{"Content-Type", "application/connect+json"}});
  EXPECT_EQ(stream.status, 200);
  EXPECT_EQ(stream.headers.at("content-type"), "application/connect+json");
  EXPECT_THAT(stream.body, HasSubstr(R"({"error":{"code":"resource_exhausted")"));
  ExpectError(Post(kGetItem, R"({"name":"items/slow"})", {{"Connect-Timeout-Ms", "50"}}), 504,
              "deadline_exceeded");
  EXPECT_TRUE(house_.WaitForCancelled(1));
  ExpectError(Post(kGetItem, "{}", {{"Connect-Timeout-Ms", "soon"}}), 400, "invalid_argument");
  ExpectError(Post(kGetItem, "{}", {{"Connect-Protocol-Version", "2"}}), 400, "invalid_argument");
  ExpectError(Post(kGetItem, "{}", {{"Content-Encoding", "br"}}), 501, "unimplemented");
}

TEST_F(HttpDoorTest, RefusesWhatItCannotSpeak) {
  const HttpAnswer form =
      Post(kGetItem, "x=1", {{"Content-Type", "application/x-www-form-urlencoded"}});
  ExpectError(form, 415, "invalid_argument", "GetItem takes application/json");
  EXPECT_EQ(form.headers.at("content-type"), "application/json");
  EXPECT_EQ(form.headers.at("accept-post"), "application/json, application/proto");
  EXPECT_NE(form.headers.at("x-request-id"), "");
  // A stream wants envelopes, other calls do not.
  ExpectError(Post(kExport, "{}"), 415, "invalid_argument", "application/connect+json");
  ExpectError(Post(kGetItem, Envelope(0, "{}"), {{"Content-Type", "application/connect+json"}}),
              415, "invalid_argument", "content-type");
  ExpectError(Post("/mortise.v1.FabPlannerService/AttachBridge", Envelope(0, "{}"),
                   {{"Content-Type", "application/connect+json"}}),
              505, "unimplemented", "gRPC");
  const HttpAnswer nothing =
      Post("/mortise.v1.CatalogService/Nothing", "{}", {{"X-Request-Id", "request-8"}});
  ExpectError(nothing, 404, "unimplemented", "Nothing");
  EXPECT_EQ(nothing.headers.at("x-request-id"), "request-8");
  ExpectError(Post("/mortise.v1.CatalogService/GetItm", "{}"), 404, "unimplemented",
              "did you mean 'GetItem'?");
  EXPECT_EQ(Get(kGetItem).status, 405);
  EXPECT_EQ(Get("/nothing").status, 404);
  EXPECT_EQ(Get("/%zz").status, 400);
  EXPECT_EQ(Http(gateway_->addresses().http, "DELETE", kGetItem).status, 405);
}

TEST_F(HttpDoorTest, CancelsTheCallWhenTheClientLeaves) {
  auto post = [](const std::string& path, const std::string& type, const std::string& body) {
    return "POST " + path + " HTTP/1.1\r\nHost: localhost\r\nContent-Type: " + type +
           "\r\nContent-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
  };
  auto unary = HttpStream::Send(gateway_->addresses().http,
                                post(kGetItem, "application/json", R"({"name":"items/slow"})"));
  // A call that is cancelled on its way never gets to the service.
  ASSERT_TRUE(house_.WaitForSlow(1));
  unary->Close();
  EXPECT_TRUE(house_.WaitForCancelled(1));
  auto stream = HttpStream::Send(
      gateway_->addresses().http,
      post(kExport, "application/connect+json", Envelope(0, R"({"name":"templates/endless"})")));
  EXPECT_THAT(stream->ReadUntil("offset"), HasSubstr("application/connect+json"));
  stream->Close();
  EXPECT_TRUE(house_.WaitForCancelled(2));
}

TEST_F(HttpDoorTest, PassesTheDeadlineOfAStream) {
  const HttpAnswer answer =
      Post(kExport, Envelope(0, R"({"name":"templates/endless"})"),
           {{"Content-Type", "application/connect+json"}, {"Connect-Timeout-Ms", "300"}});
  EXPECT_THAT(answer.body, HasSubstr("deadline_exceeded"));
  EXPECT_TRUE(house_.WaitForCancelled(1));
}

TEST_F(HttpDoorTest, ServesDocuments) {
  EXPECT_EQ(Get("/healthz").body, "ok\n");
  EXPECT_TRUE(Json::parse(Get("/version").body).contains("version"));
  const Json document = Json::parse(Get("/openapi.json").body);
  EXPECT_EQ(document["openapi"], "3.1.0");
  Post(kGetItem, R"({"name":"items/echo"})");
  const std::string metrics = Get("/metrics").body;
  EXPECT_THAT(metrics, HasSubstr("mortise_gateway_calls_total"));
  EXPECT_THAT(metrics, HasSubstr("mortise.v1.CatalogService/GetItem"));
}

// Who forwards requests to this door and who serves them must agree where each ends.
TEST_F(HttpDoorTest, RefusesBodiesWhoseEndIsDoubtful) {
  const std::string next = "GET /version HTTP/1.1\r\nHost: localhost\r\n\r\n";
  const auto post = [](const std::string& version, const std::string& headers) {
    return "POST " + std::string(kGetItem) + " HTTP/" + version +
           "\r\nHost: localhost\r\nContent-Type: application/json\r\n" + headers + "\r\n";
  };
  const auto refused = [&](const std::string& request) {
    const auto stream = HttpStream::Send(gateway_->addresses().http, request + next);
    stream->FinishSending();
    EXPECT_TRUE(stream->AwaitClose()) << request;
    const std::string answer = stream->ReadUntil("}");
    EXPECT_THAT(answer, HasSubstr("400 Bad Request")) << request;
    EXPECT_THAT(answer, Not(HasSubstr("200 OK"))) << request << "what follows is not served";
  };
  for (const std::string coding : {"xchunked", "identity", "gzip", "chunked, identity",
                                   "chunked, gzip", "gzip, chunked", "\"chunked\"", ""}) {
    const std::string header = "Transfer-Encoding: " + coding + "\r\n";
    refused(post("1.1", header));
    refused(post("1.1", header + "Content-Length: 2\r\n") + "{}");
    refused("GET /healthz HTTP/1.1\r\nHost: localhost\r\n" + header + "\r\n");
  }
  const std::string chunked = "Transfer-Encoding: chunked\r\n";
  const std::string body = "2\r\n{}\r\n0\r\n\r\n";
  refused(post("1.0", chunked) + body);
  refused(post("1.1", chunked + "Content-Length: 2\r\n") + body);
  refused(post("1.1", "Transfer-Encoding: identity\r\n" + chunked) + body);
  refused(post("1.1", chunked + "Transfer-Encoding: identity\r\n") + body);
  const auto served = HttpStream::Send(gateway_->addresses().http,
                                       post("1.1", "Transfer-Encoding: Chunked\r\n") + body + next);
  EXPECT_THAT(served->ReadUntil("\"version\""), HasSubstr("200 OK"));
}

TEST_F(HttpDoorTest, SurvivesBytesThatAreNoHttp) {
  for (const std::string& garbage :
       {std::string("\r\n\r\n"), std::string("GET\r\n\r\n"),
        std::string("\x16\x03\x01\x02garbage\r\n\r\n"), std::string(100000, 'A'),
        "GET /healthz HTTP/9.9\r\n\r\n" + std::string(10, '\0')}) {
    const auto stream = HttpStream::Send(gateway_->addresses().http, garbage + "\r\n\r\n");
    stream->ReadUntil("\r\n\r\n");
  }
  EXPECT_EQ(Get("/healthz").status, 200);
}

}  // namespace
}  // namespace mortise::gateway
