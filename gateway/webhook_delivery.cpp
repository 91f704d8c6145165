#include "gateway/webhook_delivery.h"

#include <google/protobuf/descriptor.h>

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
#include <map>
#include <optional>
#include <random>
#include <thread>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/store/store.h"
#include "gateway/contract.h"
#include "gateway/event_codec.h"
#include "gateway/event_hub.h"
#include "gateway/transcoder.h"
#include "gateway/webhook_records.h"
#include "mortise/v1/events.pb.h"
#include "mortise/v1/gateway.pb.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

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

class Delivery final : public WebhookDelivery {
 public:
  Delivery(const WebhookDeliveryOptions& options, store::Store* store, EventHub* hub,
           const Contract* contract, const Transcoder* transcoder)
      : options_(options),
        store_(store),
        hub_(hub),
        transcoder_(transcoder),
        event_type_(*contract->pool().FindMessageTypeByName("mortise.v1.Event")) {
    thread_ = std::thread([this] { io_.run(); });
    token_ = hub_->OnEvents([this](const std::string& stream) {
      asio::post(strand_, [this, stream] { Wake(stream); });
    });
    Refresh();
  }

  ~Delivery() override {
    token_.reset();
    io_.stop();
    thread_.join();
    pool_.join();
  }

  void Refresh() override {
    asio::co_spawn(
        strand_, [this] { return StartLanes(); }, asio::detached);
  }

 private:
  // One webhook's deliveries of one stream. Lives on the strand.
  struct Lane {
    explicit Lane(const asio::strand<asio::io_context::executor_type>& strand) : wake(strand) {}
    std::string webhook;
    std::string stream;
    asio::steady_timer wake;
    bool woken = false;
    int tries = 0;      // of the event that failed last
    int64_t tried = 0;  // its number
  };
  using LaneKey = std::pair<std::string, std::string>;

  void Wake(const std::string& stream) {
    for (auto& [key, lane] : lanes_) {
      if (key.second != stream) continue;
      lane->woken = true;
      // A pause after a failure is not cut short by further events.
      if (lane->tries == 0) lane->wake.cancel();
    }
  }

  asio::awaitable<void> StartLanes() {
    auto webhooks = co_await RunOn(pool_, [this] { return LoadAll(); });
    if (!webhooks.ok()) {
      Log(LogLevel::kError, "webhooks cannot be read", {{"error", webhooks.status().message()}});
      co_return;
    }
    for (const v1::Webhook& webhook : *webhooks) {
      for (const std::string& stream : hub_->streams()) {
        if (!WantsStream(webhook, stream)) continue;
        auto& lane = lanes_[{webhook.name(), stream}];
        if (lane != nullptr) {
          lane->woken = true;
          lane->wake.cancel();
          continue;
        }
        lane = std::make_shared<Lane>(strand_);
        lane->webhook = webhook.name();
        lane->stream = stream;
        asio::co_spawn(
            strand_, [this, lane = lane] { return Run(lane); }, asio::detached);
      }
    }
  }

  asio::awaitable<void> Run(std::shared_ptr<Lane> lane) {
    for (;;) {
      lane->woken = false;
      const auto load = [this, &lane] { return Load(lane->webhook); };
      const absl::StatusOr<v1::Webhook> webhook = co_await RunOn(pool_, load);
      if (absl::IsNotFound(webhook.status())) break;
      std::optional<absl::Duration> pause;
      if (webhook.ok()) pause = co_await DeliverNext(*lane, *webhook);
      if (pause == absl::ZeroDuration()) continue;
      if (pause) {
        co_await Sleep(*lane, absl::ToChronoMilliseconds(*pause));
      } else if (!lane->woken) {
        co_await Sleep(*lane, kLookAgain);
      }
    }
    lanes_.erase({lane->webhook, lane->stream});
  }

