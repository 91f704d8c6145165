#include "common/rpc/connections/connection_acceptor.h"

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/posix/stream_descriptor.hpp>
#include <boost/asio/steady_timer.hpp>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <list>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/descriptor_limit.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/rpc/connections/connection_places.h"
#include "common/rpc/connections/listening_socket.h"

namespace mortise::rpc {
namespace {

namespace asio = boost::asio;
using asio::posix::stream_descriptor;
using boost::system::error_code;

// After the system refused a descriptor: those who hold them need time to close some.
constexpr std::chrono::milliseconds kPause(50);
constexpr std::chrono::seconds kPatienceOfProbe(2);
constexpr absl::Duration kLogInterval = absl::Minutes(1);
constexpr int kAcceptedAtOnce = 64;

int MostConnections(int wanted) {
  return wanted > 0 ? wanted : std::min(kMaxConnections, ConnectionsWithin(DescriptorLimit()));
}

// One probe under way, found again by the address it comes from.
struct Expected {
  SocketAddress from;
  bool arrived = false;
  absl::Status status;
};

// A connection that has not spoken yet.
struct Silent {
  Silent(asio::io_context& io, int descriptor) : stream(io, descriptor), timer(io) {}
  stream_descriptor stream;
  asio::steady_timer timer;
  bool waits = true;  // until it has spoken or was closed
};

// All but Probe and Stop runs on the one thread.
class Acceptor final : public ConnectionAcceptor {
 public:
  explicit Acceptor(AcceptorOptions options)
      : options_(std::move(options)), places_(MostConnections(options_.most_connections)) {}

  ~Acceptor() override { Stop(); }

  absl::Status Listen() {
    MORTISE_ASSIGN_OR_RETURN(std::vector<ListeningSocket> sockets, ListenOn(options_.listen));
    const std::string host = options_.listen.substr(0, options_.listen.rfind(':'));
    address_ = absl::StrCat(host, ":", sockets.front().address.port());
    first_ = sockets.front().address;
    for (ListeningSocket& socket : sockets) {
      listeners_.push_back(std::make_unique<stream_descriptor>(io_, socket.descriptor.Release()));
      Await(*listeners_.back());
    }
    thread_ = std::thread([this] { io_.run(); });
    return absl::OkStatus();
  }

  void Stop() override {
    std::call_once(stopped_, [this] {
      io_.stop();
      if (thread_.joinable()) thread_.join();
      // What waits for them keeps them open until the end; their clients need not wait for that.
      for (const std::shared_ptr<Silent>& silent : silent_) {
        shutdown(silent->stream.native_handle(), SHUT_RDWR);
      }
      silent_.clear();
      listeners_.clear();
    });
  }

  absl::Status Probe() override {
    MORTISE_ASSIGN_OR_RETURN(const ConnectingSocket probe, MakeConnectingSocket(first_));
    const auto expected = std::make_shared<Expected>();
    expected->from = probe.own;
    std::unique_lock lock(mutex_);
    expected_.push_back(expected);
    // It does not block; whether it comes to anything is told by the other side.
    (void)connect(probe.descriptor.number(), probe.peer.get(), probe.peer.size);
    arrived_.wait_for(lock, kPatienceOfProbe, [&] { return expected->arrived; });
    std::erase(expected_, expected);
    if (!expected->arrived) {
      return absl::UnavailableError(absl::StrCat(address_, " accepts no connections"));
    }
    return expected->status;
  }

  const std::string& address() const override { return address_; }

 private:
  void Await(stream_descriptor& listener) {
    listener.async_wait(stream_descriptor::wait_read, [this, &listener](const error_code& error) {
      if (error == asio::error::operation_aborted) return;
      if (AcceptSome(listener)) return Await(listener);
      auto pause = std::make_shared<asio::steady_timer>(io_, kPause);
      pause->async_wait([this, &listener, pause](const error_code&) { Await(listener); });
    });
  }

  // False if the system has nothing to give.
  bool AcceptSome(stream_descriptor& listener) {
    for (int i = 0; i < kAcceptedAtOnce; ++i) {
      SocketAddress from;
      Descriptor socket(
          accept4(listener.native_handle(), from.get(), &from.size, SOCK_NONBLOCK | SOCK_CLOEXEC));
      if (socket.number() >= 0) {
        Receive(std::move(socket), from);
        continue;
      }
      if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS || errno == ENOMEM) {
        Tell("no connections can be accepted", std::strerror(errno));
        return false;
      }
      if (errno == EAGAIN || errno == EWOULDBLOCK) return true;
      // The client left before it was accepted; the next connection is another's.
    }
    return true;
  }

