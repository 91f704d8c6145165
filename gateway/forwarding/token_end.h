// The end of a stream with its caller's token, also where the client does not read what is sent.
//
// A stream ends with its token by the deadline of the call behind it, and the client is told why.
// But a client that reads nothing keeps what was sent last in the way, and the stream open, with
// its place among those that there may be. So it is given a little while to take the last words;
// then its call is cancelled, or at the HTTP door its connection closed (connection_token_end.h).
#pragma once

#include <chrono>
#include <memory>

#include "gateway/admission/admission.h"

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

}  // namespace mortise::gateway
