#include "common/bus/outbox_relay.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/base/logging.h"

namespace mortise::bus {
namespace {

class ThreadedRelay final : public OutboxRelay {
 public:
  ThreadedRelay(const OutboxRelayOptions& options, store::Store* store, Publisher* publisher)
      : options_(options), store_(store), publisher_(publisher) {
    listener_ = store_->OnCommit([this] { Wake(); });
    thread_ = std::thread([this] { Relay(); });
  }

  ~ThreadedRelay() override {
    listener_.reset();
    {
      std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  bool active() const override { return active_; }

  int64_t published() const override {
    std::lock_guard lock(mutex_);
    return published_;
  }

  bool WaitForPublished(int64_t number, absl::Duration timeout) override {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, absl::ToChronoNanoseconds(timeout),
                             [&] { return published_ >= number; });
  }

 private:
  void Wake() {
    std::lock_guard lock(mutex_);
    woken_ = true;
    changed_.notify_all();
  }

  // False once it is time to end.
  bool Sleep(absl::Duration duration) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, absl::ToChronoNanoseconds(duration),
                      [this] { return woken_ || stopping_; });
    woken_ = false;
    return !stopping_;
  }

  bool Stopping() {
    std::lock_guard lock(mutex_);
    return stopping_;
  }

  void Relay() {
    while (!Stopping()) {
      if (numbering_ == nullptr && !TakeOver()) {
        if (!StandBy()) return;
        continue;
      }
      const absl::StatusOr<std::vector<store::NumberedEvent>> events =
          numbering_->NumberEvents(options_.batch);
      if (!events.ok()) {
        GiveUp(events.status());
        continue;
      }
      for (const store::NumberedEvent& event : *events) Publish(event);
      HeartbeatIfDue();
      if (!events->empty()) Announce(events->back().number);
      const bool more = static_cast<int>(events->size()) == options_.batch;
      if (!more && !Sleep(std::min(options_.poll, options_.heartbeat))) return;
    }
  }

  bool TakeOver() {
    absl::StatusOr<std::unique_ptr<store::EventNumbering>> numbering = store_->TakeEventNumbering();
    absl::Status status = numbering.status();
    if (status.ok()) {
      status = store_->Read([this](store::ReadTransaction& transaction) -> absl::Status {
        MORTISE_ASSIGN_OR_RETURN(latest_, transaction.LatestEventNumber());
        return absl::OkStatus();
      });
    }
    if (!status.ok()) {
      if (DetailOf(status).reason != "RELAY_TAKEN") {
        Log(LogLevel::kWarning, "events cannot be relayed",
            {{"stream", options_.stream}, {"error", status.ToString()}});
      }
      return false;
    }
    numbering_ = *std::move(numbering);
    next_heartbeat_ = absl::InfinitePast();
    active_ = true;
    return true;
  }

  // Waits for the next attempt to take over; commits do not hasten it. False once it is time to
  // end.
  bool StandBy() {
    const absl::Time until = absl::Now() + options_.heartbeat;
    while (absl::Now() < until) {
      if (!Sleep(until - absl::Now())) return false;
    }
    return true;
  }

  void GiveUp(const absl::Status& status) {
    Log(LogLevel::kWarning, "the relay gives up its right to number",
        {{"stream", options_.stream}, {"error", status.ToString()}});
    active_ = false;
    numbering_.reset();
  }

  void Publish(const store::NumberedEvent& event) {
    // What cannot be sent is fetched by number.
    publisher_
        ->Publish(Event{.stream = options_.stream,
                        .epoch = event.epoch,
                        .number = event.number,
                        .type = event.type,
                        .subject = event.subject,
                        .payload = event.payload,
                        .trace_id = event.trace_id,
                        .time = event.time})
        .IgnoreError();
    latest_ = event.number;
  }

  void HeartbeatIfDue() {
    if (absl::Now() < next_heartbeat_) return;
    publisher_
        ->Publish(Heartbeat{.stream = options_.stream,
                            .epoch = numbering_->epoch(),
                            .number = latest_,
                            .time = store_->Now()})
        .IgnoreError();
    next_heartbeat_ = absl::Now() + options_.heartbeat;
  }

  void Announce(int64_t number) {
    std::lock_guard lock(mutex_);
    published_ = number;
    changed_.notify_all();
  }

  const OutboxRelayOptions options_;
  store::Store* const store_;
  Publisher* const publisher_;
  std::unique_ptr<store::CommitListener> listener_;
  std::atomic<bool> active_ = false;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  bool woken_ = false;     // guarded by mutex_
  bool stopping_ = false;  // guarded by mutex_
  int64_t published_ = 0;  // guarded by mutex_
  // The thread's own.
  std::unique_ptr<store::EventNumbering> numbering_;
  int64_t latest_ = 0;
  absl::Time next_heartbeat_;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<OutboxRelay> OutboxRelay::Start(const OutboxRelayOptions& options,
                                                store::Store* store, Publisher* publisher) {
  return std::make_unique<ThreadedRelay>(options, store, publisher);
}

}  // namespace mortise::bus
