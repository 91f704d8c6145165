// Who may connect, in plain and in CURVE.
#include "common/bus/security.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <string>

#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/bus/broker.h"
#include "common/bus/publisher.h"
#include "common/bus/subscriber.h"
#include "tests/support/status_assertions.h"

namespace mortise::bus {
namespace {

TEST(Security, OnlyLoopbackIsLoopback) {
  for (const char* endpoint : {"tcp://127.0.0.1:5555", "tcp://127.1.2.3:*", "tcp://localhost:1",
                               "tcp://[::1]:1", "ipc:///tmp/x", "inproc://x"}) {
    EXPECT_TRUE(IsLoopback(endpoint)) << endpoint;
  }
  for (const char* endpoint : {"tcp://0.0.0.0:5555", "tcp://*:5555", "tcp://10.0.0.1:1", "tcp://",
                               "tcp://127.example.com:1", "tcp://[::]:1", "", "udp://127.0.0.1:1",
                               "tcp://localhost.example.com:1", "tcp://127.0.0.1"}) {
    EXPECT_FALSE(IsLoopback(endpoint)) << endpoint;
  }
}

TEST(Security, PlainTextStaysOnThisMachine) {
  const absl::Status broker = Broker::Start({.publisher_endpoint = "tcp://0.0.0.0:*"}).status();
  EXPECT_EQ(broker.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(broker).field, "endpoint");
  EXPECT_FALSE(Publisher::Connect({.endpoint = "tcp://192.0.2.1:5555"}).ok());
  EXPECT_FALSE(Subscriber::Connect({.endpoint = "tcp://192.0.2.1:5555"}).ok());
}

TEST(Security, MalformedKeysAreNamed) {
  const CurveKeyPair keys = NewCurveKeyPair().value();
  const CurveKeyPair other = NewCurveKeyPair().value();
  const auto field = [](const absl::Status& status) { return DetailOf(status).field; };
  BrokerSecurity broker{.keys = keys, .allowed_clients = {other.public_key, "short"}};
  EXPECT_EQ(field(CheckSecurity(broker, {})), "security.allowed_clients[1]");
  broker.allowed_clients.pop_back();
  EXPECT_OK(CheckSecurity(broker, {"tcp://0.0.0.0:*"}));
  broker.keys->public_key = other.public_key;
  EXPECT_EQ(field(CheckSecurity(broker, {})), "security.keys.public_key");
  ClientSecurity client{.keys = keys};
  EXPECT_EQ(field(CheckSecurity(client, "tcp://10.0.0.1:1")), "security.broker_key");
  client.broker_key = other.public_key;
  EXPECT_OK(CheckSecurity(client, "tcp://10.0.0.1:1"));
  client.keys->secret_key = "nonsense";
  EXPECT_EQ(field(CheckSecurity(client, "tcp://10.0.0.1:1")), "security.keys.secret_key");
}

// Whether the other end closes a connection to `endpoint`, tcp://127.0.0.1:PORT, that says nothing,
// within ten seconds; ZeroMQ by itself takes thirty.
bool IsClosedInSilence(const std::string& endpoint) {
  const int silent = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port =
      htons(static_cast<std::uint16_t>(std::stoi(endpoint.substr(endpoint.rfind(':') + 1))));
  const timeval patience = {10, 0};
  ::setsockopt(silent, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  const bool connected =
      ::connect(silent, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  std::array<char, 256> greeting;
  ssize_t size = connected ? 1 : -1;
  while (size > 0) size = ::recv(silent, greeting.data(), greeting.size(), 0);
  const bool closed = connected && (size == 0 || errno == ECONNRESET);
  ::close(silent);
  return closed;
}

TEST(Security, ConnectionsThatSayNothingAreClosed) {
  const auto broker = Broker::Start({.handshake_time = absl::Milliseconds(50)});
  ASSERT_OK(broker);
  EXPECT_TRUE(IsClosedInSilence((*broker)->publisher_endpoint()));
  EXPECT_TRUE(IsClosedInSilence((*broker)->subscriber_endpoint()));
}

TEST(Security, AnEndpointInUseIsUnavailable) {
  auto first = Broker::Start({});
  ASSERT_OK(first);
  const absl::Status second =
      Broker::Start({.publisher_endpoint = (*first)->publisher_endpoint()}).status();
  EXPECT_EQ(second.code(), absl::StatusCode::kUnavailable);
}

// Those on the list hear and are heard; a stranger with keys of its own neither, and nor does one
// in plain text.
TEST(Security, CurveAdmitsTheAllowListOnly) {
  const CurveKeyPair broker_keys = NewCurveKeyPair().value();
  const CurveKeyPair friend_keys = NewCurveKeyPair().value();
  const CurveKeyPair stranger_keys = NewCurveKeyPair().value();
  auto broker = Broker::Start(
      {.security = {.keys = broker_keys, .allowed_clients = {friend_keys.public_key}}});
  ASSERT_OK(broker);
  const ClientSecurity as_friend{.keys = friend_keys, .broker_key = broker_keys.public_key};
  const ClientSecurity as_stranger{.keys = stranger_keys, .broker_key = broker_keys.public_key};
  const std::string in = (*broker)->publisher_endpoint();
  const std::string out = (*broker)->subscriber_endpoint();
  auto good_publisher = Publisher::Connect({.endpoint = in, .security = as_friend}).value();
  auto bad_publisher = Publisher::Connect({.endpoint = in, .security = as_stranger}).value();
  auto plain_publisher = Publisher::Connect({.endpoint = in}).value();
  auto good = Subscriber::Connect({.endpoint = out, .security = as_friend, .topics = {""}}).value();
  auto bad =
      Subscriber::Connect({.endpoint = out, .security = as_stranger, .topics = {""}}).value();
  auto plain = Subscriber::Connect({.endpoint = out, .topics = {""}}).value();

  const absl::Time deadline = absl::Now() + absl::Seconds(30);
  int heard = 0;
  while (heard < 20 && absl::Now() < deadline) {
    EXPECT_OK(good_publisher->Publish(Heartbeat{.stream = "good"}));
    EXPECT_OK(bad_publisher->Publish(Heartbeat{.stream = "bad"}));
    EXPECT_OK(plain_publisher->Publish(Heartbeat{.stream = "plain"}));
    const auto message = good->Receive(absl::Milliseconds(20));
    ASSERT_OK(message);
    if (!message->has_value()) continue;
    EXPECT_EQ((*message)->heartbeat.stream, "good");
    ++heard;
  }
  EXPECT_EQ(heard, 20);
  EXPECT_FALSE(bad->Receive(absl::ZeroDuration())->has_value());
  EXPECT_FALSE(plain->Receive(absl::ZeroDuration())->has_value());
}

}  // namespace
}  // namespace mortise::bus
