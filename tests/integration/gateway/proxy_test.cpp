// gRPC through the gateway: what goes in on one side comes out on the other.
#include <gmock/gmock.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <chrono>
#include <future>
#include <thread>

#include "common/base/errors.h"
#include "common/rpc/identity.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/gateway.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/gateway/gateway_fixture.h"
#include "tests/support/reserved_port.h"
#include "tests/unit/gateway/contract/token_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;

std::string Value(const std::multimap<grpc::string_ref, grpc::string_ref>& metadata,
                  const char* key) {
  const auto found = metadata.find(key);
  return found == metadata.end() ? "" : std::string(found->second.data(), found->second.size());
}

class ProxyTest : public GatewayTest {
 protected:
  void SetUp() override {
    StartGateway(Options());
    channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
  }

  std::unique_ptr<v1::CatalogService::Stub> Catalog() {
    return v1::CatalogService::NewStub(channel_);
  }

  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(ProxyTest, PassesMetadataBothWays) {
  grpc::ClientContext context;
  context.AddMetadata("x-custom", "blue");
  context.AddMetadata("x-blob-bin", "a_b");
  context.AddMetadata("x-request-id", "request-7");
  context.AddMetadata("mortise-trace-id", "forged");
  context.AddMetadata("mortise-identity-bin", "forged");
  v1::GetItemRequest request;
  request.set_name("items/echo");
  v1::Item item;
  const grpc::Status status = Catalog()->GetItem(&context, request, &item);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(item.title(), "blue");
  EXPECT_EQ(item.material(), "a_b");
  EXPECT_EQ(item.supplier(), "request-7");
  EXPECT_EQ(item.supplier_number(), "trace") << "a client's own identity is stripped";
  EXPECT_EQ(Value(context.GetServerInitialMetadata(), "x-lead"), "first");
  EXPECT_EQ(Value(context.GetServerInitialMetadata(), "x-request-id"), "request-7");
  EXPECT_EQ(Value(context.GetServerTrailingMetadata(), "x-trail"), "last");
}

TEST_F(ProxyTest, MakesARequestIdWhereNoneOrABadOneCame) {
  for (const char* given : {"", "has space", "x\"y"}) {
    grpc::ClientContext context;
    if (*given != '\0') context.AddMetadata("x-request-id", given);
    v1::GetItemRequest request;
    request.set_name("items/echo");
    v1::Item item;
    ASSERT_TRUE(Catalog()->GetItem(&context, request, &item).ok());
    EXPECT_EQ(item.supplier().size(), 26u);
    EXPECT_EQ(Value(context.GetServerInitialMetadata(), "x-request-id"), item.supplier());
  }
}

TEST_F(ProxyTest, PassesStatusDetails) {
  grpc::ClientContext context;
  v1::GetItemRequest request;
  request.set_name("items/missing");
  v1::Item item;
  const absl::Status status = rpc::FromGrpc(Catalog()->GetItem(&context, request, &item));
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(DetailOf(status).reason, "RESOURCE_NOT_FOUND");
  EXPECT_EQ(DetailOf(status).field, "items/missing");
}

TEST_F(ProxyTest, PassesDeadlinesAndCancellation) {
  v1::GetItemRequest request;
  request.set_name("items/slow");
  v1::Item item;
  // A deadline that passes on the way to the service tells nothing; a longer one then.
  for (std::chrono::milliseconds deadline(50); house_.counts().slow == 0; deadline *= 2) {
    grpc::ClientContext late;
    late.set_deadline(std::chrono::system_clock::now() + deadline);
    EXPECT_EQ(Catalog()->GetItem(&late, request, &item).error_code(),
              grpc::StatusCode::DEADLINE_EXCEEDED);
  }
  EXPECT_TRUE(house_.WaitForCancelled(1));

  const FakeHouse::Counts before = house_.counts();
  grpc::ClientContext cancelled;
  std::thread canceller([&] {
    EXPECT_TRUE(house_.WaitForSlow(before.slow + 1));
    cancelled.TryCancel();
  });
  EXPECT_EQ(Catalog()->GetItem(&cancelled, request, &item).error_code(),
            grpc::StatusCode::CANCELLED);
  canceller.join();
  EXPECT_TRUE(house_.WaitForCancelled(before.cancelled + 1));
}

TEST_F(ProxyTest, StreamsFromTheService) {
  grpc::ClientContext context;
  v1::ExportDesignRequest request;
  request.set_revision(5'000'000);
  const auto reader = Catalog()->ExportDesign(&context, request);
  v1::Chunk chunk;
  int64_t bytes = 0;
  while (reader->Read(&chunk)) {
    EXPECT_EQ(chunk.offset(), bytes);
    bytes += static_cast<int64_t>(chunk.data().size());
  }
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_EQ(bytes, 5'000'000);
}

TEST_F(ProxyTest, PassesAFailureInTheMiddleOfAStream) {
  grpc::ClientContext context;
  v1::ExportDesignRequest request;
  request.set_name("templates/broken");
  request.set_revision(1);
  const auto reader = Catalog()->ExportDesign(&context, request);
  v1::Chunk chunk;
  EXPECT_TRUE(reader->Read(&chunk));
  EXPECT_FALSE(reader->Read(&chunk));
  const absl::Status status = rpc::FromGrpc(reader->Finish());
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(DetailOf(status).reason, "BROKEN");
  EXPECT_EQ(Value(context.GetServerTrailingMetadata(), "x-trail"), "torn");
}

TEST_F(ProxyTest, ASlowReaderHoldsTheServiceBack) {
  grpc::ClientContext context;
  v1::ExportDesignRequest request;
  request.set_name("templates/endless");
  const auto reader = Catalog()->ExportDesign(&context, request);
  v1::Chunk chunk;
  ASSERT_TRUE(reader->Read(&chunk));
  // The service fills what buffers there are, and then must wait, while others go on through the
  // same gateway to the same service. What the buffers hold is the kernel's to say (its sockets
  // grow to tens of MiB); that a service waits at all shows in a count that stands still over
  // hundreds of calls, in which an unhindered one writes hundreds of MiB.
  int before = -1;
  int written = 0;
  for (int round = 0; round < 20 && before != written; ++round) {
    before = written;
    for (int i = 0; i < 500; ++i) {
      grpc::ClientContext other;
      v1::GetItemRequest get;
      get.set_name("items/echo");
      v1::Item item;
      ASSERT_TRUE(Catalog()->GetItem(&other, get, &item).ok());
    }
    written = house_.counts().written;
  }
  EXPECT_EQ(before, written) << "it writes on for one that reads nothing";
  EXPECT_LT(written, 512) << "128 MiB for one reader that reads nothing";
  context.TryCancel();
  while (reader->Read(&chunk)) {
  }
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(house_.WaitForCancelled(1));
}

TEST_F(ProxyTest, StreamsToTheService) {
  const auto stub = v1::SimulatorService::NewStub(channel_);
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const auto writer = stub->UploadBlob(&context, &response);
  v1::Chunk chunk;
  chunk.set_data(std::string(100000, 'y'));
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(writer->Write(chunk));
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(response.sha256(), "5000000");
}

TEST_F(ProxyTest, StreamsBothWaysAndLetsTheServiceSpeakFirst) {
  const auto stub = v1::FabPlannerService::NewStub(channel_);
  grpc::ClientContext context;
  const auto stream = stub->AttachBridge(&context);
  v1::PlannerMessage answer;
  ASSERT_TRUE(stream->Read(&answer));
  EXPECT_EQ(answer.hold().work_order(), "welcome");
  for (int i = 0; i < 200; ++i) {
    v1::BridgeMessage message;
    message.mutable_hello()->set_bridge(std::to_string(i));
    ASSERT_TRUE(stream->Write(message));
    ASSERT_TRUE(stream->Read(&answer));
    EXPECT_EQ(answer.hold().work_order(), std::to_string(i));
  }
  stream->WritesDone();
  EXPECT_FALSE(stream->Read(&answer));
  EXPECT_TRUE(stream->Finish().ok());
}

TEST_F(ProxyTest, EndsABidirectionalStreamWhenTheServiceDoes) {
  const auto stub = v1::FabPlannerService::NewStub(channel_);
  for (int i = 0; i < 50; ++i) {
    grpc::ClientContext context;
    const auto stream = stub->AttachBridge(&context);
    v1::BridgeMessage message;
    message.mutable_hello()->set_bridge("reject");
    stream->Write(message);
    v1::PlannerMessage answer;
    while (stream->Read(&answer)) {
    }
    EXPECT_EQ(stream->Finish().error_code(), grpc::StatusCode::PERMISSION_DENIED);
  }
}

TEST_F(ProxyTest, SaysWhichServiceCannotBeReached) {
  const auto stub = v1::ParetoService::NewStub(channel_);
  grpc::ClientContext context;
  v1::Front front;
  const grpc::Status status = stub->GetFront(&context, v1::GetFrontRequest(), &front);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_THAT(status.error_message(), HasSubstr("pareto"));
  EXPECT_EQ(DetailOf(rpc::FromGrpc(status)).reason, "PEER_UNAVAILABLE");
}

class LateParetoService final : public v1::ParetoService::Service {
  grpc::Status GetFront(grpc::ServerContext*, const v1::GetFrontRequest* request,
                        v1::Front* front) override {
    front->set_name(request->name());
    return grpc::Status::OK;
  }
  grpc::Status ExportFront(grpc::ServerContext*, const v1::ExportFrontRequest* request,
                           grpc::ServerWriter<v1::Chunk>* writer) override {
    v1::Chunk chunk;
    chunk.set_data(request->name());
    writer->Write(chunk);
    return grpc::Status::OK;
  }
};

class ProxyToAServiceThatRestartsTest : public ProxyTest {
 protected:
  void SetUp() override {
    GatewayOptions options = Options();
    options.services["pareto"] = port_.address();
    options.patience = absl::Minutes(1);
    StartGateway(options);
    channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
  }

