// Webhooks that are changed, tried, and given another secret or authority while they are there.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <nlohmann/json.hpp>

#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/rpc/status_mapping.h"
#include "gateway/webhooks/webhook_client.h"
#include "mortise/v1/gateway.grpc.pb.h"
#include "tests/integration/gateway/events_fixture.h"
#include "tests/integration/gateway/webhook_receiver.h"
#include "tests/support/status_assertions.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using ::testing::UnorderedElementsAre;
using Stub = v1::WebhookService::Stub;

class WebhookChangesTest : public EventsTest {
 protected:
  template <class Request, class Response>
  absl::StatusOr<Response> Call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&,
                                                             Response*),
                                const Request& request) {
    const auto stub = v1::WebhookService::NewStub(channel_);
    return rpc::CallUnary(*stub, method, request, {});
  }

  v1::Webhook Create(const std::string& url) {
    v1::CreateWebhookRequest request;
    request.set_request_id("create-1");
    request.set_url(url);
    const auto webhook = Call(&Stub::CreateWebhook, request);
    EXPECT_TRUE(webhook.ok()) << webhook.status();
    return webhook.value_or(v1::Webhook());
  }

  absl::StatusOr<v1::Webhook> Update(v1::Webhook changes, const std::vector<std::string>& mask) {
    v1::UpdateWebhookRequest request;
    request.set_request_id("update-" + std::to_string(++updates_));
    *request.mutable_webhook() = std::move(changes);
    for (const std::string& path : mask) request.mutable_update_mask()->add_paths(path);
    return Call(&Stub::UpdateWebhook, request);
  }

  v1::TestWebhookResponse Try(const std::string& name) {
    v1::TestWebhookRequest request;
    request.set_name(name);
    const auto tried = Call(&Stub::TestWebhook, request);
    EXPECT_TRUE(tried.ok()) << tried.status();
    return tried.value_or(v1::TestWebhookResponse());
  }

  absl::StatusOr<v1::Webhook> Rotate(const std::string& name, int64_t overlap_seconds) {
    v1::RotateWebhookSecretRequest request;
    request.set_request_id("rotate-" + std::to_string(++updates_));
    request.set_name(name);
    request.mutable_overlap()->set_seconds(overlap_seconds);
    return Call(&Stub::RotateWebhookSecret, request);
  }

  int updates_ = 0;
  WebhookReceiver receiver_;
};

int64_t SecondsOf(const WebhookReceiver::Post& post) {
  return std::stoll(post.headers.at("mortise-signature").substr(2));
}

TEST_F(WebhookChangesTest, EventsGoToTheNewAddressAndOfTheNewTypes) {
  v1::Webhook webhook = Create("http://127.0.0.1:1/gone");
  v1::Webhook changes;
  changes.set_name(webhook.name());
  changes.set_url(receiver_.url());
  changes.add_type_prefixes("item.");
  const auto updated = Update(changes, {"url", "type_prefixes"});
  ASSERT_OK(updated);
  EXPECT_EQ(updated->url(), receiver_.url());
  EXPECT_EQ(updated->secret(), "");
  Tell("design.created", "designs/x");
  Tell("item.created", "items/a");
  Tell("item.created", "items/b");
  for (const char* subject : {"items/a", "items/b"}) {
    const WebhookReceiver::Post post = receiver_.Next();
    EXPECT_EQ(nlohmann::json::parse(post.body)["subject"], subject);
    EXPECT_EQ(post.headers.at("mortise-signature"),
              SignWebhook({webhook.secret()}, SecondsOf(post), post.body));
  }
}

TEST_F(WebhookChangesTest, FaultyChangesChangeNothing) {
  const v1::Webhook webhook = Create(receiver_.url());
  v1::Webhook changes;
  changes.set_name(webhook.name());
  changes.set_url("ftp://x/");
  changes.add_streams("nobody");
  changes.set_certificate_authority("no certificate");
  const auto refused = Update(changes, {"url", "streams", "certificate_authority"});
  std::vector<std::string> fields;
  for (const FieldViolation& fault : AllViolationsOf(refused.status()))
    fields.push_back(fault.field);
  EXPECT_THAT(fields, UnorderedElementsAre("webhook.url", "webhook.streams[0]",
                                           "webhook.certificate_authority"));
  changes.set_url("http://169.254.169.254/");
  EXPECT_EQ(DetailOf(Update(changes, {"url"}).status()).field, "webhook.url");
  EXPECT_EQ(DetailOf(Update(changes, {"secret"}).status()).field, "update_mask");
  changes.set_name("webhooks/none");
  changes.set_url(receiver_.url());
  EXPECT_TRUE(absl::IsNotFound(Update(changes, {"url"}).status()));
  EXPECT_TRUE(Try(webhook.name()).delivered());
}

