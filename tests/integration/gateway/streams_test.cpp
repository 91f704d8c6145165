// Streams and waiting calls: how many there may be, what they leave to others, and how they end.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include <deque>
#include <thread>

#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;

// A call whose client neither reads nor leaves.
template <class Stream>
struct Held {
  std::unique_ptr<grpc::ClientContext> context = std::make_unique<grpc::ClientContext>();
  std::unique_ptr<Stream> stream;
};

// Calls that are not answered before they are cancelled, which the end of this does.
class SlowCalls {
 public:
  SlowCalls(const std::shared_ptr<grpc::Channel>& channel, int count) : contexts_(count) {
    for (grpc::ClientContext& context : contexts_) {
      threads_.emplace_back([channel, &context] {
        v1::GetItemRequest request;
        request.set_name("items/slow");
        v1::Item item;
        (void)v1::CatalogService::NewStub(channel)->GetItem(&context, request, &item);
      });
    }
  }
  ~SlowCalls() {
    for (grpc::ClientContext& context : contexts_) context.TryCancel();
    for (std::thread& thread : threads_) thread.join();
  }

 private:
  std::deque<grpc::ClientContext> contexts_;
  std::vector<std::thread> threads_;
};

class StreamsTest : public GatewayTest {
 protected:
  void StartAndConnect(const GatewayOptions& options) {
    StartGateway(options);
    channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
  }

  Held<grpc::ClientReader<v1::Event>> Follow() {
    Held<grpc::ClientReader<v1::Event>> held;
    v1::FollowEventsRequest request;
    request.set_after_number(-1);
    held.stream = v1::EventService::NewStub(channel_)->FollowEvents(held.context.get(), request);
    return held;
  }

  grpc::Status GetItem() {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    v1::GetItemRequest request;
    request.set_name("items/echo");
    v1::Item item;
    return v1::CatalogService::NewStub(channel_)->GetItem(&context, request, &item);
  }

  grpc::Status Hold() {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    v1::HoldWorkOrderRequest request;
    request.set_name("workOrders/1");
    request.set_request_id("hold-1");
    v1::WorkOrder order;
    return v1::FabPlannerService::NewStub(channel_)->HoldWorkOrder(&context, request, &order);
  }

  HttpAnswer ListStreams() {
    return Http(gateway_->addresses().http, "POST", "/mortise.v1.EventService/ListStreams",
                {{"Content-Type", "application/json"}}, "{}");
  }

  std::unique_ptr<HttpStream> Events() {
    return std::make_unique<HttpStream>(gateway_->addresses().http, "/events");
  }

  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(StreamsTest, ASubjectHasSoManyAndNoMore) {
  GatewayOptions options = Options();
  options.open_calls.streams.of_subject = 3;
  StartAndConnect(options);
  std::vector<std::unique_ptr<HttpStream>> streams;
  for (int i = 0; i < 3; ++i) {
    streams.push_back(Events());
    EXPECT_THAT(streams.back()->ReadUntil(": open"), HasSubstr("200 OK"));
  }
  HttpAnswer refused = Http(gateway_->addresses().http, "GET", "/events");
  EXPECT_EQ(refused.status, 429) << refused.body;
  EXPECT_THAT(refused.body, HasSubstr("users/developer has 3 streams open"));
  EXPECT_EQ(refused.headers.at("retry-after"), "1");
  const auto fourth = Follow();
  v1::Event event;
  EXPECT_FALSE(fourth.stream->Read(&event));
  const absl::Status status = rpc::FromGrpc(fourth.stream->Finish());
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(DetailOf(status).reason, "TOO_MANY_STREAMS");
  EXPECT_EQ(ListStreams().status, 200) << "calls are counted apart";
  EXPECT_TRUE(GetItem().ok());

  // Who ends one may begin another.
  streams.front()->Close();
  std::string answer;
  for (int i = 0; i < 1000 && answer.find("200 OK") == std::string::npos; ++i) {
    answer = Events()->ReadUntil("\r\n\r\n");
  }
  EXPECT_THAT(answer, HasSubstr("200 OK"));
}

TEST_F(StreamsTest, EventStreamsLeaveConnectionsToCalls) {
  GatewayOptions options = Options();
  options.most_connections = 4;
  StartAndConnect(options);
  const auto first = Events();
  first->ReadUntil(": open");
  // Of four connections two are for streams, and one subject has half of these.
  const HttpAnswer refused = Http(gateway_->addresses().http, "GET", "/events");
  EXPECT_EQ(refused.status, 429) << refused.body;
  EXPECT_EQ(refused.headers.at("retry-after"), "1");
  EXPECT_EQ(ListStreams().status, 200);
}

// Each connection to the service below takes two calls, and no more is ever said.
class NarrowHouseTest : public StreamsTest {
 protected:
  void SetUp() override {
    GatewayOptions options = Options();
    for (auto& [name, address] : options.services) address = narrow_.address();
    StartAndConnect(options);
  }