  // Once somebody has tried to connect in vain.
  void StartServiceWhenMissed() {
    {
      boost::asio::io_context io;
      boost::asio::ip::tcp::acceptor acceptor(
          io, {boost::asio::ip::address_v4::loopback(),
               static_cast<std::uint16_t>(std::stoi(port_.port()))});
      acceptor.accept();
    }
    grpc::ServerBuilder builder;
    builder.AddListeningPort(port_.address(), grpc::InsecureServerCredentials());
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    ASSERT_TRUE(server_);
  }

  const mortise::testing::ReservedPort port_;
  LateParetoService service_;
  std::unique_ptr<grpc::Server> server_;
};

TEST_F(ProxyToAServiceThatRestartsTest, UnsentCallsWait) {
  v1::Front front;
  auto call = std::async(std::launch::async, [&] {
    v1::GetFrontRequest request;
    request.set_name("fronts/late");
    grpc::ClientContext context;
    return v1::ParetoService::NewStub(channel_)->GetFront(&context, request, &front);
  });
  StartServiceWhenMissed();
  const grpc::Status status = call.get();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(front.name(), "fronts/late");
}

TEST_F(ProxyToAServiceThatRestartsTest, UnsentStreamsWait) {
  v1::Chunk chunk;
  auto call = std::async(std::launch::async, [&] {
    v1::ExportFrontRequest request;
    request.set_name("fronts/late");
    grpc::ClientContext context;
    const auto stub = v1::ParetoService::NewStub(channel_);
    const auto stream = stub->ExportFront(&context, request);
    stream->Read(&chunk);
    return stream->Finish();
  });
  StartServiceWhenMissed();
  const grpc::Status status = call.get();
  EXPECT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(chunk.data(), "fronts/late");
}

TEST_F(ProxyToAServiceThatRestartsTest, ACallsOwnDeadlineComesFirst) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(50));
  v1::Front front;
  const grpc::Status status =
      v1::ParetoService::NewStub(channel_)->GetFront(&context, v1::GetFrontRequest(), &front);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
}

