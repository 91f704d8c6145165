// Addresses that webhooks may call, receivers that behave badly, and signatures.
#include "gateway/webhooks/webhook_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ifaddrs.h>
#include <netinet/in.h>

#include <algorithm>
#include <atomic>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>
#include <functional>
#include <future>
#include <iterator>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "tests/unit/gateway/webhooks/name_server.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;

TEST(WebhookUrl, TakesHttpAndHttps) {
  const auto plain = ParseWebhookUrl("http://plm.example/hook?x=1#part");
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_FALSE(plain->secure);
  EXPECT_EQ(plain->host, "plm.example");
  EXPECT_EQ(plain->port, "80");
  EXPECT_EQ(plain->target, "/hook?x=1");
  const auto secure = ParseWebhookUrl("https://[2001:db8::1]:8443");
  ASSERT_TRUE(secure.ok()) << secure.status();
  EXPECT_TRUE(secure->secure);
  EXPECT_EQ(secure->host, "2001:db8::1");
  EXPECT_EQ(secure->port, "8443");
  EXPECT_EQ(secure->target, "/");
  EXPECT_EQ(ParseWebhookUrl("https://host?x")->target, "/?x");
}

TEST(WebhookUrl, RefusesOtherThings) {
  for (const std::string& bad : {std::string(),
                                 std::string("host"),
                                 std::string("ftp://host/"),
                                 std::string("file:///etc"),
                                 std::string("http://"),
                                 std::string("http:///path"),
                                 std::string("http://user:word@host/"),
                                 std::string("http://host:port/"),
                                 std::string("http://host:123456/"),
                                 std::string("http://host:65536/"),
                                 std::string("http://host:0/"),
                                 std::string("http://[::1"),
                                 std::string("http://[::1]x/"),
                                 std::string("http://ho st/"),
                                 std::string("http://host/\r\nX: y"),
                                 std::string("http://%31%32%37.0.0.1*/"),
                                 std::string("http://a,b/"),
                                 std::string("http://[fd00::2%1]/"),
                                 std::string("http://[fe80::1%eth0]/"),
                                 std::string("http://host%2ename/"),
                                 std::string("http://127.0.0.1\\x/"),
                                 "http://host/" + std::string(3000, 'a')}) {
    EXPECT_FALSE(ParseWebhookUrl(bad).ok()) << bad.substr(0, 40);
  }
}

TEST(WebhookAddress, RefusesWhatIsNobodysBusiness) {
  auto allowed = [](const char* text, bool loopback = false) {
    return IsAllowedAddress(boost::asio::ip::make_address(text), loopback);
  };
  EXPECT_TRUE(allowed("93.184.216.34"));
  EXPECT_TRUE(allowed("10.1.2.3"));
  EXPECT_TRUE(allowed("2001:db8::1"));
  for (const char* bad :
       {"127.0.0.1", "127.8.9.1", "::1", "0.0.0.0", "::", "169.254.169.254", "224.0.0.1",
        "255.255.255.255", "fe80::1", "ff02::1", "::ffff:169.254.169.254", "::ffff:127.0.0.1",
        "0.1.2.3",
        // spelled as IPv6 in the other ways there are
        "::127.0.0.1", "::169.254.169.254", "64:ff9b::127.0.0.1", "64:ff9b::a9fe:a9fe",
        "2002:7f00:1::", "2002:a9fe:a9fe::1",
        // where clouds keep credentials beside the link-local addresses
        "100.100.100.200", "192.0.0.192", "168.63.129.16", "fd00:ec2::254",
        // of a zone, which means something for link-local addresses only
        "::1%1", "::ffff:127.0.0.1%1", "64:ff9b::a9fe:a9fe%1", "fd00:ec2::254%1",
        // translated without state, and by a network's own NAT64, which puts the
        // IPv4 address into one of four places
        "::ffff:0:127.0.0.1", "::ffff:0:a9fe:a9fe", "64:ff9b:1::7f00:1", "64:ff9b:1::a9fe:a9fe",
        "64:ff9b:1:2:3:4:a9fe:a9fe", "64:ff9b:1:a9fe:a9:fe00::", "64:ff9b:1:1a9:fe:a9fe::",
        "64:ff9b:1:12:a9:fea9:fe00::", "64:ff9b:1::"}) {
    EXPECT_FALSE(allowed(bad)) << bad;
  }
  for (const char* translated : {"64:ff9b:1::5db8:d822", "64:ff9b:1:5db8:d8:2200::",
                                 "::ffff:0:93.184.216.34", "64:ff9b::93.184.216.34"}) {
    EXPECT_TRUE(allowed(translated)) << translated;
  }
  EXPECT_TRUE(allowed("127.0.0.1", true));
  EXPECT_TRUE(allowed("::ffff:127.0.0.1", true));
  EXPECT_FALSE(allowed("169.254.169.254", true));
}

