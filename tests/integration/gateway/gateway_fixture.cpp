#include "tests/integration/gateway/gateway_fixture.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <cstdint>
#include <limits>

#include "absl/strings/ascii.h"
#include "common/base/files.h"
#include "common/rpc/identity.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

asio::ip::tcp::endpoint Endpoint(const std::string& address) {
  const auto colon = address.rfind(':');
  return {asio::ip::make_address(address.substr(0, colon)),
          static_cast<uint16_t>(std::stoi(address.substr(colon + 1)))};
}

template <class Request>
void Fill(Request& request, const std::map<std::string, std::string>& headers) {
  request.set(http::field::host, "localhost");
  for (const auto& [name, value] : headers) request.set(name, value);
}

}  // namespace

HttpAnswer Http(const std::string& address, const std::string& method, const std::string& target,
                const std::map<std::string, std::string>& headers, const std::string& body) {
  HttpAnswer answer;
  try {
    asio::io_context io;
    beast::tcp_stream stream(io);
    stream.connect(Endpoint(address));
    http::request<http::string_body> request(http::string_to_verb(method), target, 11);
    Fill(request, headers);
    request.set(http::field::connection, "close");
    request.body() = body;
    request.prepare_payload();
    beast::error_code error;
    // A server may refuse a large body before it has read it.
    http::write(stream, request, error);
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    // An endless stream sends what the machine can until its deadline.
    parser.body_limit(std::numeric_limits<std::uint64_t>::max());
    parser.skip(method == "HEAD");
    http::read(stream, buffer, parser);
    answer.status = parser.get().result_int();
    for (const auto& field : parser.get()) {
      const auto name = field.name_string();
      answer.headers[absl::AsciiStrToLower({name.data(), name.size()})] =
          std::string(field.value().data(), field.value().size());
    }
    answer.body = parser.get().body();
  } catch (const std::exception& error) {
    answer.body = error.what();
  }
  return answer;
}

struct HttpStream::Socket {
  asio::io_context io;
  asio::ip::tcp::socket socket{io};
};

HttpStream::HttpStream(const std::string& address) : socket_(std::make_unique<Socket>()) {
  socket_->socket.connect(Endpoint(address));
}

HttpStream::HttpStream(const std::string& address, const std::string& target,
                       const std::map<std::string, std::string>& headers)
    : HttpStream(address) {
  std::string request = "GET " + target + " HTTP/1.1\r\nHost: localhost\r\n";
  for (const auto& [name, value] : headers) request += name + ": " + value + "\r\n";
  Write(request + "\r\n");
}

std::unique_ptr<HttpStream> HttpStream::Send(const std::string& address, const std::string& bytes) {
  std::unique_ptr<HttpStream> stream(new HttpStream(address));
  stream->Write(bytes);
  return stream;
}

void HttpStream::Write(const std::string& bytes) {
  boost::system::error_code error;
  asio::write(socket_->socket, asio::buffer(bytes), error);
}

HttpStream::~HttpStream() = default;

std::string HttpStream::ReadUntil(const std::string& text) {
  ReadWhile([&] { return read_.find(text) == std::string::npos; });
  return read_;
}

std::string HttpStream::ReadBytes(std::size_t count) {
  ReadWhile([&] { return read_.size() < count; });
  return read_.substr(0, count);
}

bool HttpStream::AwaitClose() {
  return ReadWhile([] { return true; });
}

bool HttpStream::ReadWhile(const std::function<bool()>& not_done) {
  if (closed_) return true;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (not_done() && std::chrono::steady_clock::now() < deadline) {
    char buffer[4096];
    socket_->socket.async_read_some(asio::buffer(buffer),
                                    [&](const beast::error_code& error, std::size_t size) {
                                      closed_ = error && error != asio::error::operation_aborted;
                                      read_.append(buffer, size);
                                    });
    socket_->io.restart();
    socket_->io.run_until(deadline);
    if (closed_) return true;
    if (std::chrono::steady_clock::now() >= deadline) {
      socket_->socket.cancel();
      socket_->io.restart();
      socket_->io.run();
      break;
    }
  }
  return false;
}

void HttpStream::FinishSending() {
  boost::system::error_code error;
  socket_->socket.shutdown(asio::ip::tcp::socket::shutdown_send, error);
}

void HttpStream::Close() { socket_->socket.close(); }

GatewayOptions GatewayTest::Options() const {
  GatewayOptions options;
  options.services = {{"catalog", house_.address()},
                      {"simulator", house_.address()},
                      {"fabplanner", house_.address()},
                      // Nobody listens on port 1.
                      {"pareto", "127.0.0.1:1"}};
  options.store = "sqlite:" + (folder_.path() / "gateway.db").string();
  options.insecure_development = true;
  options.log_calls = false;
  options.drain_time = absl::Seconds(2);
  options.patience = absl::Seconds(1);  // longer than a busy machine takes to connect
  return options;
}

GatewayOptions GatewayTest::SecureOptions(const TokenSigner& signer) const {
  const auto jwks = folder_.path() / "jwks.json";
  EXPECT_TRUE(rpc::CreateIdentityKey(folder_.path() / "keys", "gateway").ok());
  EXPECT_TRUE(WriteFile(jwks, nlohmann::json{{"keys", {signer.Jwk("one")}}}.dump()).ok());
  GatewayOptions options = Options();
  options.insecure_development = false;
  options.keys = folder_.path() / "keys";
  options.jwt_keys = jwks;
  return options;
}

void GatewayTest::StartGateway(const GatewayOptions& options) {
  auto gateway = Gateway::Start(options);
  ASSERT_TRUE(gateway.ok()) << gateway.status();
  gateway_ = *std::move(gateway);
}

}  // namespace mortise::gateway
