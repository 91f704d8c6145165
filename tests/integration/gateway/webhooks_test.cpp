// Webhooks of a gateway in front of a real service: in order, signed, tried again, given up, set
// back; and none waits for another.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <condition_variable>
#include <future>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "gateway/webhooks/webhook_client.h"
#include "mortise/v1/audit.grpc.pb.h"
#include "mortise/v1/gateway.grpc.pb.h"
#include "tests/integration/gateway/events_fixture.h"
#include "tests/integration/gateway/holding_receiver.h"
#include "tests/integration/gateway/webhook_receiver.h"
#include "tests/unit/gateway/webhooks/name_server.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

class WebhookTest : public EventsTest {
 protected:
  v1::Webhook Create(const std::string& url, const std::string& prefix = "") {
    grpc::ClientContext context;
    v1::CreateWebhookRequest request;
    request.set_request_id("create-" + url);
    request.set_url(url);
    if (!prefix.empty()) request.add_type_prefixes(prefix);
    v1::Webhook webhook;
    const grpc::Status status = Stub()->CreateWebhook(&context, request, &webhook);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return webhook;
  }

  std::unique_ptr<v1::WebhookService::Stub> Stub() { return v1::WebhookService::NewStub(channel_); }

  v1::Webhook Get(const std::string& name) {
    grpc::ClientContext context;
    v1::GetWebhookRequest request;
    request.set_name(name);
    v1::Webhook webhook;
    const grpc::Status status = Stub()->GetWebhook(&context, request, &webhook);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return webhook;
  }

  // The webhook once it has an event that waits for another try.
  v1::Webhook GetFailed(const std::string& name) {
    v1::Webhook webhook;
    const absl::Status failed = rpc::CallWithRetry({}, {}, [&](grpc::ClientContext*) {
      webhook = Get(name);
      if (webhook.retries_size() > 0) return grpc::Status::OK;
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
    });
    EXPECT_TRUE(failed.ok()) << failed;
    return webhook;
  }

  void Delete(const std::string& name) {
    grpc::ClientContext context;
    v1::DeleteWebhookRequest request;
    request.set_request_id("delete-" + name);
    request.set_name(name);
    v1::DeleteWebhookResponse response;
    EXPECT_TRUE(Stub()->DeleteWebhook(&context, request, &response).ok());
  }

  void Replay(const std::string& name, int64_t after, const std::string& request_id) {
    grpc::ClientContext context;
    v1::ReplayWebhookRequest request;
    request.set_request_id(request_id);
    request.set_name(name);
    request.set_stream("catalog");
    request.set_after_number(after);
    v1::Webhook replayed;
    const grpc::Status status = Stub()->ReplayWebhook(&context, request, &replayed);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }

  // A gateway with other options, whose address stays over restarts, and the service on its bus.
  void RestartGateway() {
    service_.reset();
    gateway_.reset();
    gateway_options_.grpc = gateway_port_.address();
    StartGateway(gateway_options_);
    StartService();
    channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
    WaitUntilKnown();
  }

  v1::ListDeadLettersResponse DeadLetters(const std::string& name) {
    grpc::ClientContext context;
    v1::ListDeadLettersRequest request;
    request.set_name(name);
    v1::ListDeadLettersResponse response;
    EXPECT_TRUE(Stub()->ListDeadLetters(&context, request, &response).ok());
    return response;
  }

  const mortise::testing::ReservedPort gateway_port_;
  WebhookReceiver receiver_;
};

