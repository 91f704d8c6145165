#include "common/base/repeated_work.h"

#include <condition_variable>
#include <mutex>
#include <utility>

namespace mortise {
namespace {

void Repeat(const std::stop_token& stop, std::chrono::milliseconds pause,
            const std::function<void()>& work) {
  std::mutex mutex;
  std::condition_variable_any stopped;
  std::unique_lock lock(mutex);
  while (!stop.stop_requested()) {
    work();
    stopped.wait_for(lock, stop, pause, [] { return false; });
  }
}

}  // namespace

RepeatedWork::RepeatedWork(std::chrono::milliseconds pause, std::function<void()> work)
    : thread_([pause, work = std::move(work)](const std::stop_token& stop) {
        Repeat(stop, pause, work);
      }) {}

}  // namespace mortise
