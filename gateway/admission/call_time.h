// The time that a call of somebody unknown may take.
#pragma once

#include <chrono>
#include <memory>

namespace grpc {
class CallbackServerContext;
}

namespace mortise::gateway {

// Cancels a call that is not over in time, whatever it waits for: a message that does not come, or
// one that its client does not take. Goes before the call's context does.
class CallTime {
 public:
  CallTime(grpc::CallbackServerContext& call, std::chrono::milliseconds most);
  ~CallTime();
  CallTime(const CallTime&) = delete;
  CallTime& operator=(const CallTime&) = delete;

 private:
  struct Limit;
  const std::shared_ptr<Limit> limit_;
};

}  // namespace mortise::gateway
