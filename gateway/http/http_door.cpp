#include "gateway/http/http_door.h"

#include <sys/socket.h>

#include <atomic>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/strand.hpp>
#include <condition_variable>
#include <list>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/rpc/connections/connection_acceptor.h"
#include "gateway/http/http_context.h"
#include "gateway/http/http_routes.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

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

tcp ProtocolOf(int descriptor) {
  sockaddr_storage own = {};
  socklen_t size = sizeof(own);
  getsockname(descriptor, reinterpret_cast<sockaddr*>(&own), &size);
  return own.ss_family == AF_INET6 ? tcp::v6() : tcp::v4();
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
    rpc::AcceptorOptions acceptor;
    acceptor.listen = options_.listen;
    acceptor.most_connections = options_.most_connections;
    acceptor.take = [this](int descriptor) { Take(descriptor); };
    acceptor.has_idle = [this] {
      std::lock_guard lock(mutex_);
      return !idle_.empty();
    };
    acceptor.close_idle = [this] { return CloseLongestIdle(); };
    MORTISE_ASSIGN_OR_RETURN(acceptor_, rpc::ConnectionAcceptor::Start(std::move(acceptor)));
    for (int i = 0; i < options_.threads; ++i) {
      threads_.emplace_back([this] { io_.run(); });
    }
    return absl::OkStatus();
  }

  void BeginDrain() override {
    draining_ = true;
    if (acceptor_) acceptor_->Stop();
  }

  absl::Status Probe() override { return acceptor_->Probe(); }

  const std::string& address() const override { return acceptor_->address(); }

 private:
  void Take(int descriptor) {
    tcp::socket socket(asio::make_strand(io_), ProtocolOf(descriptor), descriptor);
    auto executor = socket.get_executor();
    auto connection = MakeHttpConnection(std::move(socket), security_.get(), options_.patience);
    Enter(connection);
    asio::co_spawn(
        executor, [this, connection] { return Serve(connection); },
        [this, connection](const std::exception_ptr& failure) {
          Leave(connection);
          if (failure) Log(LogLevel::kWarning, "an HTTP connection ended by an exception");
        });
  }

  asio::awaitable<void> Serve(std::shared_ptr<HttpConnection> connection) {
    bool open = co_await connection->Open();
    while (open && !draining_) {
      BeginIdle(connection);
      open = co_await connection->AwaitRequest();
      EndIdle(connection);
      if (open) open = co_await ServeRequest(*connection);
    }
    connection->Close();
  }

  // False if the connection must be closed.
  asio::awaitable<bool> ServeRequest(HttpConnection& connection) {
    HttpRequest request;
    const HttpReadResult head = co_await connection.ReadHead(request);
    if (head == HttpReadResult::kClosed) co_return false;
    if (head != HttpReadResult::kRead) {
      co_await RefuseHead(connection, head);
      co_await connection.Discard();
      co_return false;
    }
    const bool open = co_await HandleRequest(connection, *context_, request);
    if (co_await connection.DropBody()) co_return open;
    co_await connection.Discard();
    co_return false;
  }

  void Enter(const std::shared_ptr<HttpConnection>& connection) {
    std::lock_guard lock(mutex_);
    connections_.insert(connection);
  }

  void Leave(const std::shared_ptr<HttpConnection>& connection) {
    std::lock_guard lock(mutex_);
    connections_.erase(connection);
    changed_.notify_all();
  }

  void BeginIdle(const std::shared_ptr<HttpConnection>& connection) {
    std::lock_guard lock(mutex_);
    idle_.push_back(connection);
  }

  void EndIdle(const std::shared_ptr<HttpConnection>& connection) {
    std::lock_guard lock(mutex_);
    idle_.remove(connection);
  }

  // False if none is idle.
  bool CloseLongestIdle() {
    std::lock_guard lock(mutex_);
    if (idle_.empty()) return false;
    idle_.front()->Close();
    idle_.pop_front();
    return true;
  }

  const HttpDoorOptions options_;
  const std::shared_ptr<const HttpContext> context_;
  const std::unique_ptr<asio::ssl::context> security_;
  asio::io_context io_;
  const asio::executor_work_guard<asio::io_context::executor_type> work_{io_.get_executor()};
  std::unique_ptr<rpc::ConnectionAcceptor> acceptor_;
  std::atomic<bool> draining_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::shared_ptr<HttpConnection>> connections_;  // guarded by mutex_
  std::list<std::shared_ptr<HttpConnection>> idle_;  // the longest idle first; guarded by mutex_
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
