// How long a call waits for a service that cannot be reached just now, because it restarts.
#pragma once

#include <chrono>
#include <memory>

namespace grpc {
class Channel;
class ClientContext;
}  // namespace grpc

namespace mortise::gateway {

// A call that waits for its channel has not been sent: it can wait for any method, whether that may
// be repeated or not. A call that was sent when the connection broke fails as ever.
class ConnectionPatience {
 public:
  // Before the call starts. Both must outlive this. A call on a channel that is connected costs one
  // look at its state; one that is not may wait `patience`, or until its own deadline if that
  // comes first, and is cancelled then.
  ConnectionPatience(const std::shared_ptr<grpc::Channel>& channel, grpc::ClientContext& call,
                     std::chrono::milliseconds patience);
  ~ConnectionPatience();
  ConnectionPatience(const ConnectionPatience&) = delete;
  ConnectionPatience& operator=(const ConnectionPatience&) = delete;

  // Whether the call was cancelled because its channel was not connected in time.
  bool exhausted() const;

 private:
  struct Wait;
  std::shared_ptr<Wait> wait_;  // null if the channel was connected
};

}  // namespace mortise::gateway