  void Receive(Descriptor socket, const SocketAddress& from) {
    if (IsProbe(socket, from)) return;
    if (!MakeRoom(socket)) {
      return Tell("connections are refused",
                  absl::StrCat("all ", places_.most(), " of ", address_, " are taken"));
    }
    const int yes = 1;
    setsockopt(socket.number(), IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    pollfd spoken = {socket.number(), POLLIN, 0};
    if (poll(&spoken, 1, 0) == 1) return Give(std::move(socket), from);
    AwaitFirstWord(std::move(socket), from);
  }

  bool IsProbe(const Descriptor& socket, const SocketAddress& from) {
    std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(expected_.begin(), expected_.end(),
                     [&](const std::shared_ptr<Expected>& one) { return one->from == from; });
    if (found == expected_.end()) return false;
    (*found)->arrived = true;
    const bool full = places_.Full(0) || IsAmongTheLast(socket.number());
    if (full && silent_.empty() && !(options_.has_idle && options_.has_idle())) {
      (*found)->status = absl::UnavailableError(
          absl::StrCat(address_, " takes no more connections: ", places_.most(), " at a time"));
    }
    arrived_.notify_all();
    return true;
  }

  // False if every place is taken by connections at work.
  bool MakeRoom(const Descriptor& socket) {
    const bool full = places_.Full(static_cast<int>(silent_.size()));
    if (!full && !IsAmongTheLast(socket.number())) return true;
    if (!silent_.empty()) {
      Close(*silent_.front());
      silent_.pop_front();
      return true;
    }
    return options_.close_idle && options_.close_idle();
  }

  void AwaitFirstWord(Descriptor socket, const SocketAddress& from) {
    const auto silent = std::make_shared<Silent>(io_, socket.Release());
    const auto place = silent_.insert(silent_.end(), silent);
    silent->stream.async_wait(stream_descriptor::wait_read,
                              [this, place, silent, from](const error_code& error) {
                                if (error || !silent->waits) return;
                                Descriptor spoken(silent->stream.release());
                                Close(*silent);
                                silent_.erase(place);
                                Give(std::move(spoken), from);
                              });
    silent->timer.expires_after(absl::ToChronoNanoseconds(options_.silence));
    silent->timer.async_wait([this, place, silent](const error_code& error) {
      if (error || !silent->waits) return;
      Close(*silent);
      silent_.erase(place);
    });
  }

  // What it waits for is told to be over; the socket is closed unless it was released.
  static void Close(Silent& silent) {
    error_code ignored;
    silent.waits = false;
    silent.timer.cancel();
    silent.stream.close(ignored);
  }

  void Give(Descriptor socket, const SocketAddress& from) {
    if (options_.shares_places && places_.HasHalf(from)) {
      return Tell("connections are refused",
                  absl::StrCat("one address has half of the ", places_.most(), " of ", address_));
    }
    places_.Enter(socket.number(), from);
    options_.take(socket.Release());
  }

  // Says so once a minute: who connects again and again shall not fill the log.
  void Tell(const char* what, const std::string& why) {
    const absl::Time now = absl::Now();
    if (now < told_ + kLogInterval) return;
    told_ = now;
    Log(LogLevel::kWarning, what, {{"address", address_}, {"why", why}});
  }

  const AcceptorOptions options_;
  asio::io_context io_{1};
  std::vector<std::unique_ptr<stream_descriptor>> listeners_;
  std::list<std::shared_ptr<Silent>> silent_;  // the longest silent first
  ConnectionPlaces places_;
  absl::Time told_ = absl::InfinitePast();
  SocketAddress first_;
  std::string address_;
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::vector<std::shared_ptr<Expected>> expected_;  // guarded by mutex_
  std::once_flag stopped_;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ConnectionAcceptor>> ConnectionAcceptor::Start(
    AcceptorOptions options) {
  auto acceptor = std::make_unique<Acceptor>(std::move(options));
  MORTISE_RETURN_IF_ERROR(acceptor->Listen());
  return std::unique_ptr<ConnectionAcceptor>(std::move(acceptor));
}

}  // namespace mortise::rpc