TEST(WebhookAddress, RefusesTheAddressesOfThisMachine) {
  ifaddrs* first = nullptr;
  ASSERT_EQ(::getifaddrs(&first), 0);
  int found = 0;
  for (const ifaddrs* one = first; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr) continue;
    if (one->ifa_addr->sa_family == AF_INET6) {
      const auto& v6 = reinterpret_cast<const sockaddr_in6&>(*one->ifa_addr);
      boost::asio::ip::address_v6::bytes_type bytes;
      std::copy(std::begin(v6.sin6_addr.s6_addr), std::end(v6.sin6_addr.s6_addr), bytes.begin());
      for (const unsigned zone : {0u, 1u, 7u}) {
        const boost::asio::ip::address_v6 address(bytes, zone);
        EXPECT_FALSE(IsAllowedAddress(address, false)) << address;
      }
    }
    if (one->ifa_addr->sa_family != AF_INET) continue;
    const auto& v4 = reinterpret_cast<const sockaddr_in&>(*one->ifa_addr);
    const boost::asio::ip::address_v4 address(ntohl(v4.sin_addr.s_addr));
    const auto mapped = boost::asio::ip::make_address_v6(boost::asio::ip::v4_mapped, address);
    EXPECT_FALSE(IsAllowedAddress(address, false)) << address;
    EXPECT_FALSE(IsAllowedAddress(mapped, false)) << address;
    EXPECT_TRUE(IsAllowedAddress(address, true)) << address;
    ++found;
  }
  ::freeifaddrs(first);
  EXPECT_GT(found, 0) << "there is loopback at least";
}

TEST(WebhookAddress, IsReadInItsOlderSpellings) {
  for (const char* loopback : {"127.0.0.1", "127.1", "2130706433", "0x7f000001", "0177.0.0.1",
                               "0x7f.1", "127.0.0.1.", "017700000001"}) {
    const auto literal = LiteralAddress(loopback);
    ASSERT_TRUE(literal) << loopback;
    EXPECT_EQ(literal->to_string(), "127.0.0.1") << loopback;
  }
  EXPECT_EQ(LiteralAddress("fe80::1")->to_string(), "fe80::1");
  for (const char* name : {"localhost", "plm.example", "1.2.3.example", "256.1.1.1.1", ""}) {
    EXPECT_FALSE(LiteralAddress(name)) << name;
  }
}

class WebhookClientTest : public testing::Test {
 protected:
  void StartClient(WebhookClientOptions options = {}) {
    options.name_servers = name_server_.address();
    auto client = WebhookClient::Create(options);
    ASSERT_TRUE(client.ok()) << client.status();
    client_ = *std::move(client);
  }

  absl::Status Check(const std::string& url) { return client_->CheckHost(*ParseWebhookUrl(url)); }

  absl::Status Post(const std::string& text) {
    const WebhookUrl url = *ParseWebhookUrl(text);
    const HeaderList headers;
    const std::string body = "{}";
    const std::string authority;
    boost::asio::io_context io;
    std::future<absl::Status> posted = boost::asio::co_spawn(
        io, client_->Post(url, authority, headers, body), boost::asio::use_future);
    io.run();
    return posted.get();
  }

  NameServer name_server_;
  std::unique_ptr<WebhookClient> client_;
};

