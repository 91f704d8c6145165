// Forms that requests come in, right and wrong: each has its status, and words that do not mislead.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using Json = nlohmann::json;

const std::string kGetItem = "/mortise.v1.CatalogService/GetItem";
const std::string kExport = "/mortise.v1.CatalogService/ExportDesign";
const std::string kUpload = "/mortise.v1.SimulatorService/UploadBlob";
const std::string kJson = "Content-Type: application/json\r\n";
const std::string kHost = "Host: localhost\r\n";
const std::string kEcho = R"({"name":"items/echo"})";

// A request as bytes, and what the answer must have.
struct Form {
  const char* name;
  std::string request;
  int status;
  std::string words;  // in the answer, headers included
};

std::string Length(std::size_t bytes) {
  return "Content-Length: " + std::to_string(bytes) + "\r\n";
}

std::string Post(const std::string& target, const std::string& headers, const std::string& body) {
  return "POST " + target + " HTTP/1.1\r\n" + headers + Length(body.size()) + "\r\n" + body;
}

std::string Call(const std::string& body) { return Post(kGetItem, kHost + kJson, body); }

std::string Get(const std::string& target, const std::string& headers = kHost) {
  return "GET " + target + " HTTP/1.1\r\n" + headers + "\r\n";
}

std::string Of(const std::string& method, const std::string& target) {
  return method + " " + target + " HTTP/1.1\r\n" + kHost + "\r\n";
}

std::string ManyHeaders(int count, std::size_t bytes) {
  std::string headers;
  for (int i = 0; i < count; ++i) {
    headers += "X-" + std::to_string(i) + ": " + std::string(bytes, 'a') + "\r\n";
  }
  return headers;
}

