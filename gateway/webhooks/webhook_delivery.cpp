#include "gateway/webhooks/webhook_delivery.h"

#include <google/protobuf/descriptor.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <boost/asio/associated_executor.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/redirect_error.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/thread_pool.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <future>
#include <map>
#include <optional>
#include <random>
#include <thread>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/store/store.h"
#include "gateway/contract/contract.h"
#include "gateway/contract/transcoder.h"
#include "gateway/forwarding/event_codec.h"
#include "gateway/forwarding/event_hub.h"
#include "gateway/webhooks/delivery_turns.h"
#include "gateway/webhooks/webhook_records.h"
#include "mortise/v1/events.pb.h"
#include "mortise/v1/gateway.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

constexpr char kTestType[] = "webhook.test";
constexpr int kBatch = 100;
constexpr int kMaximalWebhooks = 10000;
// Hub and store tell of what is new; this only covers a service that was away.
constexpr std::chrono::seconds kLookAgain(5);

// Runs blocking work on `pool` and comes back with its result. What the pool needs stays in this
// coroutine's frame, and lambdas are given names before they are awaited: GCC 12 destroys captures
// of temporaries in an awaited expression twice.
template <class Work>
asio::awaitable<std::invoke_result_t<Work>> RunOn(asio::thread_pool& pool, Work work) {
  std::optional<std::invoke_result_t<Work>> result;
  auto begin = [&pool, &work, &result](auto handler) {
    auto executor = asio::get_associated_executor(handler);
    auto shared = std::make_shared<decltype(handler)>(std::move(handler));
    asio::post(pool, [executor, shared, &work, &result,
                      guard = asio::make_work_guard(executor)]() mutable {
      result.emplace(work());
      asio::post(executor, [shared] { (*shared)(true); });
    });
  };
  co_await asio::async_initiate<const asio::use_awaitable_t<>, void(bool)>(begin,
                                                                           asio::use_awaitable);
  co_return std::move(*result);
}

bool Wants(const v1::Webhook& webhook, const bus::Event& event) {
  if (webhook.type_prefixes().empty()) return true;
  return std::any_of(webhook.type_prefixes().begin(), webhook.type_prefixes().end(),
                     [&](const std::string& prefix) { return event.type.starts_with(prefix); });
}

bool WantsStream(const v1::Webhook& webhook, const std::string& stream) {
  return webhook.streams().empty() || std::find(webhook.streams().begin(), webhook.streams().end(),
                                                stream) != webhook.streams().end();
}

// What deliveries are signed with: for a time also with the secret before the present one.
std::vector<std::string> SecretsOf(const v1::Webhook& webhook, absl::Time now) {
  std::vector<std::string> secrets = {webhook.secret()};
  const absl::Time end =
      absl::FromUnixMicros(google::protobuf::util::TimeUtil::TimestampToMicroseconds(
          webhook.previous_secret_end_time()));
  if (!webhook.previous_secret().empty() && now < end) {
    secrets.push_back(webhook.previous_secret());
  }
  return secrets;
}

// What the store learns of a lane at once.
struct Progress {
  int64_t from = 0;                              // the cursor before
  int64_t to = 0;                                // and after
  std::optional<std::string> error = {};         // becomes the webhook's last error
  std::optional<DeadLetter> letter = {};         // an event that was given up
  std::optional<v1::Webhook::Retry> retry = {};  // an event that waits for another try
  absl::Duration pause = absl::ZeroDuration();   // until that try
};

class Delivery final : public WebhookDelivery {
 public:
  Delivery(const WebhookDeliveryOptions& options, std::unique_ptr<WebhookClient> client,
           store::Store* store, EventHub* hub, const Contract* contract,
           const Transcoder* transcoder)
      : options_(options),
        store_(store),
        hub_(hub),
        transcoder_(transcoder),
        event_type_(*contract->pool().FindMessageTypeByName("mortise.v1.Event")),
        client_(std::move(client)),
        turns_(options.at_once),
        hindering_turns_(options.at_once_failing) {
    for (const std::string& stream : hub_->streams()) {
      readers_[stream] = std::make_unique<asio::thread_pool>(1);
    }
    thread_ = std::thread([this] { io_.run(); });
    token_ = hub_->OnEvents([this](const std::string& stream) {
      asio::post(strand_, [this, stream] { Wake(stream); });
    });
    asio::co_spawn(
        strand_, [this] { return StartAll(); }, asio::detached);
  }

