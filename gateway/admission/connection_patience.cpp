#include "gateway/admission/connection_patience.h"

#include <grpcpp/alarm.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <mutex>

namespace mortise::gateway {

// Outlives the call while the alarm's callback runs.
struct ConnectionPatience::Wait {
  std::shared_ptr<grpc::Channel> channel;
  grpc::Alarm alarm;
  std::mutex mutex;
  grpc::ClientContext* call = nullptr;  // null once the call is over; guarded by mutex
  bool exhausted = false;               // guarded by mutex
};

ConnectionPatience::ConnectionPatience(const std::shared_ptr<grpc::Channel>& channel,
                                       grpc::ClientContext& call,
                                       std::chrono::milliseconds patience) {
  if (channel->GetState(false) == GRPC_CHANNEL_READY) return;
  call.set_wait_for_ready(true);
  wait_ = std::make_shared<Wait>();
  wait_->channel = channel;
  wait_->call = &call;
  wait_->alarm.Set(std::chrono::system_clock::now() + patience, [wait = wait_](bool due) {
    if (!due) return;
    const std::lock_guard lock(wait->mutex);
    if (wait->call == nullptr || wait->channel->GetState(false) == GRPC_CHANNEL_READY) return;
    wait->exhausted = true;
    wait->call->TryCancel();
  });
}

ConnectionPatience::~ConnectionPatience() {
  if (wait_ == nullptr) return;
  {
    const std::lock_guard lock(wait_->mutex);
    wait_->call = nullptr;
  }
  wait_->alarm.Cancel();
}

bool ConnectionPatience::exhausted() const {
  if (wait_ == nullptr) return false;
  const std::lock_guard lock(wait_->mutex);
  return wait_->exhausted;
}

}  // namespace mortise::gateway