std::vector<Form> Forms() {
  const std::string origin = "http://localhost:7780";
  return {
      // What is there, and what may be done with it.
      {"options of a method", Of("OPTIONS", kGetItem), 204, "allow: POST, OPTIONS\r\n"},
      {"options of a document", Of("OPTIONS", "/version"), 204, "allow: GET, HEAD, OPTIONS\r\n"},
      {"options of events", Of("OPTIONS", "/events"), 204, "allow: GET, OPTIONS\r\n"},
      {"options of all", Of("OPTIONS", "*"), 204, "allow: GET, HEAD, POST, PUT, OPTIONS\r\n"},
      {"options of nothing", Of("OPTIONS", "/nothing"), 404, "nothing at /nothing"},
      {"events posted", Post("/events", kHost + kJson, "{}"), 405, "allow: GET, OPTIONS\r\n"},
      {"events' head", Of("HEAD", "/events"), 405, "allow: GET, OPTIONS\r\n"},
      {"document posted", Post("/version", kHost + kJson, "{}"), 405, "allow: GET, HEAD, OPTIONS"},
      {"method read", Get(kGetItem), 405, "allow: POST, OPTIONS\r\n"},
      {"method deleted", Of("DELETE", kGetItem), 405, "made by POST"},
      {"traced", Of("TRACE", kGetItem), 405, "allow: POST"},
      {"file deleted", Of("DELETE", kExport), 405, "allow: GET, HEAD, POST, OPTIONS\r\n"},
      {"file put", Of("PUT", kExport), 405, "is read by GET"},
      {"upload read", Get(kUpload), 405, "allow: POST, PUT, OPTIONS\r\n"},
      {"upload as a form", Post(kUpload, kHost + "Content-Type: multipart/form-data\r\n", "x"), 415,
       "application/connect+json"},
      {"upload of no type", Post(kUpload, kHost, "x"), 415, "content-type"},
      {"upload of no length",
       "PUT " + kUpload + " HTTP/1.1\r\n" + kHost + "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
       411, "how large it is"},
      {"upload in gzip",
       "PUT " + kUpload + " HTTP/1.1\r\n" + kHost + Length(1) + "Content-Encoding: gzip\r\n\r\nx",
       415, "as they are"},
      {"upload whose digest is none",
       "PUT " + kUpload + " HTTP/1.1\r\n" + kHost + Length(1) +
           "Content-Digest: sha-256=:abc:\r\n\r\nx",
       400, "content-digest"},
      {"file of a field that is not there", Get(kExport + "?nom=x"), 400, "no such field"},
      {"file of a wrong value", Get(kExport + "?revision=two"), 400, "revision"},
      {"file of two requests", Get(kExport + "?message=%7B%7D&name=x"), 400, "no other parameter"},
      {"nothing deleted", Of("DELETE", "/nothing"), 404, "nothing at /nothing"},
      {"another's verb", Of("BREW", "/version"), 405, "allow: GET"},
      {"tunnel", "CONNECT localhost:1 HTTP/1.1\r\n" + kHost + "\r\n", 400, "must begin with '/'"},
      {"document's head", Of("HEAD", "/version"), 200, "Content-Length: "},
      // Targets.
      {"whole address", Post(origin + kGetItem, kHost + kJson, kEcho), 200, "supplier"},
      {"whole address of a document", Get("HTTP://127.0.0.1/version"), 200, "version"},
      {"whole address without a path", Get("http://localhost:7780"), 404, "nothing at /"},
      {"whole address elsewhere", Get("http://evil.example/version"), 403, "permission_denied"},
      {"another scheme", Get("ftp://localhost/version"), 400, "must begin with '/'"},
      {"no slash", Get("version"), 400, "must begin with '/'"},
      {"escape cut short", Get("/version%4"), 400, "%-escape"},
      {"long target", Get("/" + std::string(9000, 'a')), 400, "longer than 8 KiB"},
      {"parameters of a document", Get("/version?x=1"), 200, "version"},
      // Hosts: a page elsewhere may have its own name point here.
      {"host without a port", Get("/version", "Host: localhost\r\n"), 200, "version"},
      {"host in capitals", Get("/version", "Host: LOCALHOST:80\r\n"), 200, "version"},
      {"host as address", Get("/version", "Host: 127.8.9.1:7780\r\n"), 200, "version"},
      {"host as new address", Get("/version", "Host: [::1]:7780\r\n"), 200, "version"},
      {"host elsewhere", Get("/version", "Host: evil.example\r\n"), 403, "evil.example"},
      {"host elsewhere calls", Post(kGetItem, "Host: evil.example:7780\r\n" + kJson, kEcho), 403,
       "localhost, 127.0.0.1 and [::1] only"},
      {"host like ours", Get("/version", "Host: localhost.evil.example\r\n"), 403, "evil"},
      {"host like an address", Get("/version", "Host: 127.0.0.1.evil.example\r\n"), 403, "evil"},
      {"host in another house", Get("/version", "Host: 192.168.0.7\r\n"), 403, "192.168.0.7"},
      {"host any", Get("/version", "Host: 0.0.0.0\r\n"), 403, "0.0.0.0"},
      {"host as number", Get("/version", "Host: 2130706433\r\n"), 403, "2130706433"},
      {"host with a user", Get("/version", "Host: localhost@evil.example\r\n"), 403, "evil"},
      {"host with a bad port", Get("/version", "Host: localhost:x\r\n"), 403, "localhost:x"},
      {"host empty", Get("/version", "Host: \r\n"), 403, "permission_denied"},
      {"no host", Get("/version", ""), 400, "host: is needed"},
      {"no host in old HTTP", "GET /version HTTP/1.0\r\n\r\n", 200, "version"},
      {"two hosts", Get("/version", kHost + "Host: evil.example\r\n"), 400, "more than once"},
      // Bodies.
      {"empty body", Call(""), 400, "is empty; one without fields is {}"},
      {"body of space", Call(" \n\t"), 400, "is empty"},
      {"no length", "POST " + kGetItem + " HTTP/1.1\r\n" + kHost + kJson + "\r\n", 400, "is empty"},
      {"byte-order mark", Call("\xef\xbb\xbf" + kEcho), 400, "byte-order mark"},
      {"UTF-16", Call(std::string("\xff\xfe{\0}\0", 6)), 400, "byte-order mark"},
      {"chunked",
       "POST " + kGetItem + " HTTP/1.1\r\n" + kHost + kJson +
           "Transfer-Encoding: chunked\r\n\r\n15\r\n" + kEcho + "\r\n0\r\n\r\n",
       200, "supplier"},
      {"chunks that are none",
       "POST " + kGetItem + " HTTP/1.1\r\n" + kHost + kJson +
           "Transfer-Encoding: chunked\r\n\r\nxyz\r\n",
       400, "not as its headers say"},
      {"length and chunks", Post(kGetItem, kHost + kJson + "Transfer-Encoding: chunked\r\n", kEcho),
       400, ""},
      {"two lengths", Post(kGetItem, kHost + kJson + Length(3), kEcho), 400, "HTTP/1.1"},
      {"length below zero", Get("/version", kHost + "Content-Length: -1\r\n"), 400, "HTTP/1.1"},
      {"compressed", Post(kGetItem, kHost + kJson + "Content-Encoding: gzip\r\n", kEcho), 400,
       "no sound gzip"},
      {"compressed otherwise", Post(kGetItem, kHost + kJson + "Content-Encoding: br\r\n", kEcho),
       501, "other than gzip"},
      {"type with parameters",
       Post(kGetItem, kHost + "Content-Type: Application/JSON; charset=utf-8\r\n", kEcho), 200,
       "supplier"},
      {"no type", Post(kGetItem, kHost, kEcho), 415, "takes application/json"},
      // Headers.
      {"one large header", Post(kGetItem, kHost + kJson + ManyHeaders(1, 70000), kEcho), 431,
       "headers"},
      {"many headers", Post(kGetItem, kHost + kJson + ManyHeaders(90, 100), kEcho), 431,
       "the headers to be passed on have"},
      {"a large header", Post(kGetItem, kHost + kJson + ManyHeaders(1, 9000), kEcho), 431,
       "x-0 (9035)"},
      {"headers that fit", Post(kGetItem, kHost + kJson + ManyHeaders(40, 100), kEcho), 200, ""},
      {"large headers of a document", Get("/version", kHost + ManyHeaders(1, 9000)), 200, ""},
      {"a header without a name", Get("/version", kHost + ": x\r\n"), 400, "HTTP/1.1"},
      {"a header with a space", Get("/version", kHost + "X y: z\r\n"), 400, "HTTP/1.1"},
      {"no time", Post(kGetItem, kHost + kJson + "Connect-Timeout-Ms: 0\r\n", kEcho), 504, ""},
      {"two tokens",
       Post(kGetItem, kHost + kJson + "Authorization: Bearer a\r\nAuthorization: Bearer b\r\n",
            kEcho),
       401, "more than one authorization"},
      // What is not HTTP/1.1.
      {"old HTTP", "GET /version HTTP/0.9\r\n\r\n", 400, "HTTP/1.1"},
      {"new HTTP", "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", 400, "HTTP/1.1"},
      {"TLS", "\x16\x03\x01\x02garbage\r\n\r\n", 400, "HTTP/1.1"},
      {"no version", "GET /version\r\n\r\n", 400, "HTTP/1.1"},
  };
}