  ~Delivery() override {
    token_.reset();
    io_.stop();
    thread_.join();
    pool_.join();
    for (const auto& [stream, reader] : readers_) reader->join();
    client_.reset();  // its resolver still knows the coroutines
  }

  void Refresh(const std::string& webhook, const std::string& stream) override {
    asio::co_spawn(
        strand_, [this, webhook, stream] { return Look(webhook, stream); }, asio::detached);
  }

  absl::Status CheckHost(const WebhookUrl& url) override { return client_->CheckHost(url); }

  absl::Status Test(const v1::Webhook& webhook) override {
    bus::Event event;
    event.stream = "gateway";
    event.number = 0;
    event.type = kTestType;
    event.subject = webhook.name();
    event.time = options_.clock();
    event.payload = "{}";
    auto promise = std::make_shared<std::promise<absl::Status>>();
    std::future<absl::Status> result = promise->get_future();
    asio::co_spawn(
        strand_, [this, webhook, event] { return Post(webhook, event); },
        [promise](const std::exception_ptr& failure, absl::Status status) {
          promise->set_value(failure ? absl::UnavailableError("the delivery failed") : status);
        });
    // The client gives up in its time; more than that is a gateway that stops.
    if (result.wait_for(absl::ToChronoSeconds(2 * options_.client.timeout)) !=
        std::future_status::ready) {
      return absl::UnavailableError("the receiver did not answer in time");
    }
    return result.get();
  }

 private:
  using SteadyTime = std::chrono::steady_clock::time_point;

  // One webhook's deliveries of one stream. Lives on the strand.
  struct Lane {
    explicit Lane(const asio::strand<asio::io_context::executor_type>& strand) : wake(strand) {}
    std::string webhook;
    std::string stream;
    asio::steady_timer wake;
    bool woken = false;
    bool failing = false;           // the receiver did not take the last event,
    bool slow = false;              // or took its time about it
    std::optional<SteadyTime> due;  // of the next try, during the pause after a failure
  };
  using LaneKey = std::pair<std::string, std::string>;

  // A pause after a failure is not cut short by further events.
  void Wake(const std::string& stream) {
    for (auto& [key, lane] : lanes_) {
      if (key.second != stream) continue;
      lane->woken = true;
      if (!lane->due) lane->wake.cancel();
    }
  }

  asio::awaitable<void> StartAll() {
    const auto load = [this] { return LoadAll(); };
    const auto webhooks = co_await RunOn(pool_, load);
    if (!webhooks.ok()) {
      Log(LogLevel::kError, "webhooks cannot be read", {{"error", webhooks.status().message()}});
      co_return;
    }
    for (const v1::Webhook& webhook : *webhooks) StartLanes(webhook);
  }

  // Begins the lanes that the webhook has not, and ends the pauses of those it has.
  asio::awaitable<void> Look(std::string name, std::string stream) {
    for (auto& [key, lane] : lanes_) {
      if (key.first != name || (!stream.empty() && key.second != stream)) continue;
      lane->woken = true;
      lane->due.reset();
      lane->wake.cancel();
    }
    const auto load = [this, &name] { return Load(name); };
    const absl::StatusOr<v1::Webhook> webhook = co_await RunOn(pool_, load);
    if (webhook.ok()) StartLanes(*webhook);
  }

  void StartLanes(const v1::Webhook& webhook) {
    for (const std::string& stream : hub_->streams()) {
      if (!WantsStream(webhook, stream)) continue;
      auto& lane = lanes_[{webhook.name(), stream}];
      if (lane != nullptr) continue;
      lane = std::make_shared<Lane>(strand_);
      lane->webhook = webhook.name();
      lane->stream = stream;
      if (const v1::Webhook::Retry* retry = RetryOf(webhook, stream)) Resume(*lane, *retry);
      asio::co_spawn(
          strand_, [this, lane = lane] { return Run(lane); },
          [this, lane = lane](const std::exception_ptr& failure) {
            if (failure) EndByException(*lane);
          });
    }
  }

  // Whoever refreshes the webhook begins the lane again.
  void EndByException(const Lane& lane) {
    Log(LogLevel::kError, "deliveries to a webhook ended by an exception",
        {{"webhook", lane.webhook}, {"stream", lane.stream}});
    lanes_.erase({lane.webhook, lane.stream});
  }

  // Goes on with a pause that an earlier process began; no clock that was set makes it longer.
  void Resume(Lane& lane, const v1::Webhook::Retry& retry) {
    const absl::Time due = absl::FromUnixMicros(
        google::protobuf::util::TimeUtil::TimestampToMicroseconds(retry.next_try_time()));
    const absl::Duration left =
        std::clamp(due - options_.clock(), absl::ZeroDuration(), 1.1 * options_.longest_pause);
    lane.due = std::chrono::steady_clock::now() + absl::ToChronoMilliseconds(left);
    lane.failing = true;
  }

