#include "common/rpc/metrics_endpoint.h"

#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::rpc {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;

constexpr std::chrono::seconds kPatience{10};
constexpr std::size_t kLongestRequest = 8192;

http::response<http::string_body> Answer(const http::request<http::empty_body>& request,
                                         const std::shared_ptr<prometheus::Registry>& registry) {
  http::response<http::string_body> response;
  response.version(request.version());
  response.keep_alive(false);
  response.set(http::field::content_type, "text/plain; version=0.0.4; charset=utf-8");
  if (request.target() != "/metrics") {
    response.result(http::status::not_found);
    response.body() = "metrics are at /metrics\n";
  } else if (registry) {
    response.body() = prometheus::TextSerializer().Serialize(registry->Collect());
  }
  response.prepare_payload();
  return response;
}

// One connection: one request, one answer.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, std::shared_ptr<prometheus::Registry> registry)
      : stream_(std::move(socket)), registry_(std::move(registry)), buffer_(kLongestRequest) {}

  void Begin() {
    stream_.expires_after(kPatience);
    http::async_read(stream_, buffer_, request_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) {
                       if (!error) self->Respond();
                     });
  }

 private:
  void Respond() {
    response_ = Answer(request_, registry_);
    http::async_write(stream_, response_,
                      [self = shared_from_this()](beast::error_code, std::size_t) {
                        beast::error_code ignored;
                        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
                      });
  }

  beast::tcp_stream stream_;
  const std::shared_ptr<prometheus::Registry> registry_;
  beast::flat_buffer buffer_;
  http::request<http::empty_body> request_;
  http::response<http::string_body> response_;
};

class BeastEndpoint : public MetricsEndpoint {
 public:
  explicit BeastEndpoint(std::shared_ptr<prometheus::Registry> registry)
      : registry_(std::move(registry)) {}

  ~BeastEndpoint() override {
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }

  absl::Status Begin(const std::string& address) {
    const std::size_t colon = address.rfind(':');
    if (colon == std::string::npos) return InvalidField("metrics", "is not of the form HOST:PORT");
    beast::error_code error;
    tcp::resolver resolver(context_);
    const auto found = resolver.resolve(address.substr(0, colon), address.substr(colon + 1),
                                        tcp::resolver::passive, error);
    if (error) return PeerUnavailable(address, error.message());
    const tcp::endpoint endpoint = *found.begin();
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) return PeerUnavailable(address, error.message());
    address_ = absl::StrCat(address.substr(0, colon), ":", acceptor_.local_endpoint().port());
    Accept();
    thread_ = std::thread([this] { context_.run(); });
    return absl::OkStatus();
  }

  const std::string& address() const override { return address_; }

 private:
  void Accept() {
    acceptor_.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (!error) std::make_shared<Connection>(std::move(socket), registry_)->Begin();
      if (error != asio::error::operation_aborted) Accept();
    });
  }

  const std::shared_ptr<prometheus::Registry> registry_;
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  std::string address_;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::Start(
    const std::string& address, std::shared_ptr<prometheus::Registry> registry) {
  auto endpoint = std::make_unique<BeastEndpoint>(std::move(registry));
  MORTISE_RETURN_IF_ERROR(endpoint->Begin(address));
  return std::unique_ptr<MetricsEndpoint>(std::move(endpoint));
}

}  // namespace mortise::rpc
