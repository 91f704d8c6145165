// The end of a stream with its caller's token, also where the client does not read what is sent.
//
// A stream ends with its token by the deadline of the call behind it, and the client is told why.
// But a client that reads nothing keeps what was sent last in the way, and the stream open, with
// its place among those that there may be. So it is given a little while to take the last words;
// then its call is cancelled, or its connection closed.
#pragma once

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/system_timer.hpp>
#include <chrono>
#include <memory>

#include "gateway/admission.h"
#include "gateway/awaitable.h"
#include "gateway/http_connection.h"

namespace grpc {
class CallbackServerContext;
}

namespace mortise::gateway {

// When a caller's token is good no more; years away for callers without one.
std::chrono::system_clock::time_point ExpiryOf(const Caller& caller);

// How long the client of a stream may take to read that it has ended.
inline constexpr std::chrono::seconds kLastWordsTime(2);

// Cancels a call of the gRPC door's when that time has passed.
class CallTokenEnd {
 public:
  // `call` must outlive this.
  CallTokenEnd(grpc::CallbackServerContext& call, const Caller& caller);
  ~CallTokenEnd();
  CallTokenEnd(const CallTokenEnd&) = delete;
  CallTokenEnd& operator=(const CallTokenEnd&) = delete;

 private:
  struct Wait;
  std::shared_ptr<Wait> wait_;  // null for callers without a token
};

// Closes the connection at the HTTP door when that time has passed.
class ConnectionTokenEnd {
 public:
  // On the connection's own strand, which is `strand`; the connection must outlive this.
  ConnectionTokenEnd(boost::asio::any_io_executor strand, HttpConnection& connection,
                     const Caller& caller);
  ~ConnectionTokenEnd();
  ConnectionTokenEnd(const ConnectionTokenEnd&) = delete;
  ConnectionTokenEnd& operator=(const ConnectionTokenEnd&) = delete;

 private:
  boost::asio::system_timer timer_;
  const std::shared_ptr<bool> over_ = std::make_shared<bool>(false);
};

}  // namespace mortise::gateway
