// Connections up to a limit, recovery after the system had no descriptors, and the truth about
// both.
#include "common/rpc/connections/connection_acceptor.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <condition_variable>
#include <mutex>
#include <string>
#include <vector>

#include "common/base/errors.h"
#include "common/rpc/connections/connection_places.h"
#include "common/rpc/connections/listening_socket.h"
#include "tests/support/status_assertions.h"

namespace mortise::testing {
namespace {

using rpc::ConnectionAcceptor;
using rpc::Descriptor;
using ::testing::HasSubstr;

// A client's socket, connected to 127.0.0.1.
class Client {
 public:
  explicit Client(const std::string& address) {
    rpc::SocketAddress loopback;
    auto* four = reinterpret_cast<sockaddr_in*>(loopback.get());
    four->sin_family = AF_INET;
    four->sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    loopback.size = sizeof(sockaddr_in);
    loopback.set_port(std::stoi(address.substr(address.rfind(':') + 1)));
    socket_ = Descriptor(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    connected_ = connect(socket_.number(), loopback.get(), loopback.size) == 0;
  }

  bool connected() const { return connected_; }
  void Speak() { (void)send(socket_.number(), "x", 1, MSG_NOSIGNAL); }

  // Whether the server closes the connection, within ten seconds.
  bool IsClosed() {
    pollfd wait = {socket_.number(), POLLIN, 0};
    char byte = 0;
    return poll(&wait, 1, 10000) == 1 && recv(socket_.number(), &byte, 1, 0) <= 0;
  }

 private:
  Descriptor socket_;
  bool connected_ = false;
};

class ConnectionAcceptorTest : public ::testing::Test {
 protected:
  void Start(rpc::AcceptorOptions options) {
    options.take = [this](int descriptor) {
      std::lock_guard lock(mutex_);
      taken_.emplace_back(descriptor);
      changed_.notify_all();
    };
    auto started = ConnectionAcceptor::Start(std::move(options));
    ASSERT_OK(started);
    acceptor_ = *std::move(started);
  }

  // Waits until so many connections have been taken in all.
  bool WaitForTaken(std::size_t count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(10),
                             [&] { return taken_.size() >= count; });
  }

