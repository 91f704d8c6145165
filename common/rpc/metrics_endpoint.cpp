#include "common/rpc/metrics_endpoint.h"

#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>
#include <sys/socket.h>

#include <boost/asio.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/connections/connection_acceptor.h"

namespace mortise::rpc {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;

constexpr std::chrono::seconds kPatience{10};
constexpr std::size_t kMaxRequest = 8192;
constexpr int kMaxConnectionsHere = 64;

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
      : stream_(std::move(socket)), registry_(std::move(registry)), buffer_(kMaxRequest) {}

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
    acceptor_.reset();
    context_.stop();
    if (thread_.joinable()) thread_.join();
  }

  absl::Status Begin(const std::string& address) {
    AcceptorOptions acceptor;
    acceptor.listen = address;
    acceptor.most_connections = kMaxConnectionsHere;
    acceptor.silence = absl::FromChrono(kPatience);
    acceptor.take = [this](int descriptor) {
      asio::post(context_, [this, descriptor] { Serve(descriptor); });
    };
    MORTISE_ASSIGN_OR_RETURN(acceptor_, ConnectionAcceptor::Start(std::move(acceptor)));
    thread_ = std::thread([this] { context_.run(); });
    return absl::OkStatus();
  }

  const std::string& address() const override { return acceptor_->address(); }

 private:
  void Serve(int descriptor) {
    sockaddr_storage own = {};
    socklen_t size = sizeof(own);
    getsockname(descriptor, reinterpret_cast<sockaddr*>(&own), &size);
    const auto protocol = own.ss_family == AF_INET6 ? tcp::v6() : tcp::v4();
    std::make_shared<Connection>(tcp::socket(context_, protocol, descriptor), registry_)->Begin();
  }

  const std::shared_ptr<prometheus::Registry> registry_;
  asio::io_context context_{1};
  const asio::executor_work_guard<asio::io_context::executor_type> work_{context_.get_executor()};
  std::thread thread_;
  std::unique_ptr<ConnectionAcceptor> acceptor_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<MetricsEndpoint>> MetricsEndpoint::Start(
    const std::string& address, std::shared_ptr<prometheus::Registry> registry) {
  auto endpoint = std::make_unique<BeastEndpoint>(std::move(registry));
  MORTISE_RETURN_IF_ERROR(endpoint->Begin(address));
  return std::unique_ptr<MetricsEndpoint>(std::move(endpoint));
}

}  // namespace mortise::rpc
