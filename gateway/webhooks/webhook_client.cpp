#include "gateway/webhooks/webhook_client.h"

#include <openssl/hmac.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <boost/asio/associated_executor.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <chrono>
#include <future>
#include <optional>

#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using std::chrono::steady_clock;

constexpr std::size_t kMaximalAnswerBytes = 64 * 1024;

constexpr std::size_t kMaximalAuthorityBytes = 64 * 1024;
constexpr char kAuthorityField[] = "certificate_authority";

constexpr char kNotAllowed[] = " is at an address that webhooks may not call";

absl::Status Failed(const std::string& what) { return absl::UnavailableError(what); }

// The host, in brackets if it is an IPv6 address, with its port where that is not the usual one.
std::string HostHeader(const WebhookUrl& url) {
  const std::string host =
      url.host.find(':') == std::string::npos ? url.host : absl::StrCat("[", url.host, "]");
  return url.port == (url.secure ? "443" : "80") ? host : absl::StrCat(host, ":", url.port);
}

// When a step of a delivery must end: in its own time, and within that of the whole delivery.
class Deadlines {
 public:
  explicit Deadlines(absl::Duration whole) : end_(After(whole)) {}
  steady_clock::time_point For(absl::Duration step) const { return std::min(end_, After(step)); }

 private:
  static steady_clock::time_point After(absl::Duration time) {
    return steady_clock::now() + absl::ToChronoMilliseconds(time);
  }
  steady_clock::time_point end_;
};

