#include "common/rpc/dispatcher.h"

#include <condition_variable>
#include <map>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/base/thread_pool.h"
#include "common/rpc/call_state.h"
#include "common/rpc/request_metrics.h"

namespace mortise::rpc {
namespace {

// Routine reads would drown the rest of the log.
LogLevel LevelOf(const MethodInfo& method, absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kInternal:
    case absl::StatusCode::kDataLoss:
      return LogLevel::kError;
    case absl::StatusCode::kOk:
      return method.mutates ? LogLevel::kInfo : LogLevel::kDebug;
    default:
      return LogLevel::kInfo;
  }
}

absl::Status ShuttingDown() {
  return WithDetail(absl::UnavailableError("the server is shutting down; try again elsewhere"),
                    {"SHUTTING_DOWN", ""});
}

// Work that waits for its time, on one thread.
class Timer {
 public:
  using Work = std::function<void()>;

  explicit Timer(std::function<void(Work, Lane)> submit)
      : submit_(std::move(submit)), thread_([this] { Run(); }) {}

  ~Timer() {
    {
      std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  void Add(absl::Duration delay, Work work, Lane lane) {
    {
      std::lock_guard lock(mutex_);
      waiting_.emplace(absl::Now() + delay, std::make_pair(std::move(work), lane));
    }
    changed_.notify_all();
  }

 private:
  void Run() {
    std::unique_lock lock(mutex_);
    while (!stopping_) {
      if (waiting_.empty()) {
        changed_.wait(lock);
        continue;
      }
      const absl::Time next = waiting_.begin()->first;
      if (next > absl::Now()) {
        changed_.wait_until(lock, absl::ToChronoTime(next));
        continue;
      }
      auto [work, lane] = std::move(waiting_.begin()->second);
      waiting_.erase(waiting_.begin());
      lock.unlock();
      submit_(std::move(work), lane);
      lock.lock();
    }
  }

  const std::function<void(Work, Lane)> submit_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::multimap<absl::Time, std::pair<Work, Lane>> waiting_;  // guarded by mutex_
  bool stopping_ = false;                                     // guarded by mutex_
  std::thread thread_;
};

class PoolDispatcher : public Dispatcher {
 public:
  explicit PoolDispatcher(const DispatcherOptions& options)
      : options_(options),
        metrics_(RequestMetrics::Create(options.registry)),
        calls_pool_(options.threads),
        streams_pool_(options.threads),
        urgent_pool_(1),
        timer_([this](std::function<void()> work, Lane lane) { Submit(std::move(work), lane); }) {}

  const DispatcherOptions& options() const override { return options_; }

  void Submit(std::function<void()> work, Lane lane) override {
    {
      std::lock_guard lock(mutex_);
      ++submitted_;
    }
    PoolOf(lane).Submit([this, work = std::move(work)]() mutable {
      try {
        work();
      } catch (const std::exception& exception) {
        Log(LogLevel::kError, "submitted work threw", {{"what", exception.what()}});
      }
      work = nullptr;  // lets go of what it holds before WaitIdle returns
      std::lock_guard lock(mutex_);
      if (--submitted_ == 0) idle_.notify_all();
    });
  }

  void SubmitAfter(absl::Duration delay, std::function<void()> work, Lane lane) override {
    timer_.Add(delay, std::move(work), lane);
  }

  void WaitIdle() override {
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [this] { return submitted_ == 0; });
  }

  void BeginDrain() override {
    std::vector<std::shared_ptr<CallState>> calls;
    {
      std::lock_guard lock(mutex_);
      draining_ = true;
      calls.assign(calls_.begin(), calls_.end());
    }
    for (const auto& call : calls) call->Stop();
  }

  bool WaitForCalls(absl::Time deadline) override {
    std::unique_lock lock(mutex_);
    return no_calls_.wait_until(lock, absl::ToChronoTime(deadline),
                                [this] { return calls_.empty(); });
  }

  int calls() const override {
    std::lock_guard lock(mutex_);
    return static_cast<int>(calls_.size());
  }

  absl::Status Begin(const std::shared_ptr<CallState>& call) override {
    bool draining = false;
    bool full = false;
    {
      std::lock_guard lock(mutex_);
      int& in_flight = in_flight_[call->method().lane];
      full = in_flight >= options_.max_calls;
      draining = draining_;
      if (calls_.insert(call).second) ++in_flight;
    }
    metrics_->Begin();
    if (draining) return ShuttingDown();
    if (!full) return absl::OkStatus();
    return WithDetail(absl::ResourceExhaustedError("too many calls in flight; try again later"),
                      {"TOO_MANY_CALLS", ""});
  }

  void End(const std::shared_ptr<CallState>& call, const absl::Status& status) override {
    {
      std::lock_guard lock(mutex_);
      if (calls_.erase(call) > 0) --in_flight_[call->method().lane];
      if (calls_.empty()) no_calls_.notify_all();
    }
    const absl::Duration time = absl::Now() - call->begun_at();
    const std::string code = absl::StatusCodeToString(status.code());
    metrics_->End(call->method().name, status.code(), time);
    Log(LevelOf(call->method(), status.code()), "call",
        {{"method", call->method().name},
         {"subject", call->identity().subject},
         {"code", code},
         {"error", status.message()},
         {"milliseconds", absl::ToDoubleMilliseconds(time)}});
  }

 private:
  ThreadPool& PoolOf(Lane lane) {
    if (lane == Lane::kUrgent) return urgent_pool_;
    return lane == Lane::kStreams ? streams_pool_ : calls_pool_;
  }

  const DispatcherOptions options_;
  const std::unique_ptr<RequestMetrics> metrics_;
  mutable std::mutex mutex_;
  std::condition_variable idle_;
  std::condition_variable no_calls_;
  std::set<std::shared_ptr<CallState>> calls_;  // guarded by mutex_
  std::map<Lane, int> in_flight_;               // of calls_; guarded by mutex_
  bool draining_ = false;                       // guarded by mutex_
  int64_t submitted_ = 0;                       // guarded by mutex_; queued or running
  ThreadPool calls_pool_;
  ThreadPool streams_pool_;
  ThreadPool urgent_pool_;
  Timer timer_;  // ends before the pools it submits to
};

}  // namespace

std::unique_ptr<Dispatcher> Dispatcher::Create(const DispatcherOptions& options) {
  return std::make_unique<PoolDispatcher>(options);
}

}  // namespace mortise::rpc