  // Delivers the next wanted event, if there is one. Returns how long to pause: after a failure, or
  // not at all because there may be more; nothing if there are no more events.
  asio::awaitable<std::optional<absl::Duration>> DeliverNext(Lane& lane,
                                                             const v1::Webhook& webhook) {
    const int64_t cursor = CursorOf(webhook, lane.stream);
    const auto read = [this, &lane, cursor] { return hub_->Read(lane.stream, cursor, kBatch); };
    const auto events = co_await RunOn(pool_, read);
    if (!events.ok() || events->empty()) co_return std::nullopt;
    const auto next = std::find_if(events->begin(), events->end(),
                                   [&](const bus::Event& event) { return Wants(webhook, event); });
    if (next == events->end()) {
      const int64_t last = events->back().number;
      const auto skip = [this, &lane, cursor, last] {
        return Commit(lane, cursor, last, std::nullopt, std::nullopt);
      };
      (void)co_await RunOn(pool_, skip);
      co_return absl::ZeroDuration();
    }
    const absl::Status delivered = co_await Post(webhook, *next);
    lane.tries = lane.tried == next->number ? lane.tries + 1 : 1;
    lane.tried = next->number;
    const std::string error(delivered.message());
    if (!delivered.ok() && lane.tries < options_.max_tries) {
      // Up to the event before it, all that was skipped is done with.
      const auto note_failure = [this, &lane, cursor, reached = next->number - 1, &error] {
        return Commit(lane, cursor, reached, error, std::nullopt);
      };
      (void)co_await RunOn(pool_, note_failure);
      co_return Pause(lane.tries);
    }
    std::optional<DeadLetter> letter;
    if (!delivered.ok()) {
      letter = DeadLetter{lane.stream, next->number, lane.tries, error, options_.clock()};
      Log(LogLevel::kWarning, "webhook event given up",
          {{"webhook", lane.webhook},
           {"stream", lane.stream},
           {"number", next->number},
           {"error", error}});
    }
    // If that fails, the webhook was set back or ended meanwhile: the store is asked again.
    const auto commit = [this, &lane, cursor, reached = next->number, &error, &letter] {
      return Commit(lane, cursor, reached, error, letter);
    };
    (void)co_await RunOn(pool_, commit);
    lane.tries = 0;
    lane.tried = 0;
    co_return absl::ZeroDuration();
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
        {"mortise-signature", SignWebhook(webhook.secret(), seconds, *body)}};
    co_return co_await PostWebhook(*url, headers, *body, options_.client);
  }

  absl::Duration Pause(int tries) {
    absl::Duration pause = options_.first_pause;
    for (int i = 1; i < tries && pause < options_.longest_pause; ++i) pause *= 2;
    std::uniform_real_distribution<double> extra(1.0, 1.1);
    return std::min(pause, options_.longest_pause) * extra(random_);
  }

  asio::awaitable<void> Sleep(Lane& lane, std::chrono::milliseconds time) {
    boost::system::error_code ignored;
    lane.wake.expires_after(time);
    co_await lane.wake.async_wait(asio::redirect_error(asio::use_awaitable, ignored));
  }

  // --- On the pool.

  absl::StatusOr<std::vector<v1::Webhook>> LoadAll() {
    std::vector<v1::Webhook> webhooks;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(webhooks, ListWebhooks(transaction, "", kMaximalWebhooks));
      return absl::OkStatus();
    }));
    return webhooks;
  }

  absl::StatusOr<v1::Webhook> Load(const std::string& name) {
    v1::Webhook webhook;
    MORTISE_RETURN_IF_ERROR(store_->Read([&](store::ReadTransaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(webhook, GetWebhook(transaction, name));
      return absl::OkStatus();
    }));
    return webhook;
  }

  // Moves the cursor from `from` to `to`. ABORTED if it was set back meanwhile.
  absl::Status Commit(const Lane& lane, int64_t from, int64_t to,
                      const std::optional<std::string>& error,
                      const std::optional<DeadLetter>& letter) {
    return store_->Transact([&](store::Transaction& transaction) -> absl::Status {
      MORTISE_ASSIGN_OR_RETURN(v1::Webhook webhook, GetWebhook(transaction, lane.webhook));
      if (CursorOf(webhook, lane.stream) != from) {
        return absl::AbortedError("the webhook was set back");
      }
      SetCursor(webhook, lane.stream, to);
      if (error) webhook.set_last_error(*error);
      if (letter) {
        MORTISE_RETURN_IF_ERROR(PutDeadLetter(transaction, lane.webhook, *letter));
      }
      return PutWebhook(transaction, webhook);
    });
  }

  const WebhookDeliveryOptions options_;
  store::Store* const store_;
  EventHub* const hub_;
  const Transcoder* const transcoder_;
  const google::protobuf::Descriptor& event_type_;
  asio::thread_pool pool_{2};
  asio::io_context io_{1};
  asio::executor_work_guard<asio::io_context::executor_type> work_{io_.get_executor()};
  asio::strand<asio::io_context::executor_type> strand_{io_.get_executor()};
  std::map<LaneKey, std::shared_ptr<Lane>> lanes_;  // on the strand
  std::mt19937 random_{std::random_device()()};     // on the strand
  std::shared_ptr<void> token_;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<WebhookDelivery> WebhookDelivery::Start(const WebhookDeliveryOptions& options,
                                                        store::Store* store, EventHub* hub,
                                                        const Contract* contract,
                                                        const Transcoder* transcoder) {
  return std::make_unique<Delivery>(options, store, hub, contract, transcoder);
}

}  // namespace mortise::gateway
