#include "gateway/admission/call_time.h"

#include <grpcpp/alarm.h>
#include <grpcpp/server_context.h>

#include <mutex>

namespace mortise::gateway {

// Outlives the call while the alarm's callback runs.
struct CallTime::Limit {
  grpc::Alarm alarm;
  std::mutex mutex;
  grpc::CallbackServerContext* call = nullptr;  // null once the call is over; guarded by mutex
};

CallTime::CallTime(grpc::CallbackServerContext& call, std::chrono::milliseconds most)
    : limit_(std::make_shared<Limit>()) {
  limit_->call = &call;
  limit_->alarm.Set(std::chrono::system_clock::now() + most, [limit = limit_](bool due) {
    if (!due) return;
    const std::lock_guard lock(limit->mutex);
    if (limit->call != nullptr) limit->call->TryCancel();
  });
}

CallTime::~CallTime() {
  {
    const std::lock_guard lock(limit_->mutex);
    limit_->call = nullptr;
  }
  limit_->alarm.Cancel();
}

}  // namespace mortise::gateway