TEST_F(WebhookClientTest, RefusesHostsWhereDeliveriesWouldBe) {
  StartClient();
  name_server_.Say("here.example", {"127.0.0.1"});
  name_server_.Say("credentials.example", {"169.254.169.254", "127.0.0.2"});
  name_server_.Say("plm.example", {"127.0.0.1", "10.1.2.3"});
  name_server_.Say("unknown.example", {});
  for (const char* bad :
       {"http://127.0.0.1:9/hook", "https://[::1]/", "http://127.1/", "http://2130706433/",
        "http://0x7f000001/", "http://0177.0.0.1/", "http://169.254.169.254/latest/",
        "http://2852039166/", "http://0.0.0.0/", "http://0/", "http://[fe80::1]/", "http://[::]/",
        "http://[::ffff:127.0.0.1]/", "http://[64:ff9b::7f00:1]/", "http://224.0.0.1/",
        "http://127.0.0.1./", "http://here.example/", "http://credentials.example/"}) {
    const absl::Status status = Check(bad);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad;
    EXPECT_EQ(DetailOf(status).field, "url") << bad;
  }
  for (const char* good : {"https://192.0.2.1/hook", "http://10.1.2.3:8080/", "http://plm.example/",
                           "http://unknown.example/"}) {
    EXPECT_TRUE(Check(good).ok()) << good;
  }
  StartClient({.allow_loopback = true});
  EXPECT_TRUE(Check("http://127.0.0.1:9/hook").ok());
  EXPECT_FALSE(Check("http://169.254.169.254/latest/").ok());
}

// Takes connections on loopback, and does with each what the test says.
class RawReceiver {
 public:
  using Socket = boost::asio::ip::tcp::socket;

  explicit RawReceiver(std::function<void(Socket&)> serve)
      : acceptor_(io_, {boost::asio::ip::make_address("127.0.0.1"), 0}) {
    thread_ = std::thread([this, serve = std::move(serve)] {
      for (;;) {
        Socket socket(io_);
        acceptor_.accept(socket);
        if (stopping_) return;
        ++connections_;
        serve(socket);
      }
    });
  }

  ~RawReceiver() {
    stopping_ = true;
    boost::asio::io_context io;
    Socket socket(io);
    boost::system::error_code ignored;
    socket.connect(acceptor_.local_endpoint(), ignored);
    thread_.join();
  }

  std::string port() const { return std::to_string(acceptor_.local_endpoint().port()); }
  int connections() const { return connections_; }

 private:
  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::atomic<bool> stopping_{false};
  std::atomic<int> connections_{0};
  std::thread thread_;
};

// Reads until the peer closes.
void ReadAll(RawReceiver::Socket& socket) {
  boost::system::error_code error;
  char bytes[1024];
  while (!error) socket.read_some(boost::asio::buffer(bytes), error);
}

// Writes until the peer closes.
void WriteForEver(RawReceiver::Socket& socket, const std::string& text) {
  boost::system::error_code error;
  while (!error) boost::asio::write(socket, boost::asio::buffer(text), error);
}

TEST_F(WebhookClientTest, PostsByNameAndLooksAtTheAddressEachTime) {
  RawReceiver receiver([](RawReceiver::Socket& socket) {
    boost::system::error_code ignored;
    boost::asio::write(socket, boost::asio::buffer(std::string("HTTP/1.1 204 \r\n\r\n")), ignored);
    ReadAll(socket);
  });
  const std::string url = "http://plm.example:" + receiver.port() + "/hook";
  name_server_.Say("plm.example", {"10.1.2.3"});
  StartClient();
  EXPECT_TRUE(Check(url).ok());
  // It moves here before the first delivery.
  name_server_.Say("plm.example", {"127.0.0.1"});
  EXPECT_THAT(std::string(Post(url).message()), HasSubstr("may not call"));
  EXPECT_EQ(receiver.connections(), 0);
  StartClient({.allow_loopback = true});
  const absl::Status posted = Post(url);
  EXPECT_TRUE(posted.ok()) << posted;
  EXPECT_EQ(receiver.connections(), 1);
  // Of several addresses only those that may be called are.
  name_server_.Say("plm.example", {"169.254.169.254", "127.0.0.1"});
  EXPECT_TRUE(Post(url).ok());
}

