// WebhookService: subscriptions, and what could not be delivered.
#include <google/protobuf/util/time_util.h>
#include <openssl/rand.h>

#include <algorithm>
#include <memory>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/host/event_service.h"
#include "common/rpc/handler.h"
#include "common/store/store.h"
#include "gateway/admission/budget.h"
#include "gateway/forwarding/event_hub.h"
#include "gateway/forwarding/hosted_services.h"
#include "gateway/webhooks/webhook_address.h"
#include "gateway/webhooks/webhook_delivery.h"
#include "gateway/webhooks/webhook_records.h"
#include "mortise/v1/gateway.grpc.pb.h"

namespace mortise::gateway {
namespace {

using google::protobuf::util::TimeUtil;

constexpr int kLookups = 2;  // of hosts at a time

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

class WebhookAdapter final : public v1::WebhookService::CallbackService {
 public:
  explicit WebhookAdapter(const HostedEnvironment& environment)
      : environment_(environment), endpoint_(environment.dispatcher, "mortise.v1.WebhookService") {}

  grpc::ServerUnaryReactor* CreateWebhook(grpc::CallbackServerContext* context,
                                          const v1::CreateWebhookRequest* request,
                                          v1::Webhook* response) override {
    return endpoint_.PreparedMutation(
        "CreateWebhook", context, request, response,
        [this](const rpc::Call&, const v1::CreateWebhookRequest& asked) { return Draw(asked); },
        [this](const rpc::Call&, const v1::CreateWebhookRequest&, v1::Webhook& webhook,
               store::Transaction& transaction) -> absl::StatusOr<v1::Webhook> {
          *webhook.mutable_create_time() =
              TimeUtil::MicrosecondsToTimestamp(absl::ToUnixMicros(transaction.Now()));
          MORTISE_RETURN_IF_ERROR(PutWebhook(transaction, webhook));
          RefreshAfter(transaction, webhook.name());
          return webhook;
        });
  }

  grpc::ServerUnaryReactor* GetWebhook(grpc::CallbackServerContext* context,
                                       const v1::GetWebhookRequest* request,
                                       v1::Webhook* response) override {
    return endpoint_.Query(
        "GetWebhook", context, request, response,
        [this](const rpc::Call&,
               const v1::GetWebhookRequest& asked) -> absl::StatusOr<v1::Webhook> {
          v1::Webhook webhook;
          MORTISE_RETURN_IF_ERROR(
              environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
                MORTISE_ASSIGN_OR_RETURN(webhook, gateway::GetWebhook(transaction, asked.name()));
                return absl::OkStatus();
              }));
          return WithoutSecret(std::move(webhook));
        });
  }

  grpc::ServerUnaryReactor* ListWebhooks(grpc::CallbackServerContext* context,
                                         const v1::ListWebhooksRequest* request,
                                         v1::ListWebhooksResponse* response) override {
    return endpoint_.Query(
        "ListWebhooks", context, request, response,
        [this](const rpc::Call&, const v1::ListWebhooksRequest& asked) { return List(asked); });
  }

  grpc::ServerUnaryReactor* DeleteWebhook(grpc::CallbackServerContext* context,
                                          const v1::DeleteWebhookRequest* request,
                                          v1::DeleteWebhookResponse* response) override {
    return endpoint_.Mutation(
        "DeleteWebhook", context, request, response,
        [this](const rpc::Call&, const v1::DeleteWebhookRequest& asked,
               store::Transaction& transaction) -> absl::StatusOr<v1::DeleteWebhookResponse> {
          MORTISE_RETURN_IF_ERROR(gateway::DeleteWebhook(transaction, asked.name()));
          RefreshAfter(transaction, asked.name());
          return v1::DeleteWebhookResponse();
        });
  }

  grpc::ServerUnaryReactor* ReplayWebhook(grpc::CallbackServerContext* context,
                                          const v1::ReplayWebhookRequest* request,
                                          v1::Webhook* response) override {
    return endpoint_.Mutation(
        "ReplayWebhook", context, request, response,
        [this](const rpc::Call&, const v1::ReplayWebhookRequest& asked,
               store::Transaction& transaction) { return Replay(asked, transaction); });
  }

  grpc::ServerUnaryReactor* ListDeadLetters(grpc::CallbackServerContext* context,
                                            const v1::ListDeadLettersRequest* request,
                                            v1::ListDeadLettersResponse* response) override {
    return endpoint_.Query("ListDeadLetters", context, request, response,
                           [this](const rpc::Call&, const v1::ListDeadLettersRequest& asked) {
                             return ListLetters(asked);
                           });
  }

 private:
  absl::Status CheckStreams(const google::protobuf::RepeatedPtrField<std::string>& streams) const {
    const auto& known = environment_.hub->streams();
    for (int i = 0; i < streams.size(); ++i) {
      if (std::find(known.begin(), known.end(), streams[i]) == known.end()) {
        return InvalidField(absl::StrCat("streams[", i, "]"), "there is no such stream");
      }
    }
    return absl::OkStatus();
  }

