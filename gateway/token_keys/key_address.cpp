#include "gateway/token_keys/key_address.h"

#include <openssl/ssl.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/logging.h"
#include "gateway/contract/query.h"
#include "gateway/forwarding/awaitable.h"
#include "gateway/webhooks/webhook_address.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::steady_clock;

constexpr std::size_t kMaximalSetBytes = 1 << 20;
constexpr std::size_t kMaximalSetHeaders = 64 * 1024;

absl::Status Unreached(const std::string& why) { return absl::UnavailableError(why); }

std::string Authority(const WebhookUrl& url) {
  const bool six = url.host.find(':') != std::string::npos;
  const std::string host = six ? absl::StrCat("[", url.host, "]") : url.host;
  return url.port == (url.secure ? "443" : "80") ? host : absl::StrCat(host, ":", url.port);
}

// Asks for the set on a stream that is connected.
template <class Stream>
asio::awaitable<absl::StatusOr<std::string>> Ask(Stream& stream, const WebhookUrl& url) {
  http::request<http::empty_body> request(http::verb::get, url.target, 11);
  request.set(http::field::host, Authority(url));
  request.set(http::field::user_agent, "mortise-gateway");
  request.set(http::field::accept, "application/jwk-set+json, application/json");
  request.set(http::field::connection, "close");
  error_code error;
  co_await http::async_write(stream, request, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Unreached("sending failed: " + error.message());
  beast::flat_buffer buffer(kMaximalSetBytes + kMaximalSetHeaders);
  http::response_parser<http::string_body> parser;
  parser.body_limit(kMaximalSetBytes);
  co_await http::async_read(stream, buffer, parser,
                            asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Unreached("no answer: " + error.message());
  if (parser.get().result() != http::status::ok) {
    co_return Unreached(absl::StrCat("answered HTTP ", parser.get().result_int()));
  }
  co_return std::move(parser.get().body());
}

asio::awaitable<absl::StatusOr<std::string>> Fetch(const WebhookUrl& url, asio::ssl::context& tls,
                                                   std::chrono::milliseconds timeout) {
  const auto executor = co_await asio::this_coro::executor;
  error_code error;
  tcp::resolver resolver(executor);
  const auto addresses = co_await resolver.async_resolve(
      url.host, url.port, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Unreached(absl::StrCat(url.host, " is not known: ", error.message()));
  beast::tcp_stream stream(executor);
  stream.expires_after(timeout);
  co_await stream.async_connect(addresses, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Unreached("cannot connect: " + error.message());
  stream.expires_after(timeout);
  if (!url.secure) co_return co_await Ask(stream, url);
  beast::ssl_stream<beast::tcp_stream> secure(std::move(stream), tls);
  secure.set_verify_mode(asio::ssl::verify_peer, error);
  secure.set_verify_callback(asio::ssl::host_name_verification(url.host), error);
  SSL_set_tlsext_host_name(secure.native_handle(), url.host.c_str());
  co_await secure.async_handshake(asio::ssl::stream_base::client,
                                  asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Unreached("TLS failed: " + error.message());
  beast::get_lowest_layer(secure).expires_after(timeout);
  co_return co_await Ask(secure, url);
}

absl::StatusOr<WebhookUrl> ReadAddress(const std::string& text) {
  auto url = ParseWebhookUrl(text);
  if (!url.ok()) {
    return InvalidField("jwks-url", absl::StrCat("is no address: ", url.status().message()));
  }
  if (!url->secure && !IsLoopbackAuthority(Authority(*url))) {
    return InvalidField("jwks-url",
                        "must be https: who could change the keys could let anybody in");
  }
  return url;
}

class FetchedKeys final : public KeyAddress {
 public:
  FetchedKeys(const KeyAddressOptions& options, WebhookUrl url)
      : options_(options), url_(std::move(url)) {
    if (options_.also) keys_ = std::make_shared<const TokenKeys>(*options_.also);
  }

  ~FetchedKeys() override {
    {
      std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    io_.stop();
    if (thread_.joinable()) thread_.join();
  }

  absl::Status Begin() {
    error_code error;
    if (options_.authority.empty()) {
      tls_.set_default_verify_paths(error);
    } else {
      tls_.load_verify_file(options_.authority.string(), error);
    }
    if (error) return InvalidField("jwks-authority", error.message());
    thread_ = std::thread([this] { Run(); });
    return absl::OkStatus();
  }

  std::shared_ptr<const TokenKeys> keys() const override {
    std::lock_guard lock(mutex_);
    return keys_;
  }

  bool FetchAnew() override {
    std::lock_guard lock(mutex_);
    if (fetching_ || wanted_) return true;
    if (last_ && steady_clock::now() < *last_ + options_.pause) return false;
    wanted_ = true;
    changed_.notify_all();
    return true;
  }

 private:
  void Run() {
    for (;;) {
      {
        std::lock_guard lock(mutex_);
        if (stopping_) return;
        fetching_ = true;
        wanted_ = false;
      }
      const absl::Status fetched = FetchOnce();
      if (!fetched.ok()) {
        Log(LogLevel::kWarning, "the keys of tokens cannot be fetched",
            {{"url", options_.url}, {"error", fetched.message()}});
      }
      std::unique_lock lock(mutex_);
      fetching_ = false;
      last_ = steady_clock::now();
      const auto due = *last_ + (fetched.ok() ? options_.refresh : options_.retry);
      changed_.wait_until(lock, due, [this] { return stopping_ || wanted_; });
    }
  }

  absl::Status FetchOnce() {
    absl::StatusOr<std::string> text = Unreached("stopped");
    io_.restart();
    {
      // A stop that came before the restart is not lost.
      std::lock_guard lock(mutex_);
      if (stopping_) return text.status();
    }
    asio::co_spawn(
        io_, [this] { return Fetch(url_, tls_, options_.timeout); },
        [&text](const std::exception_ptr& failure, absl::StatusOr<std::string> result) {
          text = failure ? Unreached("the fetch failed") : std::move(result);
        });
    io_.run();
    if (!text.ok()) return text.status();
    {
      std::lock_guard lock(mutex_);
      if (*text == text_) return absl::OkStatus();
    }
    MORTISE_ASSIGN_OR_RETURN(TokenKeys fetched, TokenKeys::Parse(*text));
    if (options_.also) fetched = TokenKeys::Join(fetched, *options_.also);
    Log(LogLevel::kInfo, "the keys of tokens have changed",
        {{"url", options_.url}, {"keys", static_cast<int64_t>(fetched.size())}});
    std::lock_guard lock(mutex_);
    text_ = *std::move(text);
    keys_ = std::make_shared<const TokenKeys>(std::move(fetched));
    return absl::OkStatus();
  }

  const KeyAddressOptions options_;
  const WebhookUrl url_;
  asio::ssl::context tls_{asio::ssl::context::tls_client};
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const TokenKeys> keys_;         // guarded by mutex_
  std::string text_;                              // that they were read from; guarded by mutex_
  std::optional<steady_clock::time_point> last_;  // end of the last fetch; guarded by mutex_
  bool fetching_ = false;                         // guarded by mutex_
  bool wanted_ = false;                           // guarded by mutex_
  bool stopping_ = false;                         // guarded by mutex_
  asio::io_context io_{1};
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<KeyAddress>> KeyAddress::Start(const KeyAddressOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(WebhookUrl url, ReadAddress(options.url));
  auto keys = std::make_unique<FetchedKeys>(options, std::move(url));
  MORTISE_RETURN_IF_ERROR(keys->Begin());
  return std::unique_ptr<KeyAddress>(std::move(keys));
}

}  // namespace mortise::gateway