TEST_F(WebhookTest, WhatIsDoneToOthersEndsNoPause) {
  gateway_options_.webhooks.first_pause = absl::Hours(1);
  gateway_options_.webhooks.longest_pause = absl::Hours(1);
  RestartGateway();
  receiver_.AnswerWith(503);
  const v1::Webhook down = Create(receiver_.url());
  Tell("item.created", "items/a");
  receiver_.Next();
  const v1::Webhook failed = GetFailed(down.name());
  ASSERT_EQ(failed.retries_size(), 1);
  EXPECT_EQ(failed.retries(0).stream(), "catalog");
  EXPECT_EQ(failed.retries(0).number(), 1);
  EXPECT_EQ(failed.retries(0).tries(), 1);
  WebhookReceiver healthy;
  for (int i = 0; i < 12; ++i) {
    const v1::Webhook other = Create(healthy.url() + std::to_string(i), "item.");
    Replay(other.name(), 0, "replay-" + std::to_string(i));
    EXPECT_EQ(Json::parse(healthy.Next().body)["subject"], "items/a");
    Delete(other.name());
  }
  EXPECT_EQ(Get(down.name()).retries(0).SerializeAsString(), failed.retries(0).SerializeAsString());
  EXPECT_EQ(DeadLetters(down.name()).dead_letters_size(), 0);
  // Nor does a restart end it, nor another event.
  RestartGateway();
  WaitUntilSeen(1);
  const v1::Webhook other = Create(healthy.url(), "item.");
  Tell("item.created", "items/b");
  EXPECT_EQ(Json::parse(healthy.Next().body)["subject"], "items/b");
  EXPECT_EQ(Get(down.name()).retries(0).SerializeAsString(), failed.retries(0).SerializeAsString());
  // It ends where the webhook itself is set back.
  receiver_.AnswerWith(200);
  Replay(down.name(), 0, "replay-down");
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/a");
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/b");
}

TEST_F(WebhookTest, TriesAreCountedOverARestart) {
  gateway_options_.webhooks.first_pause = absl::Hours(1);
  gateway_options_.webhooks.longest_pause = absl::Hours(1);
  gateway_options_.webhooks.max_tries = 2;
  receiver_.AnswerWith(503);
  RestartGateway();
  const v1::Webhook webhook = Create(receiver_.url());
  Tell("item.created", "items/a");
  receiver_.Next();
  EXPECT_EQ(GetFailed(webhook.name()).retries(0).tries(), 1);
  // What was left of the pause is over at once where pauses are shorter now.
  gateway_options_.webhooks.longest_pause = absl::Milliseconds(1);
  RestartGateway();
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/a");
  receiver_.AnswerWith(200);
  Tell("item.created", "items/b");
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/b");
  const v1::ListDeadLettersResponse letters = DeadLetters(webhook.name());
  ASSERT_EQ(letters.dead_letters_size(), 1);
  EXPECT_EQ(letters.dead_letters(0).tries(), 2);
}

TEST_F(WebhookTest, NamesThatDoNotResolveDelayNobody) {
  NameServer names;
  gateway_options_.webhooks.client.name_servers = names.address();
  gateway_options_.webhooks.client.resolve_timeout = absl::Minutes(1);
  gateway_options_.webhooks.client.timeout = absl::Minutes(1);
  RestartGateway();
  std::set<std::string> dead;
  for (int i = 0; i < 5; ++i) {
    const std::string name = "dead-" + std::to_string(i) + ".example";
    names.Say(name, {"192.0.2.1"});
    Create("http://" + name + "/");
    names.KeepSilent(name);
    dead.insert(name);
  }
  names.Say("alive.example", {"127.0.0.1"});
  std::string url = receiver_.url();
  Create(url.replace(url.find("127.0.0.1"), 9, "alive.example"));
  Tell("item.created", "items/a");
  ASSERT_TRUE(names.WaitUntilAskedInVain(dead));
  for (const char* subject : {"items/b", "items/c"}) Tell("item.created", subject);
  for (const char* subject : {"items/a", "items/b", "items/c"}) {
    EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], subject);
  }
}

// Takes connections and says nothing.
TEST_F(WebhookTest, ReceiversThatNeverAnswerDelayNobody) {
  boost::asio::io_context io;
  boost::asio::ip::tcp::acceptor silent(io, {boost::asio::ip::make_address("127.0.0.1"), 0});
  const std::string url =
      "http://127.0.0.1:" + std::to_string(silent.local_endpoint().port()) + "/";
  gateway_options_.webhooks.client.timeout = absl::Milliseconds(100);
  gateway_options_.webhooks.max_tries = 100;
  gateway_options_.webhooks.at_once = 6;
  gateway_options_.webhooks.at_once_failing = 1;
  RestartGateway();
  std::vector<v1::Webhook> slow;
  for (int i = 0; i < 5; ++i) slow.push_back(Create(url + std::to_string(i)));
  Create(receiver_.url());
  Tell("item.created", "items/a");
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/a");
  for (const v1::Webhook& webhook : slow) GetFailed(webhook.name());
  for (int i = 0; i < 20; ++i) {
    Tell("item.created", "items/" + std::to_string(i));
    EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/" + std::to_string(i));
  }
}

