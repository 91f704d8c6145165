#include "gateway/webhook_client.h"

#include <openssl/hmac.h>
#include <openssl/ssl.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/this_coro.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>

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

constexpr std::size_t kMaximalUrlBytes = 2048;
constexpr std::size_t kMaximalAnswerBytes = 64 * 1024;

constexpr char kNotAllowed[] = " is at an address that webhooks may not call";

absl::Status Failed(const std::string& what) { return absl::UnavailableError(what); }

const char* UsualPort(bool secure) { return secure ? "443" : "80"; }

bool IsPort(std::string_view text) {
  constexpr int kLargest = 65535;
  const bool digits =
      std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  int port = 0;
  return digits && absl::SimpleAtoi(absl::string_view(text.data(), text.size()), &port) &&
         port >= 1 && port <= kLargest;
}

// The host, in brackets if it is an IPv6 address, with its port where that is not the usual one.
std::string HostHeader(const WebhookUrl& url) {
  const std::string host =
      url.host.find(':') == std::string::npos ? url.host : absl::StrCat("[", url.host, "]");
  return url.port == UsualPort(url.secure) ? host : absl::StrCat(host, ":", url.port);
}

// Sends the request and reads the answer's status.
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
  beast::flat_buffer buffer;
  http::response_parser<http::string_body> parser;
  parser.body_limit(kMaximalAnswerBytes);
  co_await http::async_read_header(stream, buffer, parser,
                                   asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Failed("no answer: " + error.message());
  const unsigned status = parser.get().result_int();
  if (status < 200 || status > 299) co_return Failed(absl::StrCat("answered HTTP ", status));
  co_return absl::OkStatus();
}

