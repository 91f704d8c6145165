#include "gateway/forwarding/event_hub.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <span>
#include <thread>

#include "common/base/errors.h"
#include "common/base/logging.h"

namespace mortise::gateway {
namespace {

class Hub final : public EventHub {
 public:
  explicit Hub(EventHubOptions options) : options_(std::move(options)) {
    for (const std::string& name : options_.streams) streams_[name];
    for (const std::string& name : options_.streams) {
      threads_.emplace_back([this, name] { Listen(name); });
    }
  }

  ~Hub() override {
    {
      std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    stopped_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }

  const std::vector<std::string>& streams() const override { return options_.streams; }

  absl::StatusOr<std::vector<bus::Event>> Read(const std::string& stream, int64_t after,
                                               int limit) override {
    {
      std::lock_guard lock(mutex_);
      const auto found = streams_.find(stream);
      if (found == streams_.end()) return NoSuchStream(stream);
      const Stream& kept = found->second;
      if (kept.latest && after >= *kept.latest) return std::vector<bus::Event>();
      if (!kept.events.empty() && after + 1 >= kept.events.front().number) {
        const auto offset = static_cast<std::size_t>(after + 1 - kept.events.front().number);
        const auto count = std::min(kept.events.size() - offset, static_cast<std::size_t>(limit));
        const auto begin = kept.events.begin() + static_cast<std::ptrdiff_t>(offset);
        return std::vector<bus::Event>(begin, begin + static_cast<std::ptrdiff_t>(count));
      }
    }
    return options_.fetch(stream, after, limit);
  }

  std::optional<int64_t> Latest(const std::string& stream) const override {
    std::lock_guard lock(mutex_);
    const auto found = streams_.find(stream);
    return found == streams_.end() ? std::nullopt : found->second.latest;
  }

  std::shared_ptr<void> OnEvents(std::function<void(const std::string& stream)> callback) override {
    auto listener = std::make_shared<Listener>();
    listener->callback = std::move(callback);
    {
      std::lock_guard lock(listeners_mutex_);
      listeners_.push_back(listener);
    }
    // Once the token has gone, the callback runs no more: its owner may be on its way out.
    return std::shared_ptr<void>(nullptr, [listener](void*) {
      std::lock_guard lock(listener->mutex);
      listener->callback = nullptr;
    });
  }

 private:
  struct Stream {
    std::optional<int64_t> latest;
    std::deque<bus::Event> events;  // consecutive numbers, the last is `latest`
  };
  struct Listener {
    std::mutex mutex;
    std::function<void(const std::string&)> callback;  // empty: gone; guarded by mutex
  };

  // Waits until the service tells where its stream is, then follows it until the end.
  void Listen(const std::string& name) {
    std::optional<int64_t> latest = WaitForLatest(name);
    if (!latest) return;
    {
      std::lock_guard lock(mutex_);
      streams_[name].latest = *latest;
    }
    Notify(name);
    bus::ReplayOptions replay;
    replay.endpoint = options_.endpoint;
    replay.security = options_.security;
    replay.cursors = {{name, *latest}};
    replay.fetch = options_.fetch;
    replay.handle = [this, name](std::span<const bus::Event> events) {
      Keep(name, events);
      return absl::OkStatus();
    };
    auto subscriber = bus::ReplayingSubscriber::Start(std::move(replay));
    if (!subscriber.ok()) {
      Log(LogLevel::kError, "events cannot be followed",
          {{"stream", name}, {"error", subscriber.status().message()}});
      return;
    }
    std::unique_lock lock(mutex_);
    stopped_.wait(lock, [this] { return stopping_; });
    lock.unlock();
  }

  std::optional<int64_t> WaitForLatest(const std::string& name) {
    for (;;) {
      const absl::StatusOr<int64_t> latest = options_.latest(name);
      if (latest.ok()) return *latest;
      std::unique_lock lock(mutex_);
      if (stopped_.wait_for(lock, absl::ToChronoMilliseconds(options_.retry),
                            [this] { return stopping_; })) {
        return std::nullopt;
      }
    }
  }

  void Keep(const std::string& name, std::span<const bus::Event> events) {
    {
      std::lock_guard lock(mutex_);
      Stream& stream = streams_[name];
      for (const bus::Event& event : events) {
        if (event.number <= *stream.latest) continue;
        stream.events.push_back(event);
        stream.latest = event.number;
      }
      while (stream.events.size() > options_.kept) stream.events.pop_front();
    }
    Notify(name);
  }

  void Notify(const std::string& name) {
    std::vector<std::shared_ptr<Listener>> listeners;
    {
      std::lock_guard lock(listeners_mutex_);
      listeners = listeners_;
    }
    for (const auto& listener : listeners) {
      std::lock_guard lock(listener->mutex);
      if (listener->callback) listener->callback(name);
    }
    std::lock_guard lock(listeners_mutex_);
    std::erase_if(listeners_, [](const std::shared_ptr<Listener>& listener) {
      std::lock_guard listener_lock(listener->mutex);
      return listener->callback == nullptr;
    });
  }

  const EventHubOptions options_;
  mutable std::mutex mutex_;
  std::condition_variable stopped_;
  bool stopping_ = false;                  // guarded by mutex_
  std::map<std::string, Stream> streams_;  // guarded by mutex_
  std::mutex listeners_mutex_;
  std::vector<std::shared_ptr<Listener>> listeners_;  // guarded by listeners_mutex_
  std::vector<std::thread> threads_;
};

}  // namespace

absl::Status NoSuchStream(std::string_view stream) {
  const std::string name(stream);
  return WithDetail(absl::NotFoundError("there is no stream '" + name + "'"),
                    {"RESOURCE_NOT_FOUND", name});
}

std::unique_ptr<EventHub> EventHub::Start(EventHubOptions options) {
  return std::make_unique<Hub>(std::move(options));
}

}  // namespace mortise::gateway