TEST_F(ProxyTest, RoutesOperationsByTheirName) {
  const auto stub = v1::OperationService::NewStub(channel_);
  auto get = [&](const std::string& name) {
    grpc::ClientContext context;
    v1::GetOperationRequest request;
    request.set_name(name);
    v1::Operation operation;
    return stub->GetOperation(&context, request, &operation);
  };
  EXPECT_EQ(get("operations/pareto/1").error_code(), grpc::StatusCode::UNAVAILABLE);
  // The fake catalog has no OperationService: the call arrived there.
  EXPECT_EQ(get("operations/catalog/1").error_code(), grpc::StatusCode::UNIMPLEMENTED);
  EXPECT_EQ(get("operations/nobody/1").error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(get("plans/1").error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(get("").error_code(), grpc::StatusCode::INVALID_ARGUMENT);
}

TEST_F(ProxyTest, RefusesUnknownMethodsAndOversizeMessages) {
  grpc::GenericStub stub(channel_);
  grpc::ClientContext context;
  grpc::ByteBuffer answer;
  std::promise<grpc::Status> done;
  grpc::Slice empty;
  const grpc::ByteBuffer unknown_request(&empty, 1);
  stub.UnaryCall(&context, "/mortise.v1.Nothing/Do", {}, &unknown_request, &answer,
                 [&done](const grpc::Status& status) { done.set_value(status); });
  EXPECT_EQ(done.get_future().get().error_code(), grpc::StatusCode::UNIMPLEMENTED);
  v1::GetItemRequest request;
  v1::Item item;
  request.set_name(std::string(5 << 20, 'x'));
  grpc::ClientContext large;
  EXPECT_EQ(Catalog()->GetItem(&large, request, &item).error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
}

TEST_F(ProxyTest, TellsWhatRuns) {
  const auto stub = v1::GatewayService::NewStub(channel_);
  grpc::ClientContext context;
  v1::House house;
  const grpc::Status status = stub->GetHouse(&context, v1::GetHouseRequest(), &house);
  ASSERT_TRUE(status.ok()) << status.error_message();
  std::map<std::string, bool> healthy;
  for (const auto& service : house.services()) healthy[service.name()] = service.healthy();
  EXPECT_FALSE(healthy.at("pareto"));
  EXPECT_TRUE(healthy.at("gateway"));
  EXPECT_FALSE(house.version().empty());
}

// With keys: only tokens open the door, and services see signed identities.
class TokenProxyTest : public GatewayTest {
 protected:
  void SetUp() override {
    GatewayOptions options = SecureOptions(signer_);
    options.token.issuer = "https://id.example";
    StartGateway(options);
    channel_ = grpc::CreateChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials());
  }

  nlohmann::json Claims(const char* role) const {
    return {{"sub", "ada"},
            {"iss", "https://id.example"},
            {"roles", {role}},
            {"exp", absl::ToUnixSeconds(absl::Now()) + 60}};
  }

  grpc::Status Call(const std::string& token, v1::Item* item) {
    grpc::ClientContext context;
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
    v1::GetItemRequest request;
    request.set_name("items/echo");
    return v1::CatalogService::NewStub(channel_)->GetItem(&context, request, item);
  }

  const TokenSigner signer_{"EdDSA"};
  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(TokenProxyTest, TurnsATokenIntoASignedIdentity) {
  v1::Item item;
  const grpc::Status status = Call(signer_.Sign(Claims("viewer"), "one"), &item);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(item.supplier_number(), "identity");
  EXPECT_EQ(item.supplier_url(), "") << "tokens stay at the gateway";
}

TEST_F(TokenProxyTest, RefusesBadTokens) {
  v1::Item item;
  nlohmann::json expired = Claims("viewer");
  expired["exp"] = absl::ToUnixSeconds(absl::Now()) - 3600;
  nlohmann::json foreign = Claims("viewer");
  foreign["iss"] = "https://else.example";
  const TokenSigner stranger("EdDSA");
  for (const std::string& token : {std::string(), std::string("nonsense"), signer_.Sign(expired),
                                   signer_.Sign(foreign), stranger.Sign(Claims("admin")),
                                   signer_.SignWithHeader({{"alg", "none"}}, Claims("admin"))}) {
    const grpc::Status status = Call(token, &item);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAUTHENTICATED) << token;
    EXPECT_EQ(DetailOf(rpc::FromGrpc(status)).reason, "IDENTITY_INVALID");
  }
}

TEST_F(TokenProxyTest, HoldsCallersToTheirRole) {
  v1::Item item;
  EXPECT_EQ(Call(signer_.Sign(Claims("janitor")), &item).error_code(),
            grpc::StatusCode::PERMISSION_DENIED);
  const auto webhooks = v1::WebhookService::NewStub(channel_);
  auto list = [&](const char* role) {
    grpc::ClientContext context;
    context.AddMetadata("authorization", "Bearer " + signer_.Sign(Claims(role)));
    v1::ListWebhooksResponse response;
    return webhooks->ListWebhooks(&context, v1::ListWebhooksRequest(), &response);
  };
  EXPECT_EQ(list("operator").error_code(), grpc::StatusCode::PERMISSION_DENIED);
  const grpc::Status admin = list("admin");
  EXPECT_TRUE(admin.ok()) << admin.error_message();
}

}  // namespace
}  // namespace mortise::gateway