// They take what they get, but by then nine seconds have passed.
TEST_F(WebhookTest, SlowReceiversDelayNobody) {
  std::atomic<int> ahead = 0;  // seconds
  HoldingReceiver slow;
  gateway_options_.webhooks.client.timeout = absl::Minutes(1);
  gateway_options_.webhooks.clock = [&ahead] { return absl::Now() + absl::Seconds(ahead.load()); };
  gateway_options_.webhooks.at_once = 5;
  gateway_options_.webhooks.at_once_failing = 1;
  RestartGateway();
  for (int i = 0; i < 5; ++i) Create(slow.url() + std::to_string(i));
  Tell("item.created", "items/a");
  slow.Take(5);
  ahead = 9;
  slow.Answer();
  Tell("item.created", "items/b");
  slow.Take(1);
  WaitUntilSeen(2);
  Create(receiver_.url());
  Tell("item.created", "items/c");
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/c");
  gateway_.reset();
}

TEST_F(WebhookTest, LookingNamesUpTakesFewThreads) {
  NameServer names;
  gateway_options_.webhooks.client.name_servers = names.address();
  gateway_options_.webhooks.client.resolve_timeout = absl::Minutes(1);
  gateway_options_.webhooks.client.timeout = absl::Minutes(1);
  RestartGateway();
  const auto create = [this](const std::string& host) {
    grpc::ClientContext context;
    v1::CreateWebhookRequest request;
    request.set_request_id("create-" + host);
    request.set_url("http://" + host + "/");
    v1::Webhook webhook;
    return rpc::FromGrpc(Stub()->CreateWebhook(&context, request, &webhook));
  };
  const std::set<std::string> silent = {"one.example", "two.example"};
  std::vector<std::future<absl::Status>> waiting;
  for (const std::string& host : silent) {
    waiting.push_back(std::async(std::launch::async, create, host));
  }
  ASSERT_TRUE(names.WaitUntilAskedInVain(silent));
  const absl::Status refused = create("three.example");
  EXPECT_EQ(DetailOf(refused).reason, "TOO_MANY_CALLS") << refused;
  EXPECT_TRUE(create("192.0.2.1").ok()) << "an address needs no looking up";
  for (const std::string& host : silent) names.Say(host, {"192.0.2.1"});
  for (auto& one : waiting) EXPECT_TRUE(one.get().ok());
  names.Say("three.example", {"192.0.2.1"});
  EXPECT_TRUE(create("three.example").ok());
}

TEST_F(WebhookTest, PostsSignedEventsInOrder) {
  Tell("item.created", "items/before");
  // Known to the gateway before the webhook is made, which begins with what comes after.
  WaitUntilSeen(1);
  const v1::Webhook webhook = Create(receiver_.url(), "item.");
  EXPECT_FALSE(webhook.secret().empty());
  for (int i = 0; i < 5; ++i) {
    Tell("item.created", "items/" + std::to_string(i));
    Tell("design.created", "designs/x");
  }
  for (int i = 0; i < 5; ++i) {
    const WebhookReceiver::Post post = receiver_.Next();
    EXPECT_EQ(Json::parse(post.body)["subject"], "items/" + std::to_string(i));
    const std::string signature = post.headers.at("mortise-signature");
    const int64_t seconds = std::stoll(signature.substr(2));
    EXPECT_EQ(signature, SignWebhook({webhook.secret()}, seconds, post.body));
    EXPECT_EQ(post.headers.at("mortise-event"), "item.created");
    EXPECT_EQ("http://" + post.headers.at("Host") + "/hook?x=1", receiver_.url());
  }
  grpc::ClientContext context;
  v1::GetWebhookRequest request;
  request.set_name(webhook.name());
  v1::Webhook seen;
  ASSERT_TRUE(Stub()->GetWebhook(&context, request, &seen).ok());
  EXPECT_EQ(seen.secret(), "") << "told once only";
}

