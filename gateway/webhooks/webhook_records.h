// Webhooks in the gateway's store: subscriptions with their cursors, and dead letters.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "common/resources/collection.h"
#include "common/resources/record_page.h"
#include "mortise/v1/gateway.pb.h"

namespace mortise::gateway {

// An event that was given up.
struct DeadLetter {
  std::string stream;
  int64_t number = 0;
  int tries = 0;
  std::string error;
  absl::Time give_up_time;
};

// The subscriptions, with their secrets. The gateway has no events of its own.
inline constexpr resources::Collection<v1::Webhook> kWebhooks{
    .names = "webhooks", .kind = "webhooks", .event = nullptr, .newest_first = false};

// By name, with their secrets, those after `after_id`.
absl::StatusOr<std::vector<v1::Webhook>> ListWebhooks(store::ReadTransaction& transaction,
                                                      const std::string& after_id, int limit);

absl::Status PutWebhook(store::Transaction& transaction, const v1::Webhook& webhook);

// With its dead letters.
absl::Status DeleteWebhook(store::Transaction& transaction, const std::string& name);

absl::Status PutDeadLetter(store::Transaction& transaction, const std::string& webhook,
                           const DeadLetter& letter);

// Returns a page of the dead letters of a webhook, by stream and number.
absl::StatusOr<resources::Page<v1::ListDeadLettersResponse::DeadLetter>> PageOfDeadLetters(
    store::ReadTransaction& transaction, const std::string& webhook,
    const resources::PageQuery& query);

// Forgets the dead letters of a stream numbered after `after_number`: they are delivered again.
absl::Status ForgetDeadLetters(store::Transaction& transaction, const std::string& webhook,
                               const std::string& stream, int64_t after_number);

// Returns the cursor of a stream; 0 if there is none.
int64_t CursorOf(const v1::Webhook& webhook, const std::string& stream);
void SetCursor(v1::Webhook& webhook, const std::string& stream, int64_t number);
void RemoveCursor(v1::Webhook& webhook, const std::string& stream);

// Returns the event of a stream that waits for another try; null if none does.
const v1::Webhook::Retry* RetryOf(const v1::Webhook& webhook, const std::string& stream);
void SetRetry(v1::Webhook& webhook, const std::string& stream,
              const std::optional<v1::Webhook::Retry>& retry);

}  // namespace mortise::gateway
