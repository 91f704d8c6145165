// One HTTP/1.1 connection, plain or TLS, as the handlers of the HTTP door see it.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "gateway/contract/connect_protocol.h"
#include "gateway/forwarding/awaitable.h"

namespace mortise::gateway {

using HttpRequest = boost::beast::http::request<boost::beast::http::string_body>;

inline constexpr std::size_t kMaximalBodyBytes = 4 * 1024 * 1024;

// How long a client may take, and how much it may have unread.
struct HttpPatience {
  std::chrono::milliseconds idle{75000};  // between requests
  std::chrono::milliseconds head{20000};  // from the first byte of a request to the end of its head
  // For a body, and in addition a second for every so many bytes that have come.
  std::chrono::milliseconds body{10000};
  std::size_t least_rate = 64 * 1024;
};

// What reading the head of a request, or its body, came to.
enum class HttpReadResult { kRead, kTooLarge, kTooSlow, kMalformed, kNoRoom, kClosed };

// Used by one coroutine, on the connection's own strand, apart from Close.
class HttpConnection {
 public:
  virtual ~HttpConnection() = default;

  // TLS handshake, where there is one. False if it failed.
  virtual boost::asio::awaitable<bool> Open() = 0;

  // Waits until the client begins a request. False if it left, or was idle for too long.
  virtual boost::asio::awaitable<bool> AwaitRequest() = 0;

  // Returns the request without its body. Its `x-request-id` is the client's, or one made here;
  // every answer carries it. After kTooLarge and kMalformed the connection can still answer, and
  // must then be closed.
  virtual boost::asio::awaitable<HttpReadResult> ReadHead(HttpRequest& request) = 0;

  // Returns how long the body is; nothing if that is not said beforehand.
  virtual std::optional<uint64_t> BodyBytes() const = 0;

  // Whether there is room for a body of which so many bytes have come.
  using HasRoom = std::function<bool(std::size_t received)>;

  // Returns the body, of at most kMaximalBodyBytes; kNoRoom as soon as `has_room`, which is asked
  // again and again, says so. Once. After anything but kRead the connection must be closed when it
  // has answered.
  virtual boost::asio::awaitable<HttpReadResult> ReadBody(HttpRequest& request,
                                                          const HasRoom& has_room) = 0;

  // Instead of ReadBody: returns the next bytes of a body of any length, `most` of them unless it
  // ends before, and none at its end. What nobody asks for is not read, so a slow taker slows the
  // client; only the time that the client takes itself counts for its patience. After anything but
  // kRead as ReadBody.
  virtual boost::asio::awaitable<HttpReadResult> ReadPiece(std::string& piece,
                                                           std::size_t most) = 0;

  // Returns what ends a ReadPiece that waits, and every later one of the request in hand, as if the
  // body were over, while the client may still send. To be called from any thread, also when the
  // connection is no more.
  virtual std::function<void()> PieceStopper() = 0;

  // When a request has been answered: takes and drops its body if that has not been read. False if
  // it is too much; answers have then told the client that the connection will be closed.
  virtual boost::asio::awaitable<bool> DropBody() = 0;

  // Sends a whole answer, of which a HEAD request gets the headers. False if the client is gone.
  virtual boost::asio::awaitable<bool> Write(int status, const HeaderList& headers,
                                             std::string body, bool keep_alive) = 0;

  // Headers that every answer to the request in hand carries besides its own.
  virtual void SetAnswerHeaders(HeaderList headers) = 0;

  // Send the head of an answer of `bytes` bytes, of which a HEAD request gets no more, and its
  // bytes, in any number of parts. False if the client is gone, or has not taken 64 KiB within a
  // minute.
  virtual boost::asio::awaitable<bool> BeginBytes(int status, const HeaderList& headers,
                                                  int64_t bytes, bool keep_alive) = 0;
  virtual boost::asio::awaitable<bool> WriteBytes(std::string_view bytes) = 0;

  // Send the beginning of an answer whose length is not known, its pieces, and its end. A piece
  // that the client has not taken within a minute counts as gone.
  virtual boost::asio::awaitable<bool> BeginChunks(int status, const HeaderList& headers,
                                                   bool keep_alive) = 0;
  virtual boost::asio::awaitable<bool> WriteChunk(std::string_view bytes) = 0;
  virtual boost::asio::awaitable<bool> EndChunks() = 0;

  // Takes what the client still sends, for a few seconds and megabytes, and drops it. Before
  // closing while the client sends: a connection closed with bytes unread is reset, and the answer
  // lost with it.
  virtual boost::asio::awaitable<void> Discard() = 0;

  // While an answer is being prepared: calls `gone` if the client goes away. EndWatch before the
  // next Read.
  virtual void WatchForLeaving(std::function<void()> gone) = 0;
  virtual void EndWatch() = 0;

  // From any thread: ends the connection.
  virtual void Close() = 0;
};

// `security` is null for plain text.
std::shared_ptr<HttpConnection> MakeHttpConnection(boost::asio::ip::tcp::socket socket,
                                                   boost::asio::ssl::context* security,
                                                   const HttpPatience& patience);

}  // namespace mortise::gateway