  // Looking a name up may take seconds and one of the few threads of all calls: some at a time.
  absl::Status CheckHost(const WebhookUrl& url) const {
    std::unique_ptr<Budget::Share> lookup;
    if (!LiteralAddress(url.host)) {
      lookup = lookups_->Take("", 1);
      if (lookup == nullptr) return TooManyAtATime("webhooks whose hosts are looked up");
    }
    return environment_.delivery->CheckHost(url);
  }

  // The subscription as it will be stored: it begins with what comes from now on.
  absl::StatusOr<v1::Webhook> Draw(const v1::CreateWebhookRequest& asked) const {
    MORTISE_ASSIGN_OR_RETURN(const WebhookUrl url, ParseWebhookUrl(asked.url()));
    MORTISE_RETURN_IF_ERROR(CheckStreams(asked.streams()));
    MORTISE_RETURN_IF_ERROR(rpc::CheckTypePrefixes(asked.type_prefixes()));
    MORTISE_RETURN_IF_ERROR(CheckHost(url));
    v1::Webhook webhook;
    webhook.set_name("webhooks/" + NewIdentifier());
    webhook.set_url(asked.url());
    *webhook.mutable_type_prefixes() = asked.type_prefixes();
    *webhook.mutable_streams() = asked.streams();
    MORTISE_ASSIGN_OR_RETURN(*webhook.mutable_secret(), NewSecret());
    for (const std::string& stream : environment_.hub->streams()) {
      const auto& wanted = asked.streams();
      if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), stream) == wanted.end()) {
        continue;
      }
      SetCursor(webhook, stream, environment_.hub->Latest(stream).value_or(0));
    }
    return webhook;
  }

  absl::StatusOr<v1::ListWebhooksResponse> List(const v1::ListWebhooksRequest& asked) const {
    MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
    resources::Page<v1::Webhook> page;
    MORTISE_RETURN_IF_ERROR(
        environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(page, gateway::PageOfWebhooks(transaction, query));
          return absl::OkStatus();
        }));
    v1::ListWebhooksResponse response;
    for (v1::Webhook& webhook : page.entries) {
      *response.add_webhooks() = WithoutSecret(std::move(webhook));
    }
    response.set_next_page_token(page.next_page_token);
    return response;
  }

  absl::StatusOr<v1::Webhook> Replay(const v1::ReplayWebhookRequest& asked,
                                     store::Transaction& transaction) {
    if (asked.after_number() < 0) return InvalidField("after_number", "must be at least 0");
    MORTISE_ASSIGN_OR_RETURN(v1::Webhook webhook, gateway::GetWebhook(transaction, asked.name()));
    const auto& known = environment_.hub->streams();
    const auto& wanted = webhook.streams();
    if (std::find(known.begin(), known.end(), asked.stream()) == known.end() ||
        (!wanted.empty() &&
         std::find(wanted.begin(), wanted.end(), asked.stream()) == wanted.end())) {
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
    RefreshAfter(transaction, asked.name(), asked.stream());
    return WithoutSecret(std::move(webhook));
  }

  absl::StatusOr<v1::ListDeadLettersResponse> ListLetters(
      const v1::ListDeadLettersRequest& asked) const {
    MORTISE_ASSIGN_OR_RETURN(const resources::PageQuery query, resources::ReadPageQuery(asked));
    resources::Page<v1::ListDeadLettersResponse::DeadLetter> page;
    MORTISE_RETURN_IF_ERROR(
        environment_.store->Read([&](store::ReadTransaction& transaction) -> absl::Status {
          MORTISE_RETURN_IF_ERROR(gateway::GetWebhook(transaction, asked.name()).status());
          MORTISE_ASSIGN_OR_RETURN(page,
                                   gateway::PageOfDeadLetters(transaction, asked.name(), query));
          return absl::OkStatus();
        }));
    v1::ListDeadLettersResponse response;
    for (auto& letter : page.entries) *response.add_dead_letters() = std::move(letter);
    response.set_next_page_token(page.next_page_token);
    return response;
  }

  void RefreshAfter(store::Transaction& transaction, const std::string& webhook,
                    const std::string& stream = "") {
    transaction.AfterCommit([delivery = environment_.delivery, webhook, stream] {
      delivery->Refresh(webhook, stream);
    });
  }

  const HostedEnvironment environment_;
  const std::unique_ptr<Budget> lookups_ = std::make_unique<Budget>(kLookups, kLookups);
  rpc::Endpoint endpoint_;
};

}  // namespace

std::shared_ptr<grpc::Service> MakeWebhookService(const HostedEnvironment& environment) {
  return std::make_shared<WebhookAdapter>(environment);
}

}  // namespace mortise::gateway