// Sends the request and reads the answer's status. Of what follows nothing is read.
template <class Stream>
asio::awaitable<absl::Status> Exchange(Stream& stream, const WebhookUrl& url,
                                       const HeaderList& headers, const std::string& body) {
  http::request<http::string_body> request(http::verb::post, url.target, 11);
  request.set(http::field::host, HostHeader(url));
  request.set(http::field::user_agent, "mortise-gateway");
  request.set(http::field::connection, "close");
  for (const auto& [name, value] : headers) request.set(name, value);
  request.body() = body;
  request.prepare_payload();
  error_code error;
  co_await http::async_write(stream, request, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Failed("sending failed: " + error.message());
  beast::flat_buffer buffer(kMaximalAnswerBytes);
  http::response_parser<http::empty_body> parser;
  co_await http::async_read_header(stream, buffer, parser,
                                   asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Failed("no answer: " + error.message());
  const unsigned status = parser.get().result_int();
  if (status < 200 || status > 299) co_return Failed(absl::StrCat("answered HTTP ", status));
  co_return absl::OkStatus();
}

// The addresses of the host. Lambdas are given names before they are awaited: see RunOn in
// webhook_delivery.cpp.
asio::awaitable<NameResolver::Addresses> Resolve(NameResolver& resolver, const std::string& host) {
  if (const auto literal = LiteralAddress(host)) {
    co_return std::vector<asio::ip::address>{*literal};
  }
  std::optional<NameResolver::Addresses> result;
  auto begin = [&resolver, &host, &result](auto handler) {
    auto executor = asio::get_associated_executor(handler);
    auto shared = std::make_shared<decltype(handler)>(std::move(handler));
    resolver.Resolve(host, [executor, shared, &result, guard = asio::make_work_guard(executor)](
                               NameResolver::Addresses found) {
      asio::post(executor, [shared, &result, found = std::move(found)] {
        result = found;
        (*shared)(true);
      });
    });
  };
  co_await asio::async_initiate<const asio::use_awaitable_t<>, void(bool)>(begin,
                                                                           asio::use_awaitable);
  co_return std::move(*result);
}

}  // namespace

std::string SignWebhook(const std::vector<std::string>& secrets, int64_t seconds,
                        std::string_view body) {
  const std::string text = absl::StrCat(seconds, ".", absl::string_view(body.data(), body.size()));
  std::string signature = absl::StrCat("t=", seconds);
  for (const std::string& secret : secrets) {
    unsigned char mac[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
         reinterpret_cast<const unsigned char*>(text.data()), text.size(), mac, &size);
    absl::StrAppend(&signature,
                    ",v1=", absl::BytesToHexString({reinterpret_cast<const char*>(mac), size}));
  }
  return signature;
}

absl::Status CheckCertificateAuthority(std::string_view pem) {
  if (pem.empty()) return absl::OkStatus();
  if (pem.size() > kMaximalAuthorityBytes) {
    return InvalidField(kAuthorityField, "has more than 64 KiB");
  }
  asio::ssl::context tls(asio::ssl::context::tls_client);
  error_code error;
  tls.add_certificate_authority(asio::buffer(pem.data(), pem.size()), error);
  const bool found = pem.find("-----BEGIN CERTIFICATE-----") != std::string_view::npos;
  if (!error && found) return absl::OkStatus();
  return InvalidField(kAuthorityField, "has no certificates as PEM that can be read");
}

class WebhookClient::Transport {
 public:
  Transport(const WebhookClientOptions& options, std::unique_ptr<NameResolver> resolver)
      : options_(options), resolver_(std::move(resolver)), tls_(asio::ssl::context::tls_client) {
    error_code ignored;  // without authorities no receiver is trusted, and each delivery says so
    tls_.set_default_verify_paths(ignored);
  }

  absl::Status CheckHost(const WebhookUrl& url) {
    std::vector<asio::ip::address> addresses;
    if (const auto literal = LiteralAddress(url.host)) {
      addresses.push_back(*literal);
    } else {
      auto promise = std::make_shared<std::promise<NameResolver::Addresses>>();
      resolver_->Resolve(url.host, [promise](NameResolver::Addresses found) {
        promise->set_value(std::move(found));
      });
      const NameResolver::Addresses found = promise->get_future().get();
      if (!found.ok()) return absl::OkStatus();
      addresses = *found;
    }
    const bool reachable =
        std::any_of(addresses.begin(), addresses.end(), [&](const asio::ip::address& address) {
          return IsAllowedAddress(address, options_.allow_loopback);
        });
    if (reachable) return absl::OkStatus();
    return InvalidField("url", absl::StrCat(url.host, kNotAllowed));
  }

  asio::awaitable<absl::Status> Post(const WebhookUrl& url, const std::string& authority,
                                     const HeaderList& headers, const std::string& body) {
    const Deadlines deadlines(options_.timeout);
    const auto found = co_await Resolve(*resolver_, url.host);
    if (!found.ok()) {
      co_return Failed(absl::StrCat(url.host, " is not known: ", found.status().message()));
    }
    beast::tcp_stream stream(co_await asio::this_coro::executor);
    const absl::Status connected = co_await Connect(stream, url, *found, deadlines);
    if (!connected.ok()) co_return connected;
    if (url.secure) {
      if (authority.empty()) {
        co_return co_await PostSecurely(std::move(stream), tls_, url, headers, body, deadlines);
      }
      asio::ssl::context tls(asio::ssl::context::tls_client);
      error_code error;
      tls.add_certificate_authority(asio::buffer(authority), error);
      if (error) co_return Failed("the webhook's authority cannot be read: " + error.message());
      co_return co_await PostSecurely(std::move(stream), tls, url, headers, body, deadlines);
    }
    stream.expires_at(deadlines.For(options_.timeout));
    co_return co_await Exchange(stream, url, headers, body);
  }

 private:
  // The addresses are looked at here, where they are connected to: what the name meant before, or
  // means a moment later, does not count.
  asio::awaitable<absl::Status> Connect(beast::tcp_stream& stream, const WebhookUrl& url,
                                        const std::vector<asio::ip::address>& addresses,
                                        const Deadlines& deadlines) {
    std::uint32_t port = 0;
    if (!absl::SimpleAtoi(url.port, &port)) co_return Failed("the port cannot be");
    std::vector<tcp::endpoint> allowed;
    for (const asio::ip::address& address : addresses) {
      if (IsAllowedAddress(address, options_.allow_loopback)) {
        allowed.emplace_back(address, static_cast<std::uint16_t>(port));
      }
    }
    if (allowed.empty()) co_return Failed(absl::StrCat(url.host, kNotAllowed));
    error_code error;
    stream.expires_at(deadlines.For(options_.connect_timeout));
    co_await stream.async_connect(allowed, asio::redirect_error(asio::use_awaitable, error));
    if (!error) co_return absl::OkStatus();
    co_return Failed(absl::StrCat("cannot connect to ", url.host, ": ", error.message()));
  }

  asio::awaitable<absl::Status> PostSecurely(beast::tcp_stream tcp_stream, asio::ssl::context& tls,
                                             const WebhookUrl& url, const HeaderList& headers,
                                             const std::string& body, const Deadlines& deadlines) {
    error_code error;
    beast::ssl_stream<beast::tcp_stream> stream(std::move(tcp_stream), tls);
    stream.set_verify_mode(asio::ssl::verify_peer, error);
    stream.set_verify_callback(asio::ssl::host_name_verification(url.host), error);
    SSL_set_tlsext_host_name(stream.native_handle(), url.host.c_str());
    beast::get_lowest_layer(stream).expires_at(deadlines.For(options_.tls_timeout));
    co_await stream.async_handshake(asio::ssl::stream_base::client,
                                    asio::redirect_error(asio::use_awaitable, error));
    if (error) co_return Failed("TLS failed: " + error.message());
    beast::get_lowest_layer(stream).expires_at(deadlines.For(options_.timeout));
    co_return co_await Exchange(stream, url, headers, body);
  }

  const WebhookClientOptions options_;
  const std::unique_ptr<NameResolver> resolver_;
  asio::ssl::context tls_;
};

WebhookClient::WebhookClient(std::unique_ptr<Transport> transport)
    : transport_(std::move(transport)) {}

WebhookClient::~WebhookClient() = default;

absl::StatusOr<std::unique_ptr<WebhookClient>> WebhookClient::Create(
    const WebhookClientOptions& options) {
  MORTISE_ASSIGN_OR_RETURN(
      std::unique_ptr<NameResolver> resolver,
      NameResolver::Start({.timeout = std::min(options.resolve_timeout, options.timeout),
                           .name_servers = options.name_servers}));
  return std::unique_ptr<WebhookClient>(
      new WebhookClient(std::make_unique<Transport>(options, std::move(resolver))));
}

absl::Status WebhookClient::CheckHost(const WebhookUrl& url) { return transport_->CheckHost(url); }

asio::awaitable<absl::Status> WebhookClient::Post(const WebhookUrl& url,
                                                  const std::string& authority,
                                                  const HeaderList& headers,
                                                  const std::string& body) {
  return transport_->Post(url, authority, headers, body);
}

}  // namespace mortise::gateway
