// The methods of webhooks: subscriptions, and what could not be delivered. gateway.proto says what
// each takes and gives. Only CreateWebhook and RotateWebhookSecret tell the secret.
#pragma once

#include "absl/status/statusor.h"
#include "common/rpc/call.h"
#include "common/store/store.h"
#include "gateway/admission/budget.h"
#include "gateway/forwarding/hosted_services.h"
#include "mortise/v1/gateway.pb.h"

namespace mortise::gateway {

// What the methods stand on; it outlives them.
struct Webhooks {
  HostedEnvironment environment;
  Budget* lookups;  // of hosts, at a time
  Budget* tests;    // of receivers, at a time
};

namespace methods {

// Returns the subscription as it will be stored: it begins with what comes from now on.
// INVALID_ARGUMENT naming every field at fault; as WebhookDelivery::CheckHost.
absl::StatusOr<v1::Webhook> DraftWebhook(const Webhooks& webhooks, const rpc::Call& call,
                                         const v1::CreateWebhookRequest& asked);
absl::StatusOr<v1::Webhook> CreateWebhook(const Webhooks& webhooks, const rpc::Call& call,
                                          const v1::CreateWebhookRequest& asked,
                                          const v1::Webhook& draft,
                                          store::Transaction& transaction);

absl::StatusOr<v1::Webhook> GetWebhook(const Webhooks& webhooks, const rpc::Call& call,
                                       const v1::GetWebhookRequest& asked);

absl::StatusOr<v1::ListWebhooksResponse> ListWebhooks(const Webhooks& webhooks,
                                                      const rpc::Call& call,
                                                      const v1::ListWebhooksRequest& asked);

// What an update asks for, checked before there is a transaction: looking a host up takes time.
// INVALID_ARGUMENT naming every field at fault; as WebhookDelivery::CheckHost.
absl::StatusOr<v1::UpdateWebhookRequest> CheckUpdate(const Webhooks& webhooks,
                                                     const rpc::Call& call,
                                                     const v1::UpdateWebhookRequest& asked);
absl::StatusOr<v1::Webhook> UpdateWebhook(const Webhooks& webhooks, const rpc::Call& call,
                                          const v1::UpdateWebhookRequest& asked,
                                          const v1::UpdateWebhookRequest& checked,
                                          store::Transaction& transaction);

// Waits for the receiver, for the time of a delivery at most; RESOURCE_EXHAUSTED while two others
// do.
absl::StatusOr<v1::TestWebhookResponse> TestWebhook(const Webhooks& webhooks, const rpc::Call& call,
                                                    const v1::TestWebhookRequest& asked);

absl::StatusOr<v1::Webhook> RotateWebhookSecret(const Webhooks& webhooks, const rpc::Call& call,
                                                const v1::RotateWebhookSecretRequest& asked,
                                                store::Transaction& transaction);

absl::StatusOr<v1::DeleteWebhookResponse> DeleteWebhook(const Webhooks& webhooks,
                                                        const rpc::Call& call,
                                                        const v1::DeleteWebhookRequest& asked,
                                                        store::Transaction& transaction);

absl::StatusOr<v1::Webhook> ReplayWebhook(const Webhooks& webhooks, const rpc::Call& call,
                                          const v1::ReplayWebhookRequest& asked,
                                          store::Transaction& transaction);

absl::StatusOr<v1::ListDeadLettersResponse> ListDeadLetters(
    const Webhooks& webhooks, const rpc::Call& call, const v1::ListDeadLettersRequest& asked);

}  // namespace methods
}  // namespace mortise::gateway
