#include "gateway/http_connection.h"

#include <sys/socket.h>

#include <array>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <chrono>

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;

constexpr std::chrono::seconds kIdleTime(75);
constexpr std::chrono::seconds kWriteTime(60);
constexpr std::chrono::seconds kDiscardTime(5);
constexpr std::size_t kMaximalDiscardedBytes = 64 << 20;
constexpr std::size_t kMaximalHeaderBytes = 64 * 1024;
constexpr char kServerName[] = "mortise-gateway";

template <class Stream>
class Connection final : public HttpConnection,
                         public std::enable_shared_from_this<Connection<Stream>> {
 public:
  explicit Connection(Stream stream) : stream_(std::move(stream)) {
    error_code ignored;
    Socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  }

  asio::awaitable<bool> Open() override {
    if constexpr (kSecure) {
      error_code error;
      Lowest().expires_after(kWriteTime);
      co_await stream_.async_handshake(asio::ssl::stream_base::server,
                                       asio::redirect_error(asio::use_awaitable, error));
      co_return !error;
    }
    co_return true;
  }

  asio::awaitable<HttpReadResult> Read(HttpRequest& request) override {
    error_code error;
    http::request_parser<http::string_body> parser;
    parser.body_limit(kMaximalBodyBytes);
    parser.header_limit(kMaximalHeaderBytes);
    Lowest().expires_after(kIdleTime);
    co_await http::async_read_header(stream_, buffer_, parser,
                                     asio::redirect_error(asio::use_awaitable, error));
    if (!error && beast::iequals(parser.get()[http::field::expect], "100-continue")) {
      http::response<http::empty_body> go_on(http::status::continue_, parser.get().version());
      co_await http::async_write(stream_, go_on, asio::redirect_error(asio::use_awaitable, error));
    }
    if (!error) {
      co_await http::async_read(stream_, buffer_, parser,
                                asio::redirect_error(asio::use_awaitable, error));
    }
    request = parser.release();
    if (!error) co_return HttpReadResult::kRequest;
    if (error == http::error::body_limit) co_return HttpReadResult::kTooLarge;
    const bool end = error == http::error::end_of_stream || error == http::error::partial_message;
    const bool malformed =
        error.category() == http::make_error_code(http::error::bad_version).category();
    co_return malformed && !end ? HttpReadResult::kMalformed : HttpReadResult::kClosed;
  }

  asio::awaitable<bool> Write(int status, const HeaderList& headers, std::string body,
                              bool keep_alive) override {
    http::response<http::string_body> response;
    FillHead(response, status, headers, keep_alive);
    response.body() = std::move(body);
    response.prepare_payload();
    error_code error;
    Lowest().expires_after(kWriteTime);
    co_await http::async_write(stream_, response, asio::redirect_error(asio::use_awaitable, error));
    co_return !error;
  }

  asio::awaitable<bool> BeginChunks(int status, const HeaderList& headers,
                                    bool keep_alive) override {
    http::response<http::empty_body> response;
    FillHead(response, status, headers, keep_alive);
    response.chunked(true);
    http::response_serializer<http::empty_body> serializer(response);
    error_code error;
    Lowest().expires_after(kWriteTime);
    co_await http::async_write_header(stream_, serializer,
                                      asio::redirect_error(asio::use_awaitable, error));
    co_return !error;
  }

  asio::awaitable<bool> WriteChunk(std::string_view bytes) override {
    error_code error;
    Lowest().expires_after(kWriteTime);
    co_await asio::async_write(stream_, http::make_chunk(asio::buffer(bytes.data(), bytes.size())),
                               asio::redirect_error(asio::use_awaitable, error));
    Lowest().expires_never();
    co_return !error;
  }

  asio::awaitable<bool> EndChunks() override {
    error_code error;
    Lowest().expires_after(kWriteTime);
    co_await asio::async_write(stream_, http::make_chunk_last(),
                               asio::redirect_error(asio::use_awaitable, error));
    co_return !error;
  }

  asio::awaitable<void> Discard() override {
    Lowest().expires_after(kDiscardTime);
    std::array<char, 64 * 1024> dropped;
    error_code error;
    for (std::size_t total = 0; !error && total < kMaximalDiscardedBytes;) {
      total += co_await stream_.async_read_some(asio::buffer(dropped),
                                                asio::redirect_error(asio::use_awaitable, error));
    }
  }

  void WatchForLeaving(std::function<void()> gone) override {
    Lowest().expires_never();
    watching_ = true;
    Watch(std::move(gone));
  }

  void EndWatch() override {
    if (!watching_) return;
    watching_ = false;
    error_code ignored;
    Socket().cancel(ignored);
  }

  void Close() override {
    auto self = this->shared_from_this();
    asio::post(stream_.get_executor(), [self] {
      // Both directions end, which also wakes WatchForLeaving; the coroutine then lets go.
      error_code ignored;
      self->Socket().shutdown(asio::ip::tcp::socket::shutdown_both, ignored);
    });
  }

 private:
  static constexpr bool kSecure = !std::is_same_v<Stream, beast::tcp_stream>;

  auto& Lowest() { return beast::get_lowest_layer(stream_); }
  auto& Socket() { return Lowest().socket(); }

  // What a socket that is said to be readable means while nothing is asked for.
  enum class Sign {
    kNone,   // nothing is there: what was, has been read before this was told
    kAhead,  // a request sent ahead
    kLeft,  // the end of the stream; under TLS it announces itself by a record, which is all that a
            // client sends here
  };

  Sign SignOfPeer() {
    char byte = 0;
    const ssize_t size =
        ::recv(Socket().native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT | MSG_NOSIGNAL);
    if (size > 0) return kSecure ? Sign::kLeft : Sign::kAhead;
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return Sign::kNone;
    return Sign::kLeft;
  }

  void Watch(std::function<void()> gone) {
    auto self = this->shared_from_this();
    Socket().async_wait(asio::ip::tcp::socket::wait_read,
                        [self, gone = std::move(gone)](const error_code& error) mutable {
                          if (!self->watching_ || error == asio::error::operation_aborted) return;
                          const Sign sign = error ? Sign::kLeft : self->SignOfPeer();
                          if (sign == Sign::kLeft) return gone();
                          if (sign == Sign::kNone) self->Watch(std::move(gone));
                        });
  }

  template <class Response>
  static void FillHead(Response& response, int status, const HeaderList& headers, bool keep_alive) {
    response.result(static_cast<unsigned>(status));
    response.set(http::field::server, kServerName);
    for (const auto& [name, value] : headers) response.insert(name, value);
    response.keep_alive(keep_alive);
  }

  Stream stream_;
  beast::flat_buffer buffer_;
  bool watching_ = false;
};

}  // namespace

std::shared_ptr<HttpConnection> MakeHttpConnection(asio::ip::tcp::socket socket,
                                                   asio::ssl::context* security) {
  if (security == nullptr) {
    return std::make_shared<Connection<beast::tcp_stream>>(beast::tcp_stream(std::move(socket)));
  }
  using Secure = beast::ssl_stream<beast::tcp_stream>;
  return std::make_shared<Connection<Secure>>(
      Secure(beast::tcp_stream(std::move(socket)), *security));
}

}  // namespace mortise::gateway