TEST_F(WebhookTest, IsNotMadeForAnAddressThatItMayNotCall) {
  gateway_.reset();
  gateway_options_.webhooks.client.allow_loopback = false;
  StartGateway(gateway_options_);
  channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
  v1::CreateWebhookRequest request;
  request.set_request_id("create-refused");
  request.set_url(receiver_.url());
  grpc::ClientContext context;
  v1::Webhook webhook;
  const absl::Status status = rpc::FromGrpc(Stub()->CreateWebhook(&context, request, &webhook));
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << status;
  EXPECT_EQ(DetailOf(status).field, "url") << status;
  grpc::ClientContext listing;
  v1::ListWebhooksResponse response;
  ASSERT_TRUE(Stub()->ListWebhooks(&listing, {}, &response).ok());
  EXPECT_EQ(response.webhooks_size(), 0);
}

TEST_F(WebhookTest, TriesAgainGivesUpAndReplays) {
  receiver_.AnswerWith(500);
  const v1::Webhook webhook = Create(receiver_.url());
  Tell("item.created", "items/a");
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/a") << "try " << i;
  }
  receiver_.AnswerWith(200);
  Tell("item.created", "items/b");
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/b");
  const v1::ListDeadLettersResponse letters = DeadLetters(webhook.name());
  ASSERT_EQ(letters.dead_letters_size(), 1);
  EXPECT_EQ(letters.dead_letters(0).number(), 1);
  EXPECT_EQ(letters.dead_letters(0).tries(), 3);
  EXPECT_THAT(letters.dead_letters(0).error(), HasSubstr("500"));

  grpc::ClientContext context;
  v1::ReplayWebhookRequest request;
  request.set_request_id("replay-1");
  request.set_name(webhook.name());
  request.set_stream("catalog");
  v1::Webhook replayed;
  const grpc::Status status = Stub()->ReplayWebhook(&context, request, &replayed);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/a");
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/b");
  EXPECT_EQ(DeadLetters(webhook.name()).dead_letters_size(), 0);
}

TEST_F(WebhookTest, GoesOnAfterARestartOfTheGateway) {
  receiver_.AnswerWith(500);
  gateway_options_.webhooks.max_tries = 1000;
  RestartGateway();
  Create(receiver_.url());
  Tell("item.created", "items/a");
  receiver_.Next();
  gateway_.reset();
  receiver_.AnswerWith(200);
  StartGateway(gateway_options_);
  EXPECT_EQ(Json::parse(receiver_.Next().body)["subject"], "items/a");
}

TEST_F(WebhookTest, RefusesBadSubscriptionsAndEndsThem) {
  for (const char* url :
       {"", "ftp://x/", "http://", "http://user@host/", "https://host:99999999/"}) {
    grpc::ClientContext context;
    v1::CreateWebhookRequest request;
    request.set_request_id(std::string("bad-") + url);
    request.set_url(url);
    v1::Webhook webhook;
    EXPECT_EQ(Stub()->CreateWebhook(&context, request, &webhook).error_code(),
              grpc::StatusCode::INVALID_ARGUMENT)
        << url;
  }
  v1::CreateWebhookRequest long_prefix;
  long_prefix.set_request_id("long-prefix");
  long_prefix.set_url(receiver_.url());
  long_prefix.add_type_prefixes(std::string(257, 'x'));
  grpc::ClientContext refused_context;
  v1::Webhook refused;
  const absl::Status status_of_long =
      rpc::FromGrpc(Stub()->CreateWebhook(&refused_context, long_prefix, &refused));
  EXPECT_EQ(DetailOf(status_of_long).field, "type_prefixes[0]") << status_of_long;
  const v1::Webhook webhook = Create(receiver_.url());
  grpc::ClientContext context;
  v1::DeleteWebhookRequest request;
  request.set_request_id("delete-1");
  request.set_name(webhook.name());
  v1::DeleteWebhookResponse response;
  EXPECT_TRUE(Stub()->DeleteWebhook(&context, request, &response).ok());
  grpc::ClientContext audit_context;
  v1::ListAuditRecordsRequest audit_request;
  audit_request.set_service("gateway");
  v1::ListAuditRecordsResponse records;
  const grpc::Status status = v1::AuditService::NewStub(channel_)->ListAuditRecords(
      &audit_context, audit_request, &records);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(records.records_size(), 2);
  EXPECT_THAT(records.records(0).method(), HasSubstr("DeleteWebhook"));
}

}  // namespace
}  // namespace mortise::gateway
