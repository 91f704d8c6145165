#include "gateway/http_door.h"

#include <atomic>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "gateway/connect_handler.h"
#include "gateway/http_context.h"
#include "gateway/query.h"
#include "gateway/sse_handler.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

asio::awaitable<bool> WritePlain(HttpConnection& connection, int status, const char* type,
                                 std::string body, bool keep_alive) {
  const HeaderList headers = {{"content-type", type}};
  co_return co_await connection.Write(status, headers, std::move(body), keep_alive) && keep_alive;
}

// "operations/pareto/0198" of "/operations/pareto/0198/watch"; empty for other paths.
std::string WatchedOperation(std::string_view path) {
  constexpr std::string_view kEnd = "/watch";
  if (!path.starts_with("/operations/") || !path.ends_with(kEnd)) return {};
  const std::string_view name = path.substr(1, path.size() - 1 - kEnd.size());
  return ServiceOfOperation(name).empty() ? std::string() : std::string(name);
}

asio::awaitable<bool> HandleGet(HttpConnection& connection, const HttpContext& context,
                                const Target& target, const HttpRequest& request) {
  const bool keep_alive = request.keep_alive();
  if (target.path == "/healthz") {
    const bool serving = context.serving();
    co_return co_await WritePlain(connection, serving ? 200 : 503, "text/plain",
                                  serving ? "ok\n" : "draining\n", keep_alive);
  }
  if (target.path == "/version") {
    co_return co_await WritePlain(connection, 200, "application/json",
                                  absl::StrCat("{\"version\":\"", context.version, "\"}\n"),
                                  keep_alive);
  }
  if (target.path == "/openapi.json") {
    co_return co_await WritePlain(connection, 200, "application/json", context.openapi, keep_alive);
  }
  if (target.path == "/metrics") {
    co_return co_await WritePlain(connection, 200, "text/plain; version=0.0.4", context.metrics(),
                                  keep_alive);
  }
  if (target.path == "/events") {
    co_return co_await HandleEvents(connection, context, target, request) && keep_alive;
  }
  if (const std::string operation = WatchedOperation(target.path); !operation.empty()) {
    co_return co_await HandleOperationWatch(connection, context, operation, request) && keep_alive;
  }
  const int status = context.contract->Find(target.path) != nullptr ? 405 : 404;
  const ConnectError error = {
      absl::StatusCode::kUnimplemented,
      status == 405 ? "calls are made by POST" : "there is nothing at " + target.path,
      {}};
  const HeaderList headers = {RequestIdOf(request), {"allow", "POST"}};
  co_return co_await WriteErrorAs(status, connection, error, headers, keep_alive) && keep_alive;
}

asio::awaitable<bool> HandleRequest(HttpConnection& connection, const HttpContext& context,
                                    const HttpRequest& request) {
  const auto target = ParseTarget({request.target().data(), request.target().size()});
  if (!target.ok()) {
    const HeaderList headers = {RequestIdOf(request)};
    co_return co_await WriteError(connection, ToConnectError(target.status()), headers,
                                  request.keep_alive()) &&
        request.keep_alive();
  }
  if (request.method() == boost::beast::http::verb::get) {
    co_return co_await HandleGet(connection, context, *target, request);
  }
  const MethodRoute* method = context.contract->Find(target->path);
  if (request.method() == boost::beast::http::verb::post && method != nullptr) {
    co_return co_await HandleConnect(connection, context, *method, request);
  }
  const int status = request.method() == boost::beast::http::verb::post ? 404 : 405;
  const ConnectError error = {
      absl::StatusCode::kUnimplemented, absl::StrCat("there is no method ", target->path), {}};
  const HeaderList headers = {RequestIdOf(request), {"allow", "GET, POST"}};
  co_return co_await WriteErrorAs(status, connection, error, headers, request.keep_alive()) &&
      request.keep_alive();
}

absl::StatusOr<std::unique_ptr<asio::ssl::context>> MakeSecurity(
    const rpc::ChannelSecurity& security) {
  if (security.certificate.empty()) return nullptr;
  auto context = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_server);
  context->set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_sslv2 |
                       asio::ssl::context::no_sslv3 | asio::ssl::context::no_tlsv1 |
                       asio::ssl::context::no_tlsv1_1);
  error_code error;
  context->use_certificate_chain_file(security.certificate.string(), error);
  if (error) return InvalidField("tls-certificate", error.message());
  context->use_private_key_file(security.key.string(), asio::ssl::context::pem, error);
  if (error) return InvalidField("tls-key", error.message());
  return context;
}

absl::StatusOr<tcp::endpoint> ParseEndpoint(const std::string& listen) {
  const auto colon = listen.rfind(':');
  uint32_t port = 0;
  if (colon == std::string::npos || !absl::SimpleAtoi(listen.substr(colon + 1), &port) ||
      port > 65535) {
    return InvalidField("http", "must have the form HOST:PORT");
  }
  std::string host = listen.substr(0, colon);
  if (host == "localhost") host = "127.0.0.1";
  if (host.size() > 2 && host.front() == '[') host = host.substr(1, host.size() - 2);
  error_code error;
  const auto address = asio::ip::make_address(host, error);
  if (error) return InvalidField("http", absl::StrCat(host, " is not an IP address"));
  return tcp::endpoint(address, static_cast<uint16_t>(port));
}

