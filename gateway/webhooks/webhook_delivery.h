// Delivers events to webhooks: one at a time and in order for each webhook and stream, tried again
// with growing pauses, and given up (as a dead letter) after a number of tries.
//
// The cursor of a webhook moves in the store only after its event was delivered or given up, in the
// same transaction as the dead letter. A gateway that dies in between delivers that event again:
// at least once, and recognisable by its `Mortise-Delivery: stream:number`. How often an event was
// tried and when it will be again is in the store too, so that a pause outlives the gateway.
//
// No webhook waits for another. Each has its own pauses, which end when they are over or when that
// webhook is set back, by nothing else. Deliveries run at once, within a limit; those to receivers
// that failed last, or were slow, have a limit of their own, so that the slow and the dead leave
// room for others: after their first delivery, for which all are taken to be sound.
#pragma once

#include <functional>
#include <memory>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "gateway/webhooks/webhook_client.h"
#include "mortise/v1/gateway.pb.h"

namespace mortise::store {
class Store;
}

namespace mortise::gateway {

class EventHub;
class Transcoder;
class Contract;

struct WebhookDeliveryOptions {
  int max_tries = 10;                               // then the event becomes a dead letter
  absl::Duration first_pause = absl::Seconds(1);    // doubled after each failed try, up to
  absl::Duration longest_pause = absl::Minutes(5);  // this; with up to a tenth more at random
  int at_once = 64;          // deliveries to receivers that took their last event, or are new
  int at_once_failing = 64;  // deliveries to receivers that did not, or not within
  absl::Duration slow = absl::Seconds(2);
  WebhookClientOptions client;
  std::function<absl::Time()> clock = absl::Now;  // for the signature's time, pauses and slowness
};

class WebhookDelivery {
 public:
  // Begins with the subscriptions in the store. All must outlive it. Fails as
  // WebhookClient::Create.
  static absl::StatusOr<std::unique_ptr<WebhookDelivery>> Start(
      const WebhookDeliveryOptions& options, store::Store* store, EventHub* hub,
      const Contract* contract, const Transcoder* transcoder);

  // Stops; deliveries in hand are abandoned and made again by the next process.
  virtual ~WebhookDelivery() = default;

  // This subscription was made, ended, or set back in `stream` (in all, if empty). Its pauses there
  // end; those of others do not.
  virtual void Refresh(const std::string& webhook, const std::string& stream = "") = 0;

  // Posts an event of the type "webhook.test" to the webhook, once and at once, beside its
  // deliveries, and waits for what comes of it: as WebhookClient::Post. Thread safe; not on threads
  // of this.
  virtual absl::Status Test(const v1::Webhook& webhook) = 0;

  // As WebhookClient::CheckHost.
  virtual absl::Status CheckHost(const WebhookUrl& url) = 0;
};

}  // namespace mortise::gateway