TEST_F(WebhookChangesTest, ATryTellsWhatCameOfIt) {
  const v1::Webhook webhook = Create(receiver_.url());
  EXPECT_TRUE(Try(webhook.name()).delivered());
  const WebhookReceiver::Post post = receiver_.Next();
  EXPECT_EQ(post.headers.at("mortise-event"), "webhook.test");
  EXPECT_EQ(nlohmann::json::parse(post.body)["subject"], webhook.name());
  EXPECT_EQ(post.headers.at("mortise-signature"),
            SignWebhook({webhook.secret()}, SecondsOf(post), post.body));
  receiver_.AnswerWith(418);
  const v1::TestWebhookResponse failed = Try(webhook.name());
  EXPECT_FALSE(failed.delivered());
  EXPECT_THAT(failed.error(), HasSubstr("418"));
  v1::TestWebhookRequest nobody;
  nobody.set_name("webhooks/none");
  EXPECT_TRUE(absl::IsNotFound(Call(&Stub::TestWebhook, nobody).status()));
}

TEST_F(WebhookChangesTest, ForATimeBothSecretsSign) {
  const v1::Webhook webhook = Create(receiver_.url());
  const auto rotated = Rotate(webhook.name(), 3600);
  ASSERT_OK(rotated);
  EXPECT_NE(rotated->secret(), webhook.secret());
  EXPECT_EQ(rotated->previous_secret(), "");
  EXPECT_TRUE(rotated->has_previous_secret_end_time());
  Try(webhook.name());
  const WebhookReceiver::Post both = receiver_.Next();
  EXPECT_EQ(both.headers.at("mortise-signature"),
            SignWebhook({rotated->secret(), webhook.secret()}, SecondsOf(both), both.body));
  v1::GetWebhookRequest get;
  get.set_name(webhook.name());
  const auto seen = Call(&Stub::GetWebhook, get);
  ASSERT_OK(seen);
  EXPECT_EQ(seen->secret() + seen->previous_secret(), "") << "told once only";

  const auto at_once = Rotate(webhook.name(), 0);
  ASSERT_OK(at_once);
  Try(webhook.name());
  const WebhookReceiver::Post one = receiver_.Next();
  EXPECT_EQ(one.headers.at("mortise-signature"),
            SignWebhook({at_once->secret()}, SecondsOf(one), one.body));
  for (const int64_t overlap : {int64_t{-1}, int64_t{8 * 24 * 3600}, INT64_MAX}) {
    EXPECT_EQ(DetailOf(Rotate(webhook.name(), overlap).status()).field, "overlap") << overlap;
  }
}

TEST_F(WebhookChangesTest, APrivateAuthorityIsTrustedByItsWebhookAlone) {
  const mortise::testing::SelfSigned own;
  WebhookReceiver secure(own);
  const v1::Webhook webhook = Create(secure.url());
  const v1::TestWebhookResponse untrusted = Try(webhook.name());
  EXPECT_FALSE(untrusted.delivered());
  EXPECT_THAT(untrusted.error(), HasSubstr("TLS failed"));
  v1::Webhook changes;
  changes.set_name(webhook.name());
  changes.set_certificate_authority(own.certificate);
  ASSERT_OK(Update(changes, {"certificate_authority"}));
  EXPECT_TRUE(Try(webhook.name()).delivered());
  EXPECT_EQ(secure.Next().headers.at("mortise-event"), "webhook.test");
  const mortise::testing::SelfSigned other;
  changes.set_certificate_authority(other.certificate);
  ASSERT_OK(Update(changes, {"certificate_authority"}));
  EXPECT_FALSE(Try(webhook.name()).delivered());
}

TEST_F(WebhookChangesTest, StreamsThatAreWantedNoMoreAreForgotten) {
  const v1::Webhook webhook = Create(receiver_.url());
  ASSERT_EQ(webhook.cursors_size(), 1);
  Tell("item.created", "items/a");
  receiver_.Next();
  v1::Webhook changes;
  changes.set_name(webhook.name());
  changes.add_streams("catalog");
  const auto kept = Update(changes, {"streams"});
  ASSERT_OK(kept);
  EXPECT_EQ(kept->cursors_size(), 1);
  Tell("item.created", "items/b");
  EXPECT_EQ(nlohmann::json::parse(receiver_.Next().body)["subject"], "items/b");
}

}  // namespace
}  // namespace mortise::gateway