  asio::awaitable<void> Run(std::shared_ptr<Lane> lane) {
    for (;;) {
      while (lane->due && std::chrono::steady_clock::now() < *lane->due) {
        co_await SleepUntil(*lane, *lane->due);
      }
      lane->due.reset();
      lane->woken = false;
      const auto load = [this, &lane] { return Load(lane->webhook); };
      const absl::StatusOr<v1::Webhook> webhook = co_await RunOn(pool_, load);
      if (absl::IsNotFound(webhook.status())) break;
      if (webhook.ok() && !WantsStream(*webhook, lane->stream)) {
        if (lane->woken) continue;  // it may want the stream again by now
        break;
      }
      const bool more = webhook.ok() && co_await DeliverNext(*lane, *webhook);
      if (!more && !lane->due && !lane->woken) {
        co_await SleepUntil(*lane, std::chrono::steady_clock::now() + kLookAgain);
      }
    }
    lanes_.erase({lane->webhook, lane->stream});
  }

  // Delivers the next wanted event, if there is one. Returns whether there may be more; after a
  // failure the lane has a pause.
  asio::awaitable<bool> DeliverNext(Lane& lane, const v1::Webhook& webhook) {
    // A service that was never reached has nothing to tell, and would be waited for.
    if (!hub_->Latest(lane.stream)) co_return false;
    const int64_t cursor = CursorOf(webhook, lane.stream);
    const auto read = [this, &lane, cursor] { return hub_->Read(lane.stream, cursor, kBatch); };
    const auto events = co_await RunOn(*readers_.at(lane.stream), read);
    if (!events.ok() || events->empty()) co_return false;
    const auto next = std::find_if(events->begin(), events->end(),
                                   [&](const bus::Event& event) { return Wants(webhook, event); });
    if (next == events->end()) {
      const Progress skipped{.from = cursor, .to = events->back().number};
      co_await Commit(lane, skipped);
      co_return true;
    }
    const absl::Status delivered = co_await PostInTurn(lane, webhook, *next);
    lane.failing = !delivered.ok();
    Progress progress{.from = cursor, .to = next->number};
    if (delivered.ok()) {
      progress.error = "";
    } else {
      const v1::Webhook::Retry* retry = RetryOf(webhook, lane.stream);
      const bool again = retry != nullptr && retry->number() == next->number;
      NoteFailure(lane, *next, again ? retry->tries() + 1 : 1, delivered, progress);
    }
    const absl::Status committed = co_await Commit(lane, progress);
    // Where the webhook was set back meanwhile the store is asked again.
    if (progress.retry && !absl::IsAborted(committed)) {
      lane.due = std::chrono::steady_clock::now() + absl::ToChronoMilliseconds(progress.pause);
    }
    co_return !lane.due;
  }

  asio::awaitable<absl::Status> PostInTurn(Lane& lane, const v1::Webhook& webhook,
                                           const bus::Event& event) {
    Turns& turns = lane.failing || lane.slow ? hindering_turns_ : turns_;
    const Turns::Turn turn = co_await turns.Take();
    const absl::Time begin = options_.clock();
    absl::Status delivered;
    try {
      delivered = co_await Post(webhook, event);
    } catch (const std::exception& failure) {
      delivered = absl::InternalError(failure.what());
    }
    lane.slow = options_.clock() - begin > options_.slow;
    co_return delivered;
  }

  // What becomes of an event after its n-th try has failed: another one later, or a dead letter.
  void NoteFailure(const Lane& lane, const bus::Event& event, int tries,
                   const absl::Status& failure, Progress& progress) {
    progress.error = std::string(failure.message());
    if (tries >= options_.max_tries) {
      progress.letter =
          DeadLetter{lane.stream, event.number, tries, *progress.error, options_.clock()};
      Log(LogLevel::kWarning, "webhook event given up",
          {{"webhook", lane.webhook},
           {"stream", lane.stream},
           {"number", event.number},
           {"error", *progress.error}});
      return;
    }
    progress.to = event.number - 1;  // up to the event before it, all that was skipped is done with
    progress.pause = Pause(tries);
    v1::Webhook::Retry& retry = progress.retry.emplace();
    retry.set_stream(lane.stream);
    retry.set_number(event.number);
    retry.set_tries(tries);
    *retry.mutable_next_try_time() = google::protobuf::util::TimeUtil::MicrosecondsToTimestamp(
        absl::ToUnixMicros(options_.clock() + progress.pause));
  }

