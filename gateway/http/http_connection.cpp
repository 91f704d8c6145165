#include "gateway/http/http_connection.h"

#include <sys/socket.h>

#include <array>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>
#include <chrono>
#include <limits>

#include "common/base/identifiers.h"
#include "gateway/admission/admission.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using boost::system::error_code;

constexpr std::chrono::seconds kWriteTime(60);
constexpr std::chrono::seconds kDiscardTime(5);
constexpr std::size_t kMaximalDiscardedBytes = 64 << 20;
constexpr std::size_t kMaximalHeaderBytes = 64 * 1024;
constexpr std::size_t kFirstBytes = 4096;
constexpr std::size_t kPartBytes = 64 * 1024;  // that a client takes within kWriteTime
// A body that was not wanted is taken nevertheless if it is no larger, which costs less than a new
// connection.
constexpr uint64_t kDroppedBytes = 64 * 1024;
constexpr unsigned kHttp11 = 11;  // as Beast counts versions
constexpr char kRequestIdHeader[] = "x-request-id";
constexpr char kServerName[] = "mortise-gateway";

template <class Stream>
class Connection final : public HttpConnection,
                         public std::enable_shared_from_this<Connection<Stream>> {
 public:
  Connection(Stream stream, const HttpPatience& patience)
      : stream_(std::move(stream)), patience_(patience) {
    error_code ignored;
    Socket().set_option(asio::ip::tcp::no_delay(true), ignored);
  }

  asio::awaitable<bool> Open() override {
    if constexpr (kSecure) {
      error_code error;
      Lowest().expires_after(patience_.head);
      co_await stream_.async_handshake(asio::ssl::stream_base::server,
                                       asio::redirect_error(asio::use_awaitable, error));
      co_return !error;
    }
    co_return true;
  }

  asio::awaitable<bool> AwaitRequest() override {
    if (buffer_.size() > 0) co_return true;
    error_code error;
    Lowest().expires_after(patience_.idle);
    const std::size_t size = co_await stream_.async_read_some(
        buffer_.prepare(kFirstBytes), asio::redirect_error(asio::use_awaitable, error));
    buffer_.commit(size);
    co_return !error;
  }

  asio::awaitable<HttpReadResult> ReadHead(HttpRequest& request) override {
    request_id_ = NewIdentifier();
    lost_ = false;
    answer_headers_.clear();
    pieces_.reset();
    stopped_ = false;
    received_ = 0;
    waited_ = {};
    parser_.emplace();
    // How long a body may be is asked when it is wanted.
    parser_->body_limit(std::numeric_limits<uint64_t>::max());
    parser_->header_limit(kMaximalHeaderBytes);
    error_code error;
    Lowest().expires_after(patience_.head);
    co_await http::async_read_header(stream_, buffer_, *parser_,
                                     asio::redirect_error(asio::use_awaitable, error));
    if (error) co_return ResultOf(error);
    if (!KnowsEnd()) co_return HttpReadResult::kMalformed;
    static_cast<HttpRequest::header_type&>(request) = parser_->get().base();
    const auto given = request[kRequestIdHeader];
    if (IsRequestId({given.data(), given.size()})) request_id_ = std::string(given);
    request.set(kRequestIdHeader, request_id_);
    co_return HttpReadResult::kRead;
  }

  std::optional<uint64_t> BodyBytes() const override {
    if (parser_->is_done()) return 0;
    const auto length = parser_->content_length();
    return length ? std::optional<uint64_t>(*length) : std::nullopt;
  }

  asio::awaitable<HttpReadResult> ReadBody(HttpRequest& request, const HasRoom& has_room) override {
    lost_ = true;  // unless it comes to its end
    if (BodyBytes().value_or(0) > kMaximalBodyBytes) co_return HttpReadResult::kTooLarge;
    parser_->body_limit(kMaximalBodyBytes);
    error_code error = co_await Invite();
    const auto limit = std::make_shared<Limit>(stream_.get_executor());
    const auto begin = std::chrono::steady_clock::now() + patience_.body;
    std::size_t received = 0;
    bool fits = true;
    while (!error && fits && !parser_->is_done()) {
      const std::chrono::microseconds earned(received * 1000000 / patience_.least_rate);
      Arm(limit, begin + earned);
      received += co_await http::async_read_some(stream_, buffer_, *parser_,
                                                 asio::redirect_error(asio::use_awaitable, error));
      fits = has_room(received);
    }
    limit->over = true;
    limit->timer.cancel();
    if (limit->passed) co_return HttpReadResult::kTooSlow;
    if (error) co_return ResultOf(error);
    if (!fits) co_return HttpReadResult::kNoRoom;
    lost_ = false;
    request.body() = std::move(parser_->get().body());
    co_return HttpReadResult::kRead;
  }

  asio::awaitable<HttpReadResult> ReadPiece(std::string& piece, std::size_t most) override {
    piece.clear();
    if (stopped_ || BodyIsOver()) co_return HttpReadResult::kRead;
    error_code error;
    if (!pieces_) {
      lost_ = true;  // until it comes to its end
      error = co_await Invite();
      // Beast begins a body of another kind only with a parser of its own.
      pieces_.emplace(std::move(*parser_));
    }
    piece.resize(most);
    http::buffer_body::value_type& body = pieces_->get().body();
    body.data = piece.data();
    body.size = most;
    const auto limit = std::make_shared<Limit>(stream_.get_executor());
    reading_piece_ = true;
    while (!error && !stopped_ && body.size > 0 && !pieces_->is_done()) {
      const auto begin = std::chrono::steady_clock::now();
      const std::chrono::microseconds earned(received_ * 1000000 / patience_.least_rate);
      Arm(limit, begin + patience_.body + earned - waited_);
      received_ += co_await http::async_read_some(stream_, buffer_, *pieces_,
                                                  asio::redirect_error(asio::use_awaitable, error));
      waited_ += std::chrono::steady_clock::now() - begin;
      if (error == http::error::need_buffer) error = {};
    }
    reading_piece_ = false;
    limit->over = true;
    limit->timer.cancel();
    piece.resize(stopped_ ? 0 : most - body.size);
    if (stopped_) co_return HttpReadResult::kRead;
    if (limit->passed) co_return HttpReadResult::kTooSlow;
    if (error) co_return ResultOf(error);
    if (pieces_->is_done()) lost_ = false;
    co_return HttpReadResult::kRead;
  }

  std::function<void()> PieceStopper() override {
    return [weak = this->weak_from_this()] {
      const auto self = weak.lock();
      if (self == nullptr) return;
      asio::post(self->stream_.get_executor(), [self] {
        self->stopped_ = true;
        error_code ignored;
        if (self->reading_piece_) self->Socket().cancel(ignored);
      });
    };
  }

  asio::awaitable<bool> DropBody() override {
    if (BodyIsOver()) co_return true;
    if (lost_ || !MayDropBody()) co_return false;
    HttpRequest dropped;
    const HasRoom always = [](std::size_t) { return true; };
    co_return co_await ReadBody(dropped, always) == HttpReadResult::kRead;
  }

  asio::awaitable<bool> Write(int status, const HeaderList& headers, std::string body,
                              bool keep_alive) override {
    http::response<http::string_body> response;
    FillHead(response, status, headers, keep_alive);
    response.body() = std::move(body);
    response.prepare_payload();
    // Beast tells a length of 0, which such an answer must not have (RFC 9110, 8.6).
    if (response.result() == http::status::no_content ||
        response.result() == http::status::not_modified) {
      response.erase(http::field::content_length);
    }
    error_code error;
    Lowest().expires_after(kWriteTime);
    if (IsHead()) {
      http::response_serializer<http::string_body> serializer(response);
      co_await http::async_write_header(stream_, serializer,
                                        asio::redirect_error(asio::use_awaitable, error));
    } else {
      co_await http::async_write(stream_, response,
                                 asio::redirect_error(asio::use_awaitable, error));
    }
    co_return !error;
  }

  void SetAnswerHeaders(HeaderList headers) override { answer_headers_ = std::move(headers); }

  asio::awaitable<bool> BeginBytes(int status, const HeaderList& headers, int64_t bytes,
                                   bool keep_alive) override {
    http::response<http::empty_body> response;
    FillHead(response, status, headers, keep_alive);
    response.content_length(static_cast<uint64_t>(bytes));
    co_return co_await WriteHead(response);
  }

  asio::awaitable<bool> WriteBytes(std::string_view bytes) override {
    error_code error;
    while (!error && !bytes.empty()) {
      const std::string_view part = bytes.substr(0, kPartBytes);
      bytes.remove_prefix(part.size());
      Lowest().expires_after(kWriteTime);
      co_await asio::async_write(stream_, asio::buffer(part.data(), part.size()),
                                 asio::redirect_error(asio::use_awaitable, error));
    }
    Lowest().expires_never();
    co_return !error;
  }

  asio::awaitable<bool> BeginChunks(int status, const HeaderList& headers,
                                    bool keep_alive) override {
    http::response<http::empty_body> response;
    FillHead(response, status, headers, keep_alive);
    response.chunked(true);
    co_return co_await WriteHead(response);
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
  // Tells a client that waits for it to send its body.
  asio::awaitable<error_code> Invite() {
    error_code error;
    if (AwaitsLeave()) {
      http::response<http::empty_body> go_on(http::status::continue_, parser_->get().version());
      Lowest().expires_after(kWriteTime);
      co_await http::async_write(stream_, go_on, asio::redirect_error(asio::use_awaitable, error));
    }
    Lowest().expires_never();
    co_return error;
  }

  asio::awaitable<bool> WriteHead(http::response<http::empty_body>& response) {
    http::response_serializer<http::empty_body> serializer(response);
    error_code error;
    Lowest().expires_after(kWriteTime);
    co_await http::async_write_header(stream_, serializer,
                                      asio::redirect_error(asio::use_awaitable, error));
    co_return !error;
  }

  // When a body has taken too long, the read is ended; the connection can still answer.
  struct Limit {
    explicit Limit(const asio::any_io_executor& executor) : timer(executor) {}
    asio::steady_timer timer;
    bool passed = false;
    bool over = false;  // the body is there
  };

  void Arm(const std::shared_ptr<Limit>& limit, std::chrono::steady_clock::time_point end) {
    limit->timer.expires_at(end);
    limit->timer.async_wait([self = this->shared_from_this(), limit](const error_code& error) {
      if (error || limit->over) return;
      limit->passed = true;
      error_code ignored;
      self->Socket().cancel(ignored);
    });
  }

  static HttpReadResult ResultOf(const error_code& error) {
    if (error == http::error::body_limit || error == http::error::header_limit) {
      return HttpReadResult::kTooLarge;
    }
    if (error == http::error::end_of_stream || error == http::error::partial_message) {
      return HttpReadResult::kClosed;
    }
    const bool malformed =
        error.category() == http::make_error_code(http::error::bad_version).category();
    return malformed ? HttpReadResult::kMalformed : HttpReadResult::kClosed;
  }

  // Whether everybody on the way finds the end of the request where this door does. Beast takes a
  // body in a coding that it does not know for none, and would serve what follows as a request.
  bool KnowsEnd() const {
    const auto& head = parser_->get();
    const auto codings = head.count(http::field::transfer_encoding);
    if (codings == 0) return true;
    return codings == 1 && head.version() >= kHttp11 &&
           beast::iequals(head[http::field::transfer_encoding], "chunked");
  }

  // Whether the client sends the body only when it is told to.
  bool AwaitsLeave() const {
    return beast::iequals(parser_->get()[http::field::expect], "100-continue");
  }

  bool MayDropBody() const {
    return !AwaitsLeave() && BodyBytes().value_or(kDroppedBytes + 1) <= kDroppedBytes;
  }

  bool IsHead() const {
    return parser_ && parser_->is_header_done() && parser_->get().method() == http::verb::head;
  }

  // Whether the client's next request can be found behind this one.
  bool MayGoOn() const {
    return parser_ && parser_->is_header_done() && !lost_ && (BodyIsOver() || MayDropBody());
  }

  bool BodyIsOver() const { return pieces_ ? pieces_->is_done() : parser_->is_done(); }

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
  void FillHead(Response& response, int status, const HeaderList& headers, bool keep_alive) const {
    response.result(static_cast<unsigned>(status));
    response.set(http::field::server, kServerName);
    for (const auto& [name, value] : answer_headers_) response.insert(name, value);
    for (const auto& [name, value] : headers) response.insert(name, value);
    if (response.find(kRequestIdHeader) == response.end()) {
      response.set(kRequestIdHeader, request_id_);
    }
    response.keep_alive(keep_alive && MayGoOn());
  }

  Stream stream_;
  const HttpPatience patience_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;  // of the request in hand
  // Of its body, once that is read in pieces; parser_ then has only what is known of the head.
  std::optional<http::request_parser<http::buffer_body>> pieces_;
  bool reading_piece_ = false;
  bool stopped_ = false;                             // nobody wants more pieces
  uint64_t received_ = 0;                            // bytes of a body that is read in pieces,
  std::chrono::steady_clock::duration waited_ = {};  // and the time that they took
  HeaderList answer_headers_;
  bool lost_ = false;  // what the client sends next is the rest of a body
  std::string request_id_ = NewIdentifier();
  bool watching_ = false;
};

}  // namespace

std::shared_ptr<HttpConnection> MakeHttpConnection(asio::ip::tcp::socket socket,
                                                   asio::ssl::context* security,
                                                   const HttpPatience& patience) {
  if (security == nullptr) {
    return std::make_shared<Connection<beast::tcp_stream>>(beast::tcp_stream(std::move(socket)),
                                                           patience);
  }
  using Secure = beast::ssl_stream<beast::tcp_stream>;
  return std::make_shared<Connection<Secure>>(
      Secure(beast::tcp_stream(std::move(socket)), *security), patience);
}

}  // namespace mortise::gateway
