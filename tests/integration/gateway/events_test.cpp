// Events, operations and webhooks of a real service through the gateway.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <openssl/hmac.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/errors.h"
#include "common/jobs/operations.h"
#include "common/rpc/channel.h"
#include "common/rpc/run_service.h"
#include "common/rpc/status_mapping.h"
#include "common/store/store.h"
#include "gateway/webhook_client.h"
#include "mortise/v1/audit.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/gateway.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/integration/gateway/gateway_fixture.h"
#include "tests/support/reserved_port.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

// Takes webhooks' posts and answers with what the test says.
class Receiver {
 public:
  struct Post {
    std::map<std::string, std::string> headers;
    std::string body;
  };

  Receiver() : acceptor_(io_, {boost::asio::ip::make_address("127.0.0.1"), 0}) {
    thread_ = std::thread([this] { Serve(); });
  }

  ~Receiver() {
    stopping_ = true;
    boost::asio::io_context io;
    boost::asio::ip::tcp::socket socket(io);
    boost::system::error_code ignored;
    socket.connect(acceptor_.local_endpoint(), ignored);
    thread_.join();
  }

  std::string url() const {
    return "http://127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port()) + "/hook?x=1";
  }

  void AnswerWith(int status) { status_ = status; }

  // The next post; the test fails after ten seconds without one.
  Post Next() {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, std::chrono::seconds(10), [this] { return !posts_.empty(); })) {
      ADD_FAILURE() << "no post came";
      return {};
    }
    Post post = std::move(posts_.front());
    posts_.pop_front();
    return post;
  }

 private:
  void Serve() {
    namespace beast = boost::beast;
    namespace http = boost::beast::http;
    for (;;) {
      boost::asio::ip::tcp::socket socket(io_);
      boost::system::error_code error;
      acceptor_.accept(socket, error);
      if (stopping_) return;
      beast::flat_buffer buffer;
      http::request<http::string_body> request;
      http::read(socket, buffer, request, error);
      if (error) continue;
      Post post;
      for (const auto& field : request) {
        post.headers[std::string(field.name_string())] = std::string(field.value());
      }
      post.body = request.body();
      http::response<http::empty_body> response(static_cast<http::status>(status_.load()), 11);
      response.prepare_payload();
      http::write(socket, response, error);
      std::lock_guard lock(mutex_);
      posts_.push_back(std::move(post));
      changed_.notify_all();
    }
  }

  boost::asio::io_context io_;
  boost::asio::ip::tcp::acceptor acceptor_;
  std::atomic<int> status_{204};
  std::atomic<bool> stopping_{false};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Post> posts_;  // guarded by mutex_
  std::thread thread_;
};

// A gateway in front of a real catalog process: store, outbox, bus, operations.
class EventsTest : public GatewayTest {
 protected:
  void SetUp() override {
    gateway_options_ = Options();
    gateway_options_.services = {{"catalog", service_port_.address()}};
    gateway_options_.webhooks.first_pause = absl::Milliseconds(10);
    gateway_options_.webhooks.longest_pause = absl::Milliseconds(50);
    gateway_options_.webhooks.max_tries = 3;
    gateway_options_.webhooks.client.allow_loopback = true;
    StartGateway(gateway_options_);
    StartService();
    channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
    WaitUntilKnown();
  }

  void StartService() {
    rpc::ServiceOptions options;
    options.name = "catalog";
    options.listen = service_port_.address();
    options.store = "sqlite:" + (folder_.path() / "catalog.db").string();
    options.blobs = folder_.path() / "blobs";
    options.insecure_development = true;
    options.bus_publish = gateway_->addresses().bus_publish;
    auto service = rpc::RunningService::Start(
        options,
        [this](rpc::ServiceEnvironment& environment)
            -> absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>> {
          environment.operations->Register(
              "catalog.wait",
              [this](jobs::OperationContext& context) -> absl::StatusOr<std::string> {
                context.ReportProgress({.done = 1, .total = 2, .message = "half"});
                std::unique_lock lock(mutex_);
                if (!changed_.wait(lock, context.stop_token(), [this] { return finish_; })) {
                  return absl::CancelledError();
                }
                return std::string();
              });
          return std::vector<std::shared_ptr<grpc::Service>>();
        });
    ASSERT_TRUE(service.ok()) << service.status();
    service_ = *std::move(service);
  }

