#include "gateway/door_health.h"

#include <chrono>
#include <utility>

#include "common/base/logging.h"

namespace mortise::gateway {
namespace {

constexpr std::chrono::seconds kInterval(1);

}  // namespace

void DoorHealth::Begin(std::vector<Probe> probes) {
  probes_ = std::move(probes);
  thread_ = std::jthread([this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      Ask();
      std::unique_lock lock(mutex_);
      stopped_.wait_for(lock, stop, kInterval, [] { return false; });
    }
  });
}

void DoorHealth::End() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

absl::Status DoorHealth::Now() const {
  std::lock_guard lock(mutex_);
  return now_;
}

void DoorHealth::Ask() {
  absl::Status found;
  for (const Probe& probe : probes_) {
    if (found.ok()) found = probe();
  }
  bool changed = false;
  {
    std::lock_guard lock(mutex_);
    changed = now_.ok() != found.ok();
    now_ = found;
  }
  if (!changed) return;
  Log(found.ok() ? LogLevel::kInfo : LogLevel::kWarning,
      found.ok() ? "the doors let clients in again" : "a door lets nobody in",
      {{"why", found.message()}});
}

}  // namespace mortise::gateway