class HttpFormsTest : public GatewayTest {
 protected:
  void SetUp() override { StartGateway(Options()); }
};

TEST_F(HttpFormsTest, EachHasItsAnswerAndARequestId) {
  for (const Form& form : Forms()) {
    const auto stream = HttpStream::Send(gateway_->addresses().http, form.request);
    const std::string end = "\r\n\r\n";
    std::string answer = stream->ReadUntil(end);
    const auto length = answer.find("Content-Length: ");
    const bool has_body = form.request.starts_with("HEAD") == false && length != std::string::npos;
    if (has_body) {
      const std::size_t size = std::stoul(answer.substr(length + 16));
      answer = stream->ReadBytes(answer.find(end) + end.size() + size);
    }
    EXPECT_THAT(answer, HasSubstr("HTTP/1.1 " + std::to_string(form.status) + " ")) << form.name;
    EXPECT_THAT(answer, HasSubstr(form.words)) << form.name;
    const auto id = answer.find("x-request-id: ");
    ASSERT_NE(id, std::string::npos) << form.name << "\n" << answer;
    EXPECT_EQ(answer.find("x-request-id: ", id + 1), std::string::npos) << form.name;
    if (form.status >= 400 && has_body) {
      EXPECT_TRUE(Json::accept(answer.substr(answer.find(end) + end.size()))) << form.name << "\n"
                                                                              << answer;
    }
    if (form.request.starts_with("HEAD")) {
      EXPECT_TRUE(answer.ends_with(end)) << form.name << "\n" << answer;
    }
  }
}

TEST_F(HttpFormsTest, TheRequestIdIsTheClientsOwnWhereItHasOne) {
  const std::string own = "X-Request-Id: mine-7\r\n";
  for (const std::string& request :
       {Post(kGetItem, kHost + kJson + own + "Connect-Timeout-Ms: 0\r\n", kEcho),
        Post("/events", kHost + own, ""), Get("/version", kHost + own),
        Get("/nothing", kHost + own), Get("/events?after=x", kHost + own)}) {
    const auto stream = HttpStream::Send(gateway_->addresses().http, request);
    EXPECT_THAT(stream->ReadUntil("\r\n\r\n"), HasSubstr("x-request-id: mine-7\r\n")) << request;
  }
}

TEST_F(HttpFormsTest, TryingAgainIsSuggestedOnlyWhereItMayHelp) {
  const auto large = HttpStream::Send(gateway_->addresses().http,
                                      Post(kGetItem, kHost + kJson + ManyHeaders(90, 100), kEcho));
  EXPECT_THAT(large->ReadUntil("\r\n\r\n"), Not(HasSubstr("retry-after")));
}

// With tokens, a house is called by its own names, which it does not know.
TEST_F(HttpFormsTest, SecureHousesTakeAnyHost) {
  gateway_.reset();
  const TokenSigner signer("EdDSA");
  StartGateway(SecureOptions(signer));
  const auto stream =
      HttpStream::Send(gateway_->addresses().http, Get("/version", "Host: mortise.example\r\n"));
  EXPECT_THAT(stream->ReadUntil("}"), HasSubstr("200 OK"));
}

}  // namespace
}  // namespace mortise::gateway