asio::awaitable<absl::Status> Connect(beast::tcp_stream& stream, const WebhookUrl& url,
                                      const WebhookClientOptions& options) {
  error_code error;
  tcp::resolver resolver(co_await asio::this_coro::executor);
  const auto found = co_await resolver.async_resolve(
      url.host, url.port, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Failed(absl::StrCat(url.host, " is not known: ", error.message()));
  std::vector<tcp::endpoint> allowed;
  for (const auto& entry : found) {
    if (IsAllowedAddress(entry.endpoint().address(), options.allow_loopback)) {
      allowed.push_back(entry.endpoint());
    }
  }
  if (allowed.empty()) {
    co_return Failed(absl::StrCat(url.host, kNotAllowed));
  }
  co_await stream.async_connect(allowed, asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Failed(absl::StrCat("cannot connect to ", url.host, ": ", error.message()));
  co_return absl::OkStatus();
}

asio::awaitable<absl::Status> PostSecurely(beast::tcp_stream tcp_stream, const WebhookUrl& url,
                                           const HeaderList& headers, const std::string& body) {
  error_code error;
  asio::ssl::context context(asio::ssl::context::tls_client);
  context.set_default_verify_paths(error);
  beast::ssl_stream<beast::tcp_stream> stream(std::move(tcp_stream), context);
  stream.set_verify_mode(asio::ssl::verify_peer, error);
  stream.set_verify_callback(asio::ssl::host_name_verification(url.host), error);
  SSL_set_tlsext_host_name(stream.native_handle(), url.host.c_str());
  co_await stream.async_handshake(asio::ssl::stream_base::client,
                                  asio::redirect_error(asio::use_awaitable, error));
  if (error) co_return Failed("TLS failed: " + error.message());
  co_return co_await Exchange(stream, url, headers, body);
}

}  // namespace

absl::StatusOr<WebhookUrl> ParseWebhookUrl(std::string_view url) {
  if (url.size() > kMaximalUrlBytes) return InvalidField("url", "is too long");
  if (std::any_of(url.begin(), url.end(), [](char c) { return c <= 0x20 || c >= 0x7f; })) {
    return InvalidField("url", "may only have printable ASCII characters");
  }
  WebhookUrl result;
  if (url.starts_with("https://")) {
    result.secure = true;
    url.remove_prefix(8);
  } else if (url.starts_with("http://")) {
    url.remove_prefix(7);
  } else {
    return InvalidField("url", "must begin with http:// or https://");
  }
  url = url.substr(0, url.find('#'));
  const auto end = std::min(url.find_first_of("/?"), url.size());
  std::string_view authority = url.substr(0, end);
  result.target = std::string(url.substr(end));
  if (!result.target.starts_with('/')) result.target.insert(0, "/");
  if (authority.find('@') != std::string_view::npos) {
    return InvalidField("url", "may not carry a user name or password");
  }
  std::string_view port;
  if (authority.starts_with('[')) {
    const auto close = authority.find(']');
    if (close == std::string_view::npos) return InvalidField("url", "has an unfinished address");
    result.host = std::string(authority.substr(1, close - 1));
    authority.remove_prefix(close + 1);
    if (!authority.empty() && authority.front() != ':') return InvalidField("url", "is malformed");
    port = authority.empty() ? authority : authority.substr(1);
  } else {
    const auto colon = authority.find(':');
    result.host = std::string(authority.substr(0, colon));
    if (colon != std::string_view::npos) port = authority.substr(colon + 1);
  }
  if (result.host.empty()) return InvalidField("url", "names no host");
  if (!port.empty() && !IsPort(port)) return InvalidField("url", "has a port beyond 1 to 65535");
  result.port = port.empty() ? UsualPort(result.secure) : std::string(port);
  return result;
}

bool IsAllowedAddress(const asio::ip::address& given, bool allow_loopback) {
  asio::ip::address address = given;
  if (address.is_v6() && address.to_v6().is_v4_mapped()) {
    address = asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
  }
  if (address.is_unspecified() || address.is_multicast()) return false;
  if (address.is_loopback()) return allow_loopback;
  if (address.is_v6()) return !address.to_v6().is_link_local();
  const auto number = address.to_v4().to_uint();
  const bool link_local = number >> 16 == 0xa9fe;
  const bool this_network = number >> 24 == 0;
  const bool reserved = number >> 28 == 0xf;
  return !link_local && !this_network && !reserved;
}

absl::Status CheckWebhookHost(const WebhookUrl& url, bool allow_loopback) {
  asio::io_context io;
  error_code error;
  const auto found = tcp::resolver(io).resolve(url.host, url.port, error);
  if (error || found.empty()) return absl::OkStatus();
  const bool reachable = std::any_of(found.begin(), found.end(), [&](const auto& entry) {
    return IsAllowedAddress(entry.endpoint().address(), allow_loopback);
  });
  if (reachable) return absl::OkStatus();
  return InvalidField("url", absl::StrCat(url.host, kNotAllowed));
}

std::string SignWebhook(std::string_view secret, int64_t seconds, std::string_view body) {
  const std::string text = absl::StrCat(seconds, ".", absl::string_view(body.data(), body.size()));
  unsigned char mac[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  HMAC(EVP_sha256(), secret.data(), static_cast<int>(secret.size()),
       reinterpret_cast<const unsigned char*>(text.data()), text.size(), mac, &size);
  return absl::StrCat("t=", seconds,
                      ",v1=", absl::BytesToHexString({reinterpret_cast<const char*>(mac), size}));
}

asio::awaitable<absl::Status> PostWebhook(const WebhookUrl& url, const HeaderList& headers,
                                          const std::string& body,
                                          const WebhookClientOptions& options) {
  beast::tcp_stream stream(co_await asio::this_coro::executor);
  stream.expires_after(absl::ToChronoMilliseconds(options.timeout));
  absl::Status connected = co_await Connect(stream, url, options);
  if (!connected.ok()) co_return connected;
  if (url.secure) co_return co_await PostSecurely(std::move(stream), url, headers, body);
  co_return co_await Exchange(stream, url, headers, body);
}

}  // namespace mortise::gateway