  FakeHouse narrow_{2};
};

TEST_F(NarrowHouseTest, StreamsTakeNothingFromCalls) {
  std::vector<Held<grpc::ClientReader<v1::Chunk>>> streams(20);
  v1::ExportDesignRequest request;
  request.set_name("templates/endless");
  const auto catalog = v1::CatalogService::NewStub(channel_);
  for (auto& held : streams) held.stream = catalog->ExportDesign(held.context.get(), request);
  ASSERT_TRUE(narrow_.WaitForWritten(2));
  for (int i = 0; i < 4; ++i) EXPECT_TRUE(GetItem().ok());
  for (auto& held : streams) held.context->TryCancel();
}

TEST_F(NarrowHouseTest, HoldingIsNeverKeptWaiting) {
  const SlowCalls calls(channel_, 20);
  ASSERT_TRUE(narrow_.WaitForSlow(4)) << "as many as two connections take";
  const grpc::Status held = Hold();
  EXPECT_TRUE(held.ok()) << held.error_message();
}

TEST_F(StreamsTest, ACallTooManyIsToldSo) {
  GatewayOptions options = Options();
  options.open_calls.calls = {1, 1};
  StartAndConnect(options);
  const SlowCalls slow(channel_, 1);
  ASSERT_TRUE(house_.WaitForSlow(1));
  EXPECT_EQ(DetailOf(rpc::FromGrpc(GetItem())).reason, "TOO_MANY_CALLS");
  EXPECT_TRUE(Hold().ok());
}

// Tokens that are good for three seconds.
class ExpiringTest : public StreamsTest {
 protected:
  void SetUp() override {
    StartAndConnect(ShortOptions());
    header_ = Header(absl::Seconds(3));
  }

  GatewayOptions ShortOptions() const {
    GatewayOptions options = SecureOptions(signer_);
    options.token.leeway = absl::ZeroDuration();
    return options;
  }

  // A token that is good for so long.
  std::string Header(absl::Duration life) const {
    return "Bearer " +
           signer_.Sign({{"sub", "ada"},
                         {"roles", {"operator"}},
                         {"exp", absl::ToDoubleSeconds(absl::Now() + life - absl::UnixEpoch())}});
  }

  static void ExpectExpired(const grpc::Status& status) {
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("token expired"));
  }

  const TokenSigner signer_{"EdDSA"};
  std::string header_;
};

TEST_F(ExpiringTest, EventStreamsEndWithTheirToken) {
  HttpStream stream(gateway_->addresses().http, "/events", {{"Authorization", header_}});
  const std::string text = stream.ReadUntil("unauthenticated");
  EXPECT_THAT(text, HasSubstr("200 OK"));
  EXPECT_THAT(text, HasSubstr("event: error\ndata: {\"code\":\"unauthenticated\",\"message\":"
                              "\"the token expired"));
}

TEST_F(ExpiringTest, StreamsOverGrpcEndWithTheirToken) {
  Held<grpc::ClientReader<v1::Event>> events;
  events.context->AddMetadata("authorization", header_);
  events.stream = v1::EventService::NewStub(channel_)->FollowEvents(events.context.get(), {});
  Held<grpc::ClientReaderWriter<v1::BridgeMessage, v1::PlannerMessage>> bridge;
  bridge.context->AddMetadata("authorization", header_);
  bridge.stream = v1::FabPlannerService::NewStub(channel_)->AttachBridge(bridge.context.get());
  v1::PlannerMessage welcome;
  EXPECT_TRUE(bridge.stream->Read(&welcome));
  v1::Event event;
  while (events.stream->Read(&event)) {
  }
  ExpectExpired(events.stream->Finish());
  EXPECT_FALSE(bridge.stream->Read(&welcome));
  ExpectExpired(bridge.stream->Finish());
}

// One stream for each subject and door, and clients that take nothing of what is sent.
class UnreadTest : public ExpiringTest {
 protected:
  void SetUp() override {
    GatewayOptions options = ShortOptions();
    options.open_calls.streams.of_subject = 1;
    options.most_connections = 4;  // two of them for streams, one of these for a subject
    StartAndConnect(options);
    header_ = Header(absl::Seconds(1));
    fresh_ = Header(absl::Seconds(600));
  }

  // Whether the same subject gets a stream before twenty seconds are over.
  bool GetsAPlace() {
    const absl::Time end = absl::Now() + absl::Seconds(20);
    while (absl::Now() < end) {
      HttpStream stream(gateway_->addresses().http, "/events", {{"Authorization", fresh_}});
      if (stream.ReadUntil("\r\n\r\n").find("200 OK") != std::string::npos) return true;
    }
    return false;
  }

  std::string fresh_;
};

TEST_F(UnreadTest, StreamsOverGrpcGiveTheirPlaceBack) {
  Held<grpc::ClientReader<v1::Chunk>> held;
  held.context->AddMetadata("authorization", header_);
  v1::ExportDesignRequest request;
  request.set_name("templates/endless");
  held.stream = v1::CatalogService::NewStub(channel_)->ExportDesign(held.context.get(), request);
  ASSERT_TRUE(house_.WaitForWritten(1));
  EXPECT_TRUE(GetsAPlace());
}

TEST_F(UnreadTest, StreamsOverHttpGiveTheirPlaceBack) {
  const std::string message = R"({"name":"templates/endless"})";
  const std::string envelope = std::string(4, '\0') + static_cast<char>(message.size()) + message;
  const auto held = HttpStream::Send(
      gateway_->addresses().http,
      "POST /mortise.v1.CatalogService/ExportDesign HTTP/1.1\r\nHost: 127.0.0.1\r\n"
      "Content-Type: application/connect+json\r\nAuthorization: " +
          header_ + "\r\nContent-Length: " + std::to_string(envelope.size()) + "\r\n\r\n" +
          envelope);
  ASSERT_TRUE(house_.WaitForWritten(1));
  EXPECT_TRUE(GetsAPlace());
}

TEST_F(ExpiringTest, AClientsOwnDeadlineStaysItsOwn) {
  Held<grpc::ClientReader<v1::Event>> events;
  events.context->AddMetadata("authorization", header_);
  events.context->set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(50));
  events.stream = v1::EventService::NewStub(channel_)->FollowEvents(events.context.get(), {});
  EXPECT_EQ(events.stream->Finish().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
}

}  // namespace
}  // namespace mortise::gateway
