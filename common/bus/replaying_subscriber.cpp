#include "common/bus/replaying_subscriber.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <iterator>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/errors.h"
#include "common/base/logging.h"

namespace mortise::bus {
namespace {

// One followed stream. `waiting` are consecutive events after `cursor` that the handler has not
// taken yet.
struct Followed {
  int64_t cursor = 0;
  std::vector<Event> waiting = {};
  int64_t latest = 0;          // the greatest number heard of
  int64_t epoch = 0;           // of the last heartbeat
  bool must_ask = true;        // the source may have more than we heard of
  absl::Time ask_again = {};   // not before
  absl::Time hand_again = {};  // not before
  absl::Time heard = {};       // when the bus last said something of it

  int64_t last() const { return cursor + static_cast<int64_t>(waiting.size()); }
};

class ThreadedReplayingSubscriber final : public ReplayingSubscriber {
 public:
  ThreadedReplayingSubscriber(ReplayOptions options, std::unique_ptr<Subscriber> subscriber)
      : options_(std::move(options)),
        subscriber_(std::move(subscriber)),
        cursors_(options_.cursors) {
    for (const auto& [stream, cursor] : options_.cursors) {
      streams_[stream] = {.cursor = cursor, .heard = absl::Now()};
    }
    thread_ = std::thread([this] { Follow(); });
  }

  ~ThreadedReplayingSubscriber() override {
    stopping_ = true;
    subscriber_->Interrupt();
    thread_.join();
  }

  int64_t cursor(const std::string& stream) const override {
    std::lock_guard lock(mutex_);
    const auto found = cursors_.find(stream);
    return found == cursors_.end() ? 0 : found->second;
  }

  int64_t fetched() const override { return fetched_; }

  bool WaitFor(const std::string& stream, int64_t number, absl::Duration timeout) override {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, absl::ToChronoNanoseconds(timeout), [&] {
      const auto found = cursors_.find(stream);
      return found != cursors_.end() && found->second >= number;
    });
  }

 private:
  void Follow() {
    while (!stopping_) {
      for (auto& [stream, followed] : streams_) {
        HandOver(stream, &followed);
        if (!stopping_) Ask(stream, &followed);
      }
      Listen();
    }
  }

  // Gives the handler what waits.
  void HandOver(const std::string& stream, Followed* followed) {
    std::size_t done = 0;
    while (done < followed->waiting.size() && !stopping_ && absl::Now() >= followed->hand_again) {
      const std::size_t count =
          std::min(followed->waiting.size() - done, static_cast<std::size_t>(options_.batch));
      const absl::Status status =
          options_.handle(std::span<const Event>(followed->waiting).subspan(done, count));
      if (!status.ok()) {
        Log(LogLevel::kWarning, "events could not be handled and will come again",
            {{"stream", stream}, {"error", status.ToString()}});
        followed->hand_again = absl::Now() + options_.retry;
        break;
      }
      done += count;
      followed->cursor += static_cast<int64_t>(count);
      Announce(stream, followed->cursor);
    }
    followed->waiting.erase(followed->waiting.begin(),
                            followed->waiting.begin() + static_cast<std::ptrdiff_t>(done));
  }

  void Announce(const std::string& stream, int64_t cursor) {
    std::lock_guard lock(mutex_);
    cursors_[stream] = cursor;
    changed_.notify_all();
  }

  // Asks the source for what is missing, if anything may be.
  void Ask(const std::string& stream, Followed* followed) {
    const absl::Time now = absl::Now();
    if (now - followed->heard > options_.silence) {
      followed->heard = now;
      followed->must_ask = true;
    }
    if (!followed->must_ask || now < followed->ask_again || Full(*followed)) return;
    absl::StatusOr<std::vector<Event>> events =
        options_.fetch(stream, followed->last(), options_.fetch_limit);
    absl::Status status = events.status();
    if (status.ok()) status = CheckConsecutive(*events, followed->last());
    if (!status.ok()) {
      Log(LogLevel::kWarning, "missed events could not be fetched",
          {{"stream", stream}, {"error", status.ToString()}});
      followed->ask_again = absl::Now() + options_.retry;
      return;
    }
    fetched_ += static_cast<int64_t>(events->size());
    followed->waiting.insert(followed->waiting.end(), std::make_move_iterator(events->begin()),
                             std::make_move_iterator(events->end()));
    // A source that has less than was heard of is behind, as a restarted one may be.
    const bool full = static_cast<int>(events->size()) == options_.fetch_limit;
    followed->must_ask = full || followed->latest > followed->last();
    if (events->empty()) followed->ask_again = absl::Now() + options_.retry;
  }

