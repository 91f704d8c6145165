#include "gateway/webhooks/webhook_methods.h"

#include <google/protobuf/field_mask.pb.h>
#include <google/protobuf/util/time_util.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/names/offered_names.h"
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

using google::protobuf::FieldMask;
using google::protobuf::util::TimeUtil;
using Streams = google::protobuf::RepeatedPtrField<std::string>;

// For how long the secret before signs beside a new one.
constexpr absl::Duration kUsualOverlap = absl::Hours(24);
constexpr absl::Duration kLongestOverlap = absl::Hours(7 * 24);

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
  webhook.clear_previous_secret();
  return webhook;
}

template <typename Names>
bool Has(const Names& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

absl::Status CheckStreams(const Webhooks& webhooks, const Streams& streams) {
  for (int i = 0; i < streams.size(); ++i) {
    const std::vector<std::string>& known = webhooks.environment.hub->streams();
    if (!Has(known, streams[i])) {
      return InvalidField(absl::StrCat("streams[", i, "]"),
                          absl::StrCat("there is no such stream", NamesOffered(streams[i], known)));
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

// What may be asked of a subscription, whoever makes or changes it.
absl::Status CheckWishes(const Webhooks& webhooks, const Streams& streams, const Streams& prefixes,
                         const std::string& authority) {
  return CombineViolations(
      CombineViolations(CheckStreams(webhooks, streams), rpc::CheckTypePrefixes(prefixes)),
      CheckCertificateAuthority(authority));
}

// What an update may change besides external ids and labels.
constexpr std::array<const char*, 4> kChangeable = {"url", "type_prefixes", "streams",
                                                    "certificate_authority"};

// The part of a mask that is of external ids and labels; what else it names is refused there.
FieldMask TagsOf(const FieldMask& mask) {
  FieldMask tags;
  for (const std::string& path : mask.paths()) {
    if (!Has(kChangeable, path)) tags.add_paths(path);
  }
  return tags;
}

// Begins streams that are wanted from now on, and forgets those that are not.
absl::Status ChangeStreams(const Webhooks& webhooks, const Streams& streams, v1::Webhook& webhook,
                           store::Transaction& transaction) {
  const EventHub& hub = *webhooks.environment.hub;
  for (const std::string& stream : hub.streams()) {
    const bool wanted = webhook.streams().empty() || Has(webhook.streams(), stream);
    const bool wants = streams.empty() || Has(streams, stream);
    if (wants && !wanted) SetCursor(webhook, stream, hub.Latest(stream).value_or(0));
    if (wants || !wanted) continue;
    RemoveCursor(webhook, stream);
    SetRetry(webhook, stream, std::nullopt);
    MORTISE_RETURN_IF_ERROR(ForgetDeadLetters(transaction, webhook.name(), stream, 0));
  }
  *webhook.mutable_streams() = streams;
  return absl::OkStatus();
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
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      CombineViolations(url.status(), CheckWishes(webhooks, asked.streams(), asked.type_prefixes(),
                                                  asked.certificate_authority())),
      resources::ValidateTags(asked)));
  MORTISE_RETURN_IF_ERROR(CheckHost(webhooks, *url));
  v1::Webhook webhook;
  webhook.set_name("webhooks/" + NewIdentifier());
  webhook.set_url(asked.url());
  *webhook.mutable_type_prefixes() = asked.type_prefixes();
  *webhook.mutable_streams() = asked.streams();
  webhook.set_certificate_authority(asked.certificate_authority());
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

absl::StatusOr<v1::UpdateWebhookRequest> CheckUpdate(const Webhooks& webhooks, const rpc::Call&,
                                                     const v1::UpdateWebhookRequest& asked) {
  const auto names = [&](const char* field) { return Has(asked.update_mask().paths(), field); };
  v1::Webhook changed;  // with what is changed alone
  if (names("type_prefixes")) {
    *changed.mutable_type_prefixes() = asked.webhook().type_prefixes();
  }
  if (names("streams")) *changed.mutable_streams() = asked.webhook().streams();
  if (names("certificate_authority")) {
    changed.set_certificate_authority(asked.webhook().certificate_authority());
  }
  absl::Status faults = CheckWishes(webhooks, changed.streams(), changed.type_prefixes(),
                                    changed.certificate_authority());
  if (!names("url")) {
    MORTISE_RETURN_IF_ERROR(UnderField("webhook", faults));
    return asked;
  }
  const absl::StatusOr<WebhookUrl> url = ParseWebhookUrl(asked.webhook().url());
  MORTISE_RETURN_IF_ERROR(UnderField("webhook", CombineViolations(url.status(), faults)));
  MORTISE_RETURN_IF_ERROR(UnderField("webhook", CheckHost(webhooks, *url)));
  return asked;
}

absl::StatusOr<v1::Webhook> UpdateWebhook(const Webhooks& webhooks, const rpc::Call& call,
                                          const v1::UpdateWebhookRequest& asked,
                                          const v1::UpdateWebhookRequest& checked,
                                          store::Transaction& transaction) {
  const FieldMask& mask = asked.update_mask();
  const FieldMask tags = TagsOf(mask);
  // An empty mask means all tags; one of other fields alone means none.
  const bool changes_tags = mask.paths().empty() || !tags.paths().empty();
  v1::Webhook webhook;
  if (changes_tags) {
    MORTISE_ASSIGN_OR_RETURN(webhook, kWebhooks.UpdateTags(transaction, asked.webhook(), tags,
                                                           "webhook", rpc::AuthorOf(call)));
  } else {
    MORTISE_ASSIGN_OR_RETURN(webhook,
                             kWebhooks.Get(transaction, asked.webhook().name(), "webhook.name"));
  }
  if (tags.paths_size() == mask.paths_size()) return WithoutSecret(std::move(webhook));
  const v1::Webhook& changes = checked.webhook();
  const auto names = [&](const char* field) { return Has(mask.paths(), field); };
  if (names("url")) webhook.set_url(changes.url());
  if (names("type_prefixes")) *webhook.mutable_type_prefixes() = changes.type_prefixes();
  if (names("certificate_authority")) {
    webhook.set_certificate_authority(changes.certificate_authority());
  }
  if (names("streams")) {
    MORTISE_RETURN_IF_ERROR(ChangeStreams(webhooks, changes.streams(), webhook, transaction));
  }
  MORTISE_RETURN_IF_ERROR(PutWebhook(transaction, webhook));
  // A receiver elsewhere is asked at once, whatever the one before did.
  RefreshAfter(webhooks, transaction, webhook.name());
  return WithoutSecret(std::move(webhook));
}

absl::StatusOr<v1::TestWebhookResponse> TestWebhook(const Webhooks& webhooks, const rpc::Call&,
                                                    const v1::TestWebhookRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(const v1::Webhook webhook,
                           kWebhooks.Get(*webhooks.environment.store, asked.name()));
  const std::unique_ptr<Budget::Share> turn = webhooks.tests->Take("", 1);
  if (turn == nullptr) return TooManyAtATime("webhooks that are tried");
  const absl::Time begin = absl::Now();
  const absl::Status delivered = webhooks.environment.delivery->Test(webhook);
  v1::TestWebhookResponse response;
  response.set_delivered(delivered.ok());
  response.set_error(std::string(delivered.message()));
  *response.mutable_duration() =
      TimeUtil::MicrosecondsToDuration(absl::ToInt64Microseconds(absl::Now() - begin));
  return response;
}

absl::StatusOr<v1::Webhook> RotateWebhookSecret(const Webhooks& webhooks, const rpc::Call&,
                                                const v1::RotateWebhookSecretRequest& asked,
                                                store::Transaction& transaction) {
  absl::Duration overlap = kUsualOverlap;
  if (asked.has_overlap()) {
    overlap = absl::Seconds(asked.overlap().seconds()) + absl::Nanoseconds(asked.overlap().nanos());
  }
  if (overlap < absl::ZeroDuration() || overlap > kLongestOverlap) {
    return InvalidField("overlap", "must be 0 to 7 days");
  }
  MORTISE_ASSIGN_OR_RETURN(v1::Webhook webhook, kWebhooks.Get(transaction, asked.name()));
  webhook.clear_previous_secret();
  webhook.clear_previous_secret_end_time();
  if (overlap > absl::ZeroDuration()) {
    webhook.set_previous_secret(webhook.secret());
    *webhook.mutable_previous_secret_end_time() =
        TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(transaction.Now() + overlap));
  }
  MORTISE_ASSIGN_OR_RETURN(*webhook.mutable_secret(), NewSecret());
  MORTISE_RETURN_IF_ERROR(PutWebhook(transaction, webhook));
  RefreshAfter(webhooks, transaction, webhook.name());
  webhook.clear_previous_secret();
  return webhook;
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