TEST_F(WebhookClientTest, GivesUpWhatTakesTooLongAndSaysWhere) {
  RawReceiver silent(ReadAll);
  const absl::Duration moment = absl::Milliseconds(50);
  name_server_.KeepSilent("lost.example");
  StartClient({.allow_loopback = true, .resolve_timeout = moment});
  EXPECT_THAT(std::string(Post("http://lost.example/").message()),
              HasSubstr("lost.example is not known: nobody answers"));
  EXPECT_TRUE(Check("http://lost.example/").ok()) << "not known yet";
  StartClient({.allow_loopback = true, .tls_timeout = moment});
  EXPECT_THAT(std::string(Post("https://127.0.0.1:" + silent.port() + "/").message()),
              HasSubstr("TLS failed"));
  StartClient({.allow_loopback = true, .timeout = moment});
  EXPECT_THAT(std::string(Post("http://127.0.0.1:" + silent.port() + "/").message()),
              HasSubstr("no answer"));
  EXPECT_EQ(silent.connections(), 2);
}

TEST_F(WebhookClientTest, ReadsNoMoreThanTheStatus) {
  StartClient({.allow_loopback = true});
  RawReceiver endless([](RawReceiver::Socket& socket) {
    WriteForEver(socket, "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n1\r\nx\r\n");
  });
  EXPECT_TRUE(Post("http://127.0.0.1:" + endless.port() + "/").ok());
  RawReceiver headers([](RawReceiver::Socket& socket) {
    boost::system::error_code ignored;
    boost::asio::write(socket, boost::asio::buffer(std::string("HTTP/1.1 200 OK\r\n")), ignored);
    WriteForEver(socket, "X-More: " + std::string(1000, 'x') + "\r\n");
  });
  EXPECT_THAT(std::string(Post("http://127.0.0.1:" + headers.port() + "/").message()),
              HasSubstr("no answer"));
  RawReceiver nonsense([](RawReceiver::Socket& socket) { WriteForEver(socket, "nonsense"); });
  EXPECT_THAT(std::string(Post("http://127.0.0.1:" + nonsense.port() + "/").message()),
              HasSubstr("no answer"));
}

TEST_F(WebhookClientTest, FollowsNoRedirect) {
  StartClient({.allow_loopback = true});
  RawReceiver elsewhere(ReadAll);
  const std::string answer =
      "HTTP/1.1 307 Over there\r\nLocation: http://127.0.0.1:" + elsewhere.port() +
      "/\r\nContent-Length: 0\r\n\r\n";
  RawReceiver receiver([&](RawReceiver::Socket& socket) {
    boost::system::error_code ignored;
    boost::asio::write(socket, boost::asio::buffer(answer), ignored);
    ReadAll(socket);
  });
  EXPECT_THAT(std::string(Post("http://127.0.0.1:" + receiver.port() + "/").message()),
              HasSubstr("answered HTTP 307"));
  EXPECT_EQ(elsewhere.connections(), 0);
}

TEST(NameResolver, NamesThatNobodyAnswersForDelayNoOther) {
  NameServer server;
  server.Say("alive.example", {"192.0.2.1", "192.0.2.2"});
  auto resolver =
      NameResolver::Start({.timeout = absl::Seconds(60), .name_servers = server.address()});
  ASSERT_TRUE(resolver.ok()) << resolver.status();
  std::set<std::string> dead;
  std::vector<std::future<NameResolver::Addresses>> lost;
  const auto ask = [&](const std::string& name) {
    auto promise = std::make_shared<std::promise<NameResolver::Addresses>>();
    (*resolver)->Resolve(
        name, [promise](NameResolver::Addresses found) { promise->set_value(std::move(found)); });
    return promise->get_future();
  };
  for (int i = 0; i < 50; ++i) {
    const std::string name = "dead-" + std::to_string(i) + ".example";
    lost.push_back(ask(name));
    dead.insert(name);
  }
  ASSERT_TRUE(server.WaitUntilAskedInVain(dead));
  const NameResolver::Addresses found = ask("alive.example").get();
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->size(), 2u);
  server.Say("gone.example", {});
  EXPECT_TRUE(absl::IsUnavailable(ask("gone.example").get().status()));
  resolver->reset();
  for (auto& one : lost) EXPECT_FALSE(one.get().ok());
}

TEST(WebhookSignature, IsAnHmacOverTimeAndBody) {
  // echo -n '1800000000.{}' | openssl dgst -sha256 -hmac secret
  EXPECT_EQ(SignWebhook({"secret"}, 1800000000, "{}"),
            "t=1800000000,v1=bb7079132825ac793cea8c013c1dd24d926b9b02132245b10588d9e5c0df70d7");
}

}  // namespace
}  // namespace mortise::gateway