  // The gateway notices the service within moments; until then it says UNAVAILABLE.
  void WaitUntilKnown() {
    const auto stub = v1::EventService::NewStub(channel_);
    v1::ReadEventsRequest request;
    request.set_stream("catalog");
    const auto events = rpc::CallUnary(*stub, &v1::EventService::Stub::ReadEvents, request, {});
    ASSERT_TRUE(events.ok()) << events.status();
  }

  void Tell(const std::string& type, const std::string& subject) {
    const absl::Status status =
        service_->environment().store->Transact([&](store::Transaction& transaction) {
          return transaction.AppendEvent(
              {.type = type, .subject = subject, .payload = R"({"a":1})", .trace_id = "t"});
        });
    ASSERT_TRUE(status.ok()) << status;
  }

  std::string StartOperation() {
    std::string name;
    const absl::Status status = service_->environment().store->Transact(
        [&](store::Transaction& transaction) -> absl::Status {
          auto operation = service_->environment().operations->Start(
              transaction,
              {.kind = "catalog.wait", .subject = "templates/x", .creator = "users/ada"});
          if (!operation.ok()) return operation.status();
          name = operation->name;
          return absl::OkStatus();
        });
    EXPECT_TRUE(status.ok()) << status;
    return name;
  }

  void FinishOperations() {
    std::lock_guard lock(mutex_);
    finish_ = true;
    changed_.notify_all();
  }

  const mortise::testing::ReservedPort service_port_;
  GatewayOptions gateway_options_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool finish_ = false;  // guarded by mutex_
  std::unique_ptr<rpc::RunningService> service_;
  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(EventsTest, FollowsEventsOverGrpc) {
  Tell("item.created", "items/a");
  Tell("design.created", "designs/b");
  grpc::ClientContext context;
  v1::FollowEventsRequest request;
  request.add_type_prefixes("item.");
  const auto reader = v1::EventService::NewStub(channel_)->FollowEvents(&context, request);
  v1::Event event;
  ASSERT_TRUE(reader->Read(&event));
  EXPECT_EQ(event.subject(), "items/a");
  EXPECT_EQ(event.number(), 1);
  Tell("item.deleted", "items/a");
  ASSERT_TRUE(reader->Read(&event));
  EXPECT_EQ(event.type(), "item.deleted");
  EXPECT_EQ(event.number(), 3);
  context.TryCancel();
  reader->Finish();
}

TEST_F(EventsTest, StreamsEventsOverHttpAndResumes) {
  Tell("item.created", "items/a");
  Tell("item.created", "items/b");
  {
    HttpStream stream(gateway_->addresses().http, "/events?streams=catalog&after=0");
    const std::string text = stream.ReadUntil("items/b");
    EXPECT_THAT(text, HasSubstr("text/event-stream"));
    EXPECT_THAT(text, HasSubstr("id: catalog:1\nevent: item.created\ndata: {"));
    Tell("item.created", "items/c");
    EXPECT_THAT(stream.ReadUntil("items/c"), HasSubstr("id: catalog:3"));
  }
  HttpStream resumed(gateway_->addresses().http, "/events", {{"Last-Event-ID", "catalog:2"}});
  const std::string text = resumed.ReadUntil("items/c");
  EXPECT_THAT(text, HasSubstr("id: catalog:3"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("items/b")));
}

TEST_F(EventsTest, RefusesMalformedEventRequests) {
  const std::string& http = gateway_->addresses().http;
  EXPECT_EQ(Http(http, "GET", "/events?after=x").status, 400);
  EXPECT_EQ(Http(http, "GET", "/events?colour=red").status, 400);
  const HttpAnswer nobody = Http(http, "GET", "/events?streams=nobody");
  EXPECT_EQ(nobody.status, 404);
  EXPECT_EQ(Json::parse(nobody.body)["message"], "there is no stream 'nobody'");
  EXPECT_EQ(Http(http, "GET", "/events", {{"Last-Event-ID", "catalog"}}).status, 400);
}

TEST_F(EventsTest, WatchesOperations) {
  const std::string name = StartOperation();
  HttpStream stream(gateway_->addresses().http, "/" + name + "/watch");
  EXPECT_THAT(stream.ReadUntil("half"), HasSubstr("event: operation\ndata: {"));
  FinishOperations();
  EXPECT_THAT(stream.ReadUntil("SUCCEEDED"), HasSubstr("SUCCEEDED"));
  EXPECT_EQ(Http(gateway_->addresses().http, "GET", "/operations/catalog/none/watch").status, 404);

  grpc::ClientContext context;
  v1::ListOperationsResponse list;
  const grpc::Status status = v1::OperationService::NewStub(channel_)->ListOperations(
      &context, v1::ListOperationsRequest(), &list);
  ASSERT_TRUE(status.ok()) << status.error_message();
  ASSERT_EQ(list.operations_size(), 1);
  EXPECT_EQ(list.operations(0).name(), name);
}

TEST_F(EventsTest, EventsSurviveARestartOfTheService) {
  HttpStream stream(gateway_->addresses().http, "/events?after=0");
  Tell("item.created", "items/a");
  stream.ReadUntil("items/a");
  service_.reset();
  StartService();
  Tell("item.created", "items/b");
  EXPECT_THAT(stream.ReadUntil("items/b"), HasSubstr("id: catalog:2"));
}

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