  asio::awaitable<absl::Status> Post(const v1::Webhook& webhook, const bus::Event& event) {
    const auto url = ParseWebhookUrl(webhook.url());
    if (!url.ok()) co_return url.status();
    const auto body = transcoder_->ToJson(event_type_, ToProto(event).SerializeAsString());
    if (!body.ok()) co_return body.status();
    const int64_t seconds = absl::ToUnixSeconds(options_.clock());
    const HeaderList headers = {
        {"content-type", "application/json"},
        {"mortise-webhook", webhook.name()},
        {"mortise-event", event.type},
        {"mortise-delivery", absl::StrCat(event.stream, ":", event.number)},
        {"mortise-signature", SignWebhook(SecretsOf(webhook, options_.clock()), seconds, *body)}};
    co_return co_await client_->Post(*url, webhook.certificate_authority(), headers, *body);
  }

  absl::Duration Pause(int tries) {
    absl::Duration pause = options_.first_pause;
    for (int i = 1; i < tries && pause < options_.longest_pause; ++i) pause *= 2;
    std::uniform_real_distribution<double> extra(1.0, 1.1);
    return std::min(pause, options_.longest_pause) * extra(random_);
  }

  asio::awaitable<void> SleepUntil(Lane& lane, SteadyTime time) {
    boost::system::error_code ignored;
    lane.wake.expires_at(time);
    co_await lane.wake.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  }

  asio::awaitable<absl::Status> Commit(const Lane& lane, const Progress& progress) {
    const auto store = [this, &lane, &progress] { return Store(lane, progress); };
    co_return co_await RunOn(pool_, store);
  }

  // --- On the pool.

  absl::StatusOr<std::vector<v1::Webhook>> LoadAll() {
    return resources::ReadFrom<std::vector<v1::Webhook>>(
        *store_, [](store::ReadTransaction& transaction) {
          return ListWebhooks(transaction, "", kMaximalWebhooks);
        });
  }

  absl::StatusOr<v1::Webhook> Load(const std::string& name) { return kWebhooks.Get(*store_, name); }

  // ABORTED if the webhook was set back meanwhile.
  absl::Status Store(const Lane& lane, const Progress& progress) {
    return store_->Transact([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(v1::Webhook webhook, kWebhooks.Get(transaction, lane.webhook));
      // What else the record has, such as tags that were changed meanwhile, stays as it is.
      if (CursorOf(webhook, lane.stream) != progress.from) {
        return absl::AbortedError("the webhook was set back");
      }
      SetCursor(webhook, lane.stream, progress.to);
      SetRetry(webhook, lane.stream, progress.retry);
      if (progress.error) webhook.set_last_error(*progress.error);
      if (progress.letter) {
        MORTISE_RETURN_IF_ERROR(PutDeadLetter(transaction, lane.webhook, *progress.letter));
      }
      return PutWebhook(transaction, webhook);
    });
  }

  const WebhookDeliveryOptions options_;
  store::Store* const store_;
  EventHub* const hub_;
  const Transcoder* const transcoder_;
  const google::protobuf::Descriptor& event_type_;
  std::unique_ptr<WebhookClient> client_;
  // On the strand. They outlive it, and with it the coroutines that have turns.
  Turns turns_;
  Turns hindering_turns_;
  asio::thread_pool pool_{2};
  // One thread for each stream, whose service may be slow to say what is no longer kept.
  std::map<std::string, std::unique_ptr<asio::thread_pool>> readers_;
  asio::io_context io_{1};
  asio::executor_work_guard<asio::io_context::executor_type> work_{io_.get_executor()};
  asio::strand<asio::io_context::executor_type> strand_{io_.get_executor()};
  std::map<LaneKey, std::shared_ptr<Lane>> lanes_;  // on the strand
  std::mt19937 random_{std::random_device()()};     // on the strand
  std::shared_ptr<void> token_;
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<WebhookDelivery>> WebhookDelivery::Start(
    const WebhookDeliveryOptions& options, store::Store* store, EventHub* hub,
    const Contract* contract, const Transcoder* transcoder) {
  MORTISE_ASSIGN_OR_RETURN(std::unique_ptr<WebhookClient> client,
                           WebhookClient::Create(options.client));
  return std::make_unique<Delivery>(options, std::move(client), store, hub, contract, transcoder);
}

}  // namespace mortise::gateway
