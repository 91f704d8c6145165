#include "gateway/webhooks/webhook_methods.h"

#include <google/protobuf/util/time_util.h>
#include <openssl/rand.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/host/call_author.h"
#include "common/host/event_service.h"
#include "common/resources/collection.h"
#include "common/resources/resource_tags.h"
#include "gateway/forwarding/event_hub.h"
#include "gateway/webhooks/webhook_address.h"
#include "gateway/webhooks/webhook_delivery.h"
#include "gateway/webhooks/webhook_records.h"

namespace mortise::gateway::methods {
namespace {

using google::protobuf::util::TimeUtil;
using Streams = google::protobuf::RepeatedPtrField<std::string>;

// Unguessable: 32 random bytes.
absl::StatusOr<std::string> NewSecret() {
  unsigned char bytes[32];
  if (RAND_bytes(bytes, sizeof(bytes)) != 1) {
    return absl::InternalError("the system has no randomness");
  }
  return "whsec_" + absl::BytesToHexString({reinterpret_cast<const char*>(bytes), sizeof(bytes)});
}

v1::Webhook WithoutSecret(v1::Webhook webhook) {
  webhook.clear_secret();
  return webhook;
}

template <typename Names>
bool Has(const Names& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

absl::Status CheckStreams(const Webhooks& webhooks, const Streams& streams) {
  for (int i = 0; i < streams.size(); ++i) {
    if (!Has(webhooks.environment.hub->streams(), streams[i])) {
      return InvalidField(absl::StrCat("streams[", i, "]"), "there is no such stream");
    }
  }
  return absl::OkStatus();
}

// Looking a name up may take seconds and one of the few threads of all calls: some at a time.
absl::Status CheckHost(const Webhooks& webhooks, const WebhookUrl& url) {
  std::unique_ptr<Budget::Share> lookup;
  if (!LiteralAddress(url.host)) {
    lookup = webhooks.lookups->Take("", 1);
    if (lookup == nullptr) return TooManyAtATime("webhooks whose hosts are looked up");
  }
  return webhooks.environment.delivery->CheckHost(url);
}

void RefreshAfter(const Webhooks& webhooks, store::Transaction& transaction,
                  const std::string& webhook, const std::string& stream = "") {
  transaction.AfterCommit([delivery = webhooks.environment.delivery, webhook, stream] {
    delivery->Refresh(webhook, stream);
  });
}

}  // namespace

absl::StatusOr<v1::Webhook> DraftWebhook(const Webhooks& webhooks, const rpc::Call& call,
                                         const v1::CreateWebhookRequest& asked) {
  const absl::StatusOr<WebhookUrl> url = ParseWebhookUrl(asked.url());
  MORTISE_RETURN_IF_ERROR(
      CombineViolations(CombineViolations(url.status(), CheckStreams(webhooks, asked.streams())),
                        CombineViolations(rpc::CheckTypePrefixes(asked.type_prefixes()),
                                          resources::ValidateTags(asked))));
  MORTISE_RETURN_IF_ERROR(CheckHost(webhooks, *url));
  v1::Webhook webhook;
  webhook.set_name("webhooks/" + NewIdentifier());
  webhook.set_url(asked.url());
  *webhook.mutable_type_prefixes() = asked.type_prefixes();
  *webhook.mutable_streams() = asked.streams();
  resources::CopyTags(asked, &webhook);
  webhook.set_creator(call.identity().subject);
  MORTISE_ASSIGN_OR_RETURN(*webhook.mutable_secret(), NewSecret());
  const EventHub& hub = *webhooks.environment.hub;
  for (const std::string& stream : hub.streams()) {
    if (!asked.streams().empty() && !Has(asked.streams(), stream)) continue;
    SetCursor(webhook, stream, hub.Latest(stream).value_or(0));
  }
  return webhook;
}

absl::StatusOr<v1::Webhook> CreateWebhook(const Webhooks& webhooks, const rpc::Call&,
                                          const v1::CreateWebhookRequest&, const v1::Webhook& draft,
                                          store::Transaction& transaction) {
  v1::Webhook webhook = draft;
  *webhook.mutable_create_time() =
      TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(transaction.Now()));
  MORTISE_RETURN_IF_ERROR(PutWebhook(transaction, webhook));
  RefreshAfter(webhooks, transaction, webhook.name());
  return webhook;
}

absl::StatusOr<v1::Webhook> GetWebhook(const Webhooks& webhooks, const rpc::Call&,
                                       const v1::GetWebhookRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(v1::Webhook webhook,
                           kWebhooks.Get(*webhooks.environment.store, asked.name()));
  return WithoutSecret(std::move(webhook));
}

absl::StatusOr<v1::ListWebhooksResponse> ListWebhooks(const Webhooks& webhooks, const rpc::Call&,
                                                      const v1::ListWebhooksRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(resources::Page<v1::Webhook> page,
                           kWebhooks.List(
                               *webhooks.environment.store, asked,
                               [](const v1::Webhook&) { return true; }, WithoutSecret));
  return resources::ToResponse(std::move(page), &v1::ListWebhooksResponse::mutable_webhooks);
}

absl::StatusOr<v1::Webhook> UpdateWebhook(const Webhooks&, const rpc::Call& call,
                                          const v1::UpdateWebhookRequest& asked,
                                          store::Transaction& transaction) {
  MORTISE_ASSIGN_OR_RETURN(v1::Webhook webhook,
                           kWebhooks.UpdateTags(transaction, asked.webhook(), asked.update_mask(),
                                                "webhook", rpc::AuthorOf(call)));
  return WithoutSecret(std::move(webhook));
}

absl::StatusOr<v1::DeleteWebhookResponse> DeleteWebhook(const Webhooks& webhooks, const rpc::Call&,
                                                        const v1::DeleteWebhookRequest& asked,
                                                        store::Transaction& transaction) {
  MORTISE_RETURN_IF_ERROR(gateway::DeleteWebhook(transaction, asked.name()));
  RefreshAfter(webhooks, transaction, asked.name());
  return v1::DeleteWebhookResponse();
}

absl::StatusOr<v1::Webhook> ReplayWebhook(const Webhooks& webhooks, const rpc::Call&,
                                          const v1::ReplayWebhookRequest& asked,
                                          store::Transaction& transaction) {
  if (asked.after_number() < 0) return InvalidField("after_number", "must be at least 0");
  MORTISE_ASSIGN_OR_RETURN(v1::Webhook webhook, kWebhooks.Get(transaction, asked.name()));
  if (!Has(webhooks.environment.hub->streams(), asked.stream()) ||
      (!webhook.streams().empty() && !Has(webhook.streams(), asked.stream()))) {
    return InvalidField("stream", "the webhook does not follow a stream of this name");
  }
  if (asked.after_number() > CursorOf(webhook, asked.stream())) {
    return InvalidField("after_number", "lies ahead of what was delivered");
  }
  SetCursor(webhook, asked.stream(), asked.after_number());
  SetRetry(webhook, asked.stream(), std::nullopt);
  MORTISE_RETURN_IF_ERROR(
      ForgetDeadLetters(transaction, asked.name(), asked.stream(), asked.after_number()));
  MORTISE_RETURN_IF_ERROR(PutWebhook(transaction, webhook));
  RefreshAfter(webhooks, transaction, asked.name(), asked.stream());
  return WithoutSecret(std::move(webhook));
}

absl::StatusOr<v1::ListDeadLettersResponse> ListDeadLetters(
    const Webhooks& webhooks, const rpc::Call&, const v1::ListDeadLettersRequest& asked) {
  using Page = resources::Page<v1::ListDeadLettersResponse::DeadLetter>;
  MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
  MORTISE_ASSIGN_OR_RETURN(
      Page page, resources::ReadFrom<Page>(
                     *webhooks.environment.store,
                     [&](store::ReadTransaction& transaction) -> absl::StatusOr<Page> {
                       MORTISE_RETURN_IF_ERROR(kWebhooks.Get(transaction, asked.name()).status());
                       return PageOfDeadLetters(transaction, asked.name(), query);
                     }));
  return resources::ToResponse(std::move(page), &v1::ListDeadLettersResponse::mutable_dead_letters);
}

}  // namespace mortise::gateway::methods