  void CloseFirstTaken() {
    std::lock_guard lock(mutex_);
    Descriptor closed = std::move(taken_.front());
    taken_.front() = Descriptor();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<Descriptor> taken_;                 // guarded by mutex_
  std::unique_ptr<ConnectionAcceptor> acceptor_;  // ends first: its thread uses the others
};

TEST_F(ConnectionAcceptorTest, TakesWhoeverSpeaks) {
  Start({});
  Client first(acceptor_->address());
  Client second(acceptor_->address());
  second.Speak();
  ASSERT_TRUE(WaitForTaken(1));
  first.Speak();
  EXPECT_TRUE(WaitForTaken(2));
  EXPECT_OK(acceptor_->Probe());
}

TEST_F(ConnectionAcceptorTest, ListensOnEveryAddress) {
  for (const char* listen : {"0.0.0.0:0", "[::]:0", "localhost:0"}) {
    Start({.listen = listen});
    Client client(acceptor_->address());
    EXPECT_TRUE(client.connected()) << listen;
    EXPECT_OK(acceptor_->Probe()) << listen;
  }
}

TEST_F(ConnectionAcceptorTest, RefusesMoreThanItHasPlacesFor) {
  Start({.most_connections = 2});
  Client first(acceptor_->address());
  first.Speak();
  Client second(acceptor_->address());
  second.Speak();
  ASSERT_TRUE(WaitForTaken(2));
  Client third(acceptor_->address());
  EXPECT_TRUE(third.IsClosed());
  EXPECT_THAT(std::string(acceptor_->Probe().message()), HasSubstr("2 at a time"));

  // A place is free as soon as its connection is closed, by whomever it was given to.
  CloseFirstTaken();
  EXPECT_OK(acceptor_->Probe());
  Client fourth(acceptor_->address());
  fourth.Speak();
  EXPECT_TRUE(WaitForTaken(3));
}

TEST_F(ConnectionAcceptorTest, WhoSaysNothingMakesRoom) {
  Start({.most_connections = 2});
  Client silent(acceptor_->address());
  Client also_silent(acceptor_->address());
  Client speaking(acceptor_->address());
  speaking.Speak();
  EXPECT_TRUE(WaitForTaken(1));
  EXPECT_TRUE(silent.IsClosed()) << "the longest silent goes first";
  EXPECT_OK(acceptor_->Probe());
}

TEST_F(ConnectionAcceptorTest, ClosesWhoSaysNothingForLong) {
  Start({.silence = absl::Milliseconds(50)});
  Client silent(acceptor_->address());
  EXPECT_TRUE(silent.IsClosed());
}

TEST_F(ConnectionAcceptorTest, AsksForRoomAmongThoseItGaveAway) {
  Start({.most_connections = 1,
         .has_idle = [] { return true; },
         .close_idle =
             [this] {
               CloseFirstTaken();
               return true;
             }});
  Client idle(acceptor_->address());
  idle.Speak();
  ASSERT_TRUE(WaitForTaken(1));
  EXPECT_OK(acceptor_->Probe());
  Client next(acceptor_->address());
  next.Speak();
  EXPECT_TRUE(WaitForTaken(2));
  EXPECT_TRUE(idle.IsClosed());
}

// Opens files until the system has no more for this process. The limit is lowered for it.
class NoDescriptors {
 public:
  NoDescriptors() {
    getrlimit(RLIMIT_NOFILE, &before_);
    rlimit few = before_;
    few.rlim_cur = 256;
    setrlimit(RLIMIT_NOFILE, &few);
    for (int file; (file = open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0;) {
      files_.emplace_back(file);
    }
  }
  ~NoDescriptors() { setrlimit(RLIMIT_NOFILE, &before_); }
  void GiveBackOne() { files_.pop_back(); }

 private:
  rlimit before_ = {};
  std::vector<Descriptor> files_;
};

TEST_F(ConnectionAcceptorTest, GoesOnAfterTheSystemHadNoDescriptors) {
  Start({});
  {
    NoDescriptors none;
    EXPECT_FALSE(acceptor_->Probe().ok());
    none.GiveBackOne();
    Client client(acceptor_->address());
    EXPECT_TRUE(client.connected()) << "the system connects, and nobody accepts";
    EXPECT_FALSE(acceptor_->Probe().ok());
  }
  EXPECT_OK(acceptor_->Probe());
  Client client(acceptor_->address());
  client.Speak();
  EXPECT_TRUE(WaitForTaken(1));
}

TEST_F(ConnectionAcceptorTest, EndsWhileOthersWait) {
  Start({});
  Client silent(acceptor_->address());
  EXPECT_OK(acceptor_->Probe()) << "comes after the other, which is accepted by then";
  acceptor_->Stop();
  EXPECT_TRUE(silent.IsClosed());
  EXPECT_FALSE(Client(acceptor_->address()).connected());
}

TEST(ConnectionAcceptor, NamesAnAddressThatIsTaken) {
  const auto first = ConnectionAcceptor::Start({.take = [](int) {}});
  ASSERT_OK(first);
  const auto second =
      ConnectionAcceptor::Start({.listen = (*first)->address(), .take = [](int) {}});
  EXPECT_EQ(DetailOf(second.status()).reason, "ADDRESS_IN_USE");
  EXPECT_EQ(DetailOf(second.status()).field, (*first)->address());
  for (const char* bad : {"", "localhost", "localhost:port", "localhost:70000"}) {
    EXPECT_FALSE(ConnectionAcceptor::Start({.listen = bad, .take = [](int) {}}).ok()) << bad;
  }
}

rpc::SocketAddress AddressOf(const std::string& text) {
  rpc::SocketAddress address;
  auto* six = reinterpret_cast<sockaddr_in6*>(address.get());
  auto* four = reinterpret_cast<sockaddr_in*>(address.get());
  address.size = sizeof(sockaddr_in6);
  if (inet_pton(AF_INET6, text.c_str(), &six->sin6_addr) == 1) {
    six->sin6_family = AF_INET6;
  } else {
    four->sin_family = AF_INET;
    EXPECT_EQ(inet_pton(AF_INET, text.c_str(), &four->sin_addr), 1) << text;
  }
  address.set_port(4711);
  return address;
}

TEST(ConnectionPlaces, LeavesHalfToOtherAddresses) {
  const auto half_after_two = [](const std::string& of, const std::string& asking) {
    rpc::ConnectionPlaces places(4);
    std::vector<Descriptor> sockets;
    for (int i = 0; i < 2; ++i) {
      EXPECT_FALSE(places.HasHalf(AddressOf(asking)));
      sockets.emplace_back(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
      places.Enter(sockets.back().number(), AddressOf(of));
    }
    const bool half = places.HasHalf(AddressOf(asking));
    sockets.clear();
    EXPECT_FALSE(places.HasHalf(AddressOf(asking))) << "places are left with the connection";
    return half;
  };
  EXPECT_TRUE(half_after_two("192.0.2.1", "192.0.2.1"));
  EXPECT_TRUE(half_after_two("::ffff:192.0.2.1", "192.0.2.1")) << "however it is written";
  EXPECT_TRUE(half_after_two("2001:db8::1", "2001:db8::2")) << "of one network";
  EXPECT_FALSE(half_after_two("192.0.2.1", "192.0.2.2"));
  EXPECT_FALSE(half_after_two("2001:db8:0:1::1", "2001:db8:0:2::1"));
  for (const char* own : {"127.0.0.1", "::1", "::ffff:127.0.0.1", "127.1.2.3"}) {
    EXPECT_FALSE(half_after_two(own, own)) << own;
  }
}

// What an earlier call of the system failed for says nothing of this address.
TEST(ListenOn, TakesNoNoteOfEarlierFailures) {
  errno = EADDRINUSE;
  const auto sockets = rpc::ListenOn("127.0.0.1:0");
  EXPECT_TRUE(sockets.ok()) << sockets.status();
}

}  // namespace
}  // namespace mortise::testing