  static absl::Status CheckConsecutive(const std::vector<Event>& events, int64_t after) {
    for (const Event& event : events) {
      if (event.number != ++after) {
        return absl::DataLossError(
            absl::StrCat("the source gave event ", event.number, " in place of ", after));
      }
    }
    return absl::OkStatus();
  }

  bool Full(const Followed& followed) const {
    return followed.waiting.size() >= 4 * static_cast<std::size_t>(options_.batch);
  }

  // Takes what has come over the bus; waits if there is nothing else to do.
  void Listen() {
    absl::Duration timeout = TimeToNextTask();
    for (int taken = 0; taken < options_.batch; ++taken) {
      absl::StatusOr<std::optional<Message>> message = subscriber_->Receive(timeout);
      if (!message.ok()) {
        Log(LogLevel::kWarning, "the bus cannot be heard",
            {{"error", message.status().ToString()}});
        absl::SleepFor(options_.retry);
        return;
      }
      if (!message->has_value()) return;
      Take(**std::move(message));
      timeout = absl::ZeroDuration();
    }
  }

  absl::Duration TimeToNextTask() const {
    const absl::Time now = absl::Now();
    absl::Time next = now + options_.silence;
    for (const auto& [stream, followed] : streams_) {
      next = std::min(next, followed.heard + options_.silence);
      if (!followed.waiting.empty()) next = std::min(next, followed.hand_again);
      if (followed.must_ask && !Full(followed)) next = std::min(next, followed.ask_again);
    }
    return std::max(next - now, absl::ZeroDuration());
  }

  void Take(Message message) {
    if (message.kind == Message::Kind::kHeartbeat) {
      TakeHeartbeat(message.heartbeat);
    } else {
      TakeEvent(std::move(message.event));
    }
  }

  void TakeHeartbeat(const Heartbeat& heartbeat) {
    const auto found = streams_.find(heartbeat.stream);
    if (found == streams_.end()) return;
    Followed& followed = found->second;
    followed.heard = absl::Now();
    if (heartbeat.epoch > followed.epoch) {
      followed.epoch = heartbeat.epoch;
      if (heartbeat.number < followed.cursor) {
        Log(LogLevel::kError, "a stream went back: its store was restored from a backup",
            {{"stream", heartbeat.stream},
             {"latest", heartbeat.number},
             {"cursor", followed.cursor}});
      }
    }
    followed.latest = std::max(followed.latest, heartbeat.number);
    if (followed.latest > followed.last()) followed.must_ask = true;
  }

  void TakeEvent(Event event) {
    const auto found = streams_.find(event.stream);
    if (found == streams_.end()) return;
    Followed& followed = found->second;
    followed.heard = absl::Now();
    followed.latest = std::max(followed.latest, event.number);
    if (event.number <= followed.last()) return;  // had it
    if (event.number == followed.last() + 1 && !Full(followed)) {
      followed.waiting.push_back(std::move(event));
    } else {
      followed.must_ask = true;
    }
  }

  const ReplayOptions options_;
  const std::unique_ptr<Subscriber> subscriber_;
  std::atomic<bool> stopping_ = false;
  std::atomic<int64_t> fetched_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, int64_t> cursors_;   // guarded by mutex_
  std::map<std::string, Followed> streams_;  // the thread's own
  std::thread thread_;
};

absl::Status CheckOptions(const ReplayOptions& options) {
  if (!options.fetch) return InvalidField("fetch", "must be set");
  if (!options.handle) return InvalidField("handle", "must be set");
  if (options.batch < 1) return InvalidField("batch", "must be at least 1");
  if (options.fetch_limit < 1) return InvalidField("fetch_limit", "must be at least 1");
  for (const auto& [stream, cursor] : options.cursors) {
    if (stream.empty()) return InvalidField("cursors", "a stream must have a name");
    if (cursor < 0) return InvalidField("cursors", "must not be negative");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<ReplayingSubscriber>> ReplayingSubscriber::Start(
    ReplayOptions options) {
  MORTISE_RETURN_IF_ERROR(CheckOptions(options));
  SubscriberOptions connection{.endpoint = options.endpoint, .security = options.security};
  for (const auto& [stream, cursor] : options.cursors) connection.topics.push_back(stream + "/");
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<Subscriber> subscriber, Subscriber::Connect(connection));
  return std::make_unique<ThreadedReplayingSubscriber>(std::move(options), std::move(subscriber));
}

}  // namespace mortise::bus