  v1::ListDeadLettersResponse DeadLetters(const std::string& name) {
    grpc::ClientContext context;
    v1::ListDeadLettersRequest request;
    request.set_name(name);
    v1::ListDeadLettersResponse response;
    EXPECT_TRUE(Stub()->ListDeadLetters(&context, request, &response).ok());
    return response;
  }

  Receiver receiver_;
};

TEST_F(WebhookTest, PostsSignedEventsInOrder) {
  Tell("item.created", "items/before");
  // Known to the gateway before the webhook is made, which begins with what comes after.
  const auto events = v1::EventService::NewStub(channel_);
  const absl::Status known = rpc::CallWithRetry({}, {}, [&](grpc::ClientContext* context) {
    v1::ListStreamsResponse streams;
    const grpc::Status status = events->ListStreams(context, {}, &streams);
    if (!status.ok() || streams.streams(0).latest_number() >= 1) return status;
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "not yet");
  });
  ASSERT_TRUE(known.ok()) << known;
  const v1::Webhook webhook = Create(receiver_.url(), "item.");
  EXPECT_FALSE(webhook.secret().empty());
  for (int i = 0; i < 5; ++i) {
    Tell("item.created", "items/" + std::to_string(i));
    Tell("design.created", "designs/x");
  }
  for (int i = 0; i < 5; ++i) {
    const Receiver::Post post = receiver_.Next();
    EXPECT_EQ(Json::parse(post.body)["subject"], "items/" + std::to_string(i));
    const std::string signature = post.headers.at("mortise-signature");
    const int64_t seconds = std::stoll(signature.substr(2));
    EXPECT_EQ(signature, SignWebhook(webhook.secret(), seconds, post.body));
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
  gateway_.reset();
  const mortise::testing::ReservedPort gateway_port;
  gateway_options_.grpc = gateway_port.address();
  StartGateway(gateway_options_);
  channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
  WaitUntilKnown();
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
