// The client of the commands against a gateway (played by this test) that fails now and then.
#include "cli/gateway_client.h"

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>

#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {
namespace {

// Answers the first calls with a failure.
class Flaky final : public v1::CatalogService::Service {
 public:
  grpc::Status GetMaterial(grpc::ServerContext*, const v1::GetMaterialRequest* request,
                           v1::Material* response) override {
    ++calls;
    if (failures-- > 0) return {code, "away"};
    response->set_name(request->name());
    return grpc::Status::OK;
  }

  grpc::Status ExportDesign(grpc::ServerContext*, const v1::ExportDesignRequest*,
                            grpc::ServerWriter<v1::Chunk>* writer) override {
    ++calls;
    v1::Chunk chunk;
    chunk.set_data("half");
    writer->Write(chunk);
    return {code, "away"};
  }

  grpc::StatusCode code = grpc::StatusCode::UNAVAILABLE;
  std::atomic<int> failures{0};
  std::atomic<int> calls{0};
};

class GatewayClientTest : public ::testing::Test {
 protected:
  GatewayClientTest() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    GatewayOptions options;
    options.address = "127.0.0.1:" + std::to_string(port);
    client_ = std::make_unique<GatewayClient>(*GatewayClient::Connect(options));
    stub_ = v1::CatalogService::NewStub(client_->channel());
  }

  grpc::Status Get() {
    grpc::ClientContext context;
    client_->Prepare(context);
    v1::GetMaterialRequest request;
    request.set_name("materials/beech");
    v1::Material material;
    return stub_->GetMaterial(&context, request, &material);
  }

  Flaky service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<GatewayClient> client_;
  std::unique_ptr<v1::CatalogService::Stub> stub_;
};

TEST_F(GatewayClientTest, CallsAgainWhenAnAnswerWasLost) {
  service_.failures = 2;
  EXPECT_TRUE(Get().ok());
  EXPECT_EQ(service_.calls, 3);
}

TEST_F(GatewayClientTest, GivesUpOnWhatStaysAway) {
  service_.failures = 100;
  const grpc::Status status = Get();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(status.error_message(), "away");
  EXPECT_EQ(service_.calls, 3);
}

TEST_F(GatewayClientTest, RepeatsNothingThatWasAnswered) {
  service_.failures = 1;
  service_.code = grpc::StatusCode::NOT_FOUND;
  EXPECT_EQ(Get().error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(GatewayClientTest, RepeatsNoStreamThatHasBegun) {
  grpc::ClientContext context;
  client_->Prepare(context);
  const auto reader = stub_->ExportDesign(&context, {});
  v1::Chunk chunk;
  EXPECT_TRUE(reader->Read(&chunk));
  EXPECT_FALSE(reader->Read(&chunk));
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(service_.calls, 1);
}

}  // namespace
}  // namespace mortise::cli
