// Keys of tokens from an address: exchanged, withdrawn, and kept while the address is away.
#include "gateway/token_keys/key_address.h"

#include <gmock/gmock.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using ::testing::HasSubstr;
using Json = nlohmann::json;

// An identity provider: what it says may be changed.
class KeyProvider {
 public:
  KeyProvider() : acceptor_(io_, {asio::ip::make_address("127.0.0.1"), 0}) {
    thread_ = std::thread([this] { Serve(); });
  }
  ~KeyProvider() {
    {
      std::lock_guard lock(mutex_);
      over_ = true;
    }
    boost::system::error_code ignored;
    asio::ip::tcp::socket wake(io_);
    wake.connect(acceptor_.local_endpoint(), ignored);
    thread_.join();
  }

  std::string url() const {
    return "http://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port()) + "/keys";
  }

  void Say(int status, const std::string& body) {
    std::lock_guard lock(mutex_);
    status_ = status;
    body_ = body;
  }

  // Waits until so many answers were given in all; false after ten seconds.
  bool WaitForAnswers(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(10), [&] { return answers_ >= count; });
  }

  int answers() const {
    std::lock_guard lock(mutex_);
    return answers_;
  }

 private:
  void Serve() {
    for (;;) {
      boost::system::error_code error;
      asio::ip::tcp::socket socket(io_);
      acceptor_.accept(socket, error);
      http::response<http::string_body> response;
      {
        std::lock_guard lock(mutex_);
        if (over_) return;
        response.result(static_cast<unsigned>(status_));
        response.body() = body_;
      }
      boost::beast::flat_buffer buffer;
      http::request<http::empty_body> request;
      http::read(socket, buffer, request, error);
      response.prepare_payload();
      http::write(socket, response, error);
      std::lock_guard lock(mutex_);
      ++answers_;
      changed_.notify_all();
    }
  }

  asio::io_context io_;
  asio::ip::tcp::acceptor acceptor_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int status_ = 200;   // guarded by mutex_
  std::string body_;   // guarded by mutex_
  int answers_ = 0;    // guarded by mutex_
  bool over_ = false;  // guarded by mutex_
  std::thread thread_;
};

std::string SetOf(const std::vector<Json>& keys) { return Json{{"keys", keys}}.dump(); }

class KeyAddressTest : public GatewayTest {
 protected:
  // With a file of keys of `first_` besides, if that is wanted.
  void Start(bool with_file) {
    GatewayOptions options = SecureOptions(first_);
    if (!with_file) options.jwt_keys.clear();
    options.jwks.url = provider_.url();
    options.jwks.refresh = std::chrono::milliseconds(3600000);
    options.jwks.retry = std::chrono::milliseconds(20);
    options.jwks.pause = std::chrono::milliseconds(0);
    StartGateway(options);
  }

  HttpAnswer Call(const TokenSigner& signer, const std::string& key_id) {
    const std::string token = signer.Sign(
        {{"sub", "ada"}, {"roles", {"viewer"}}, {"exp", absl::ToUnixSeconds(absl::Now()) + 600}},
        key_id);
    return Http(gateway_->addresses().http, "POST", "/mortise.v1.CatalogService/GetItem",
                {{"Content-Type", "application/json"}, {"Authorization", "Bearer " + token}},
                R"({"name":"items/a"})");
  }

  // As a client does that tries again when it is told to.
  int StatusInTheEnd(const TokenSigner& signer, const std::string& key_id) {
    int status = 503;
    for (int i = 0; i < 2000 && status == 503; ++i) {
      const HttpAnswer answer = Call(signer, key_id);
      status = answer.status;
      if (status == 503) {
        EXPECT_EQ(answer.headers.at("retry-after"), "1");
      }
    }
    return status;
  }

  const TokenSigner first_{"EdDSA"};
  const TokenSigner second_{"ES256"};
  KeyProvider provider_;
};

TEST_F(KeyAddressTest, KeysAreExchangedWithoutARestart) {
  provider_.Say(200, SetOf({first_.Jwk("one")}));
  Start(false);
  EXPECT_EQ(StatusInTheEnd(first_, "one"), 200);
  provider_.Say(200, SetOf({second_.Jwk("two")}));
  EXPECT_EQ(StatusInTheEnd(second_, "two"), 200) << "an unknown key has the set fetched anew";
  EXPECT_NE(Call(first_, "one").status, 200) << "a key that was withdrawn is good no more";
}

TEST_F(KeyAddressTest, TheLastKeysStayWhileTheAddressFails) {
  provider_.Say(200, SetOf({first_.Jwk("one")}));
  Start(false);
  ASSERT_EQ(StatusInTheEnd(first_, "one"), 200);
  for (const auto& [status, body] : std::vector<std::pair<int, std::string>>{
           {500, ""}, {302, ""}, {200, "no keys"}, {200, R"({"keys":[]})"}}) {
    provider_.Say(status, body);
    const int before = provider_.answers();
    Call(second_, "two");
    ASSERT_TRUE(provider_.WaitForAnswers(before + 2)) << "it is tried again";
    EXPECT_EQ(Call(first_, "one").status, 200) << status << body;
  }
}

TEST_F(KeyAddressTest, KeysOfAFileAreGoodBesides) {
  provider_.Say(200, SetOf({second_.Jwk("two")}));
  Start(true);
  EXPECT_EQ(Call(first_, "one").status, 200);
  EXPECT_EQ(StatusInTheEnd(second_, "two"), 200);
  EXPECT_EQ(Call(first_, "one").status, 200);
}

TEST_F(KeyAddressTest, UnknownKeysDoNotHaveTheSetFetchedAgainAndAgain) {
  provider_.Say(200, SetOf({first_.Jwk("one")}));
  GatewayOptions options = SecureOptions(first_);
  options.jwks.url = provider_.url();
  StartGateway(options);
  ASSERT_TRUE(provider_.WaitForAnswers(1));
  for (int i = 0; i < 50; ++i) Call(second_, "made-up-" + std::to_string(i));
  EXPECT_LE(provider_.answers(), 2);
  EXPECT_EQ(StatusInTheEnd(second_, "made-up"), 401);
}

TEST_F(KeyAddressTest, AddressesThatAnybodyCouldAnswerAreRefused) {
  for (const char* url : {"http://identity.example/keys", "ftp://127.0.0.1/keys", "keys.json",
                          "http://127.0.0.1.evil.example/", "https://user@identity.example/"}) {
    const auto keys = KeyAddress::Start({.url = url});
    ASSERT_FALSE(keys.ok()) << url;
    EXPECT_THAT(std::string(keys.status().message()), HasSubstr("jwks-url")) << url;
  }
  const auto keys = KeyAddress::Start({.url = provider_.url(), .authority = "/nothing.pem"});
  EXPECT_THAT(std::string(keys.status().message()), HasSubstr("jwks-authority"));
}

}  // namespace
}  // namespace mortise::gateway