class Door final : public HttpDoor {
 public:
  Door(const HttpDoorOptions& options, std::shared_ptr<const HttpContext> context,
       std::unique_ptr<asio::ssl::context> security)
      : options_(options), context_(std::move(context)), security_(std::move(security)) {}

  ~Door() override {
    BeginDrain();
    {
      std::unique_lock lock(mutex_);
      for (const auto& connection : connections_) connection->Close();
      // A connection may hold a call that is being cancelled; it is over in moments.
      changed_.wait_for(lock, std::chrono::seconds(10), [this] { return connections_.empty(); });
    }
    io_.stop();
    for (std::thread& thread : threads_) thread.join();
  }

  absl::Status Listen() {
    MORTISE_ASSIGN_OR_RETURN(const tcp::endpoint endpoint, ParseEndpoint(options_.listen));
    error_code error;
    acceptor_.open(endpoint.protocol(), error);
    if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);
    if (!error) acceptor_.bind(endpoint, error);
    if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
    if (error) {
      return WithDetail(absl::UnavailableError(absl::StrCat("cannot listen on ", options_.listen,
                                                            ": ", error.message())),
                        {"ADDRESS_IN_USE", options_.listen});
    }
    const tcp::endpoint bound = acceptor_.local_endpoint();
    address_ =
        absl::StrCat(options_.listen.substr(0, options_.listen.rfind(':')), ":", bound.port());
    asio::co_spawn(
        io_, [this] { return Accept(); }, asio::detached);
    for (int i = 0; i < options_.threads; ++i) {
      threads_.emplace_back([this] { io_.run(); });
    }
    return absl::OkStatus();
  }

  void BeginDrain() override {
    draining_ = true;
    asio::post(acceptor_.get_executor(), [this] {
      error_code ignored;
      acceptor_.close(ignored);
    });
  }

  const std::string& address() const override { return address_; }

 private:
  asio::awaitable<void> Accept() {
    while (!draining_) {
      error_code error;
      tcp::socket socket(asio::make_strand(io_));
      co_await acceptor_.async_accept(socket, asio::redirect_error(asio::use_awaitable, error));
      if (draining_) co_return;
      if (error) {
        // Out of descriptors, most likely: what is open goes on, new ones wait a little.
        asio::steady_timer pause(io_, std::chrono::milliseconds(50));
        co_await pause.async_wait(asio::redirect_error(asio::use_awaitable, error));
        continue;
      }
      auto executor = socket.get_executor();
      auto connection = MakeHttpConnection(std::move(socket), security_.get());
      if (!Enter(connection)) continue;
      asio::co_spawn(
          executor, [this, connection] { return Serve(connection); },
          [this, connection](const std::exception_ptr& failure) {
            Leave(connection);
            if (failure) Log(LogLevel::kWarning, "an HTTP connection ended by an exception");
          });
    }
  }

  asio::awaitable<void> Serve(std::shared_ptr<HttpConnection> connection) {
    bool open = co_await connection->Open();
    while (open && !draining_) {
      HttpRequest request;
      switch (co_await connection->Read(request)) {
        case HttpReadResult::kRequest:
          open = co_await HandleRequest(*connection, *context_, request);
          break;
        case HttpReadResult::kTooLarge:
          co_await RefuseTooLarge(*connection, request);
          co_await connection->Discard();
          open = false;
          break;
        case HttpReadResult::kMalformed:
          co_await WritePlain(*connection, 400, "text/plain", "this is not HTTP/1.1\n", false);
          open = false;
          break;
        case HttpReadResult::kClosed:
          open = false;
          break;
      }
    }
    connection->Close();
  }

  bool Enter(const std::shared_ptr<HttpConnection>& connection) {
    std::lock_guard lock(mutex_);
    if (static_cast<int>(connections_.size()) >= options_.max_connections) return false;
    connections_.insert(connection);
    return true;
  }

  void Leave(const std::shared_ptr<HttpConnection>& connection) {
    std::lock_guard lock(mutex_);
    connections_.erase(connection);
    changed_.notify_all();
  }

  const HttpDoorOptions options_;
  const std::shared_ptr<const HttpContext> context_;
  const std::unique_ptr<asio::ssl::context> security_;
  asio::io_context io_;
  tcp::acceptor acceptor_{asio::make_strand(io_)};
  std::string address_;
  std::atomic<bool> draining_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::shared_ptr<HttpConnection>> connections_;  // guarded by mutex_
  std::vector<std::thread> threads_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<HttpDoor>> HttpDoor::Start(
    const HttpDoorOptions& options, std::shared_ptr<const HttpContext> context) {
  MORTISE_ASSIGN_OR_RETURN(auto security, MakeSecurity(options.security));
  auto door = std::make_unique<Door>(options, std::move(context), std::move(security));
  MORTISE_RETURN_IF_ERROR(door->Listen());
  return std::unique_ptr<HttpDoor>(std::move(door));
}

}  // namespace mortise::gateway
