#include "gateway/forwarding/token_end.h"

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>

#include <mutex>

namespace mortise::gateway {

std::chrono::system_clock::time_point ExpiryOf(const Caller& caller) {
  if (caller.expires_at == absl::InfiniteFuture()) {
    return std::chrono::system_clock::time_point::max();
  }
  return absl::ToChronoTime(caller.expires_at);
}

// Outlives the call while the alarm's callback runs.
struct CallTokenEnd::Wait {
  grpc::Alarm alarm;
  std::mutex mutex;
  grpc::CallbackServerContext* call = nullptr;  // null once the call is over; guarded by mutex
};

CallTokenEnd::CallTokenEnd(grpc::CallbackServerContext& call, const Caller& caller) {
  if (caller.expires_at == absl::InfiniteFuture()) return;
  wait_ = std::make_shared<Wait>();
  wait_->call = &call;
  wait_->alarm.Set(ExpiryOf(caller) + kLastWordsTime, [wait = wait_](bool due) {
    const std::lock_guard lock(wait->mutex);
    if (due && wait->call != nullptr) wait->call->TryCancel();
  });
}

CallTokenEnd::~CallTokenEnd() {
  if (wait_ == nullptr) return;
  {
    const std::lock_guard lock(wait_->mutex);
    wait_->call = nullptr;
  }
  wait_->alarm.Cancel();
}

}  // namespace mortise::gateway
