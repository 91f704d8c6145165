// One HTTP/1.1 connection, plain or TLS, as the handlers of the HTTP door see it.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "gateway/awaitable.h"
#include "gateway/connect_protocol.h"

namespace mortise::gateway {

using HttpRequest = boost::beast::http::request<boost::beast::http::string_body>;

inline constexpr std::size_t kMaximalBodyBytes = 4 * 1024 * 1024;

// What reading a request came to.
enum class HttpReadResult { kRequest, kTooLarge, kMalformed, kClosed };

// Used by one coroutine, on the connection's own strand, apart from Close.
class HttpConnection {
 public:
  virtual ~HttpConnection() = default;

  // TLS handshake, where there is one. False if it failed.
  virtual boost::asio::awaitable<bool> Open() = 0;

  // The next request; its body has at most kMaximalBodyBytes. After kTooLarge and kMalformed the
  // connection can still answer, and must then be closed.
  virtual boost::asio::awaitable<HttpReadResult> Read(HttpRequest& request) = 0;

  // A whole answer. False if the client is gone.
  virtual boost::asio::awaitable<bool> Write(int status, const HeaderList& headers,
                                             std::string body, bool keep_alive) = 0;

  // The beginning of an answer whose length is not known, its pieces, and its end. A piece that the
  // client has not taken within a minute counts as gone.
  virtual boost::asio::awaitable<bool> BeginChunks(int status, const HeaderList& headers,
                                                   bool keep_alive) = 0;
  virtual boost::asio::awaitable<bool> WriteChunk(std::string_view bytes) = 0;
  virtual boost::asio::awaitable<bool> EndChunks() = 0;

  // Takes what the client still sends, for a few seconds and megabytes, and drops it. Before
  // closing after kTooLarge: a connection closed with bytes unread is reset, and the answer lost
  // with it.
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
                                                   boost::asio::ssl::context* security);

}  // namespace mortise::gateway
