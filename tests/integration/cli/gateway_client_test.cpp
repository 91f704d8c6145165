// The client of the commands against a gateway (played by this test) that fails now and then.
#include "cli/client/gateway_client.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "cli/client/generic_call.h"
#include "cli/client/tls_probe.h"
#include "cli/commands/command_line.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"
#include "mortise/v1/gateway.grpc.pb.h"
#include "tests/support/temporary_folder.h"

namespace mortise::cli {
namespace {

// Answers the first calls with a failure.
class Flaky final : public v1::CatalogService::Service {
 public:
  grpc::Status GetMaterial(grpc::ServerContext* context, const v1::GetMaterialRequest* request,
                           v1::Material* response) override {
    ++calls;
    const auto header = context->client_metadata().find("authorization");
    if (!token.empty() && (header == context->client_metadata().end() ||
                           header->second != grpc::string_ref("Bearer " + token))) {
      return {grpc::StatusCode::UNAUTHENTICATED, "the token expired"};
    }
    context->AddInitialMetadata("x-request-id", "1");
    if (failures-- > 0) return {code, "away"};
    response->set_name(request->name());
    return grpc::Status::OK;
  }

  grpc::StatusCode code = grpc::StatusCode::UNAVAILABLE;
  std::atomic<int> failures{0};
  std::atomic<int> calls{0};
  std::string token;  // that is needed; empty for none
};

// Reads what comes first on each connection, answers and ends it.
class BriefServer {
 public:
  explicit BriefServer(std::string answer) : answer_(std::move(answer)) {
    thread_ = std::thread([this] {
      while (true) {
        boost::asio::ip::tcp::socket connection(context_);
        boost::system::error_code failure;
        acceptor_.accept(connection, failure);
        if (stopping_ || failure) return;
        std::array<char, 4096> ignored{};
        if (answer_.empty()) continue;
        connection.read_some(boost::asio::buffer(ignored), failure);
        connection.send(boost::asio::buffer(answer_), 0, failure);
      }
    });
  }
  ~BriefServer() {
    stopping_ = true;
    boost::asio::ip::tcp::socket last(context_);
    last.connect(acceptor_.local_endpoint());
    thread_.join();
  }
  std::string address() const {
    return "127.0.0.1:" + std::to_string(acceptor_.local_endpoint().port());
  }

 private:
  const std::string answer_;  // empty: it ends connections at once
  boost::asio::io_context context_;
  boost::asio::ip::tcp::acceptor acceptor_{context_, {boost::asio::ip::address_v4::loopback(), 0}};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

// A refusal of the handshake, as a server of TLS sends it.
const std::string kAlert("\x15\x03\x03\x00\x02\x02\x28", 7);

std::string WhyNot(const BriefServer& server) {
  GatewayOptions options;
  options.address = server.address();
  return std::string(GatewayClient::Connect(options).status().message());
}

// A gateway with two services behind it.
class TwoServices final : public v1::GatewayService::Service {
 public:
  grpc::Status GetHouse(grpc::ServerContext* context, const v1::GetHouseRequest* /*request*/,
                        v1::House* house) override {
    context->AddInitialMetadata("x-request-id", "1");
    house->set_version("0.1");
    for (const char* name : {"catalog", "pareto"}) {
      v1::House::Service& service = *house->add_services();
      service.set_name(name);
      service.set_address("10.0.0.1:1");
      service.set_healthy(service.name() == "catalog");
    }
    return grpc::Status::OK;
  }
};

class GatewayClientTest : public ::testing::Test {
 protected:
  GatewayClientTest() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    builder.RegisterService(&house_);
    server_ = builder.BuildAndStart();
    (void)WriteFile(token_file_, "first\n");
    GatewayOptions options;
    options.address = "127.0.0.1:" + std::to_string(port);
    options.token_file = token_file_.string();
    session_.gateway = options;
    client_ = std::make_unique<GatewayClient>(*GatewayClient::Connect(session_.gateway));
    stub_ = v1::CatalogService::NewStub(client_->channel());
  }

  absl::Status Get() {
    v1::GetMaterialRequest request;
    request.set_name("materials/beech");
    v1::Material material;
    return client_->Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(stub_->GetMaterial(&context, request, &material));
    });
  }

  // The same without the contract's classes.
  absl::Status GetGenerically() {
    return CallGeneric(*client_, "/mortise.v1.CatalogService/GetMaterial", "", 10,
                       [](const std::string&) { return true; });
  }

  testing::TemporaryFolder folder_;
  const std::filesystem::path token_file_ = folder_.path() / "token";
  Flaky service_;
  TwoServices house_;
  Session session_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<GatewayClient> client_;
  std::unique_ptr<v1::CatalogService::Stub> stub_;
};

// Of the house that is named, not of one that may run here.
TEST_F(GatewayClientTest, StatusTellsOfTheHouseBehindTheGateway) {
  Output output(Output::Form::kSilent);
  ASSERT_TRUE(RunCommandLine({"status"}, session_, output).ok());
  const auto document = nlohmann::json::parse(output.last_document());
  EXPECT_EQ(document["gateway_grpc"], session_.gateway.address);
  ASSERT_EQ(document["processes"].size(), 2u);
  EXPECT_EQ(document["processes"][0]["name"], "catalog");
  EXPECT_EQ(document["processes"][0]["serving"], true);
  EXPECT_EQ(document["processes"][1]["serving"], false);
}

TEST_F(GatewayClientTest, DownStopsNoHouseThatItsGatewayNames) {
  Output output(Output::Form::kSilent);
  EXPECT_EQ(DetailOf(RunCommandLine({"down"}, session_, output)).field, "--gateway");
}

TEST_F(GatewayClientTest, CallsAgainWhenAnAnswerWasLost) {
  service_.failures = 2;
  EXPECT_TRUE(Get().ok());
  EXPECT_EQ(service_.calls, 3);
  service_.failures = 1;
  EXPECT_TRUE(GetGenerically().ok());
  EXPECT_EQ(service_.calls, 5);
}

TEST_F(GatewayClientTest, GivesUpOnWhatStaysAway) {
  service_.failures = 100;
  const absl::Status status = Get();
  EXPECT_EQ(status, absl::UnavailableError("away"));
  EXPECT_EQ(service_.calls, 3);
  EXPECT_EQ(GetGenerically(), absl::UnavailableError("away"));
  EXPECT_EQ(service_.calls, 6);
}

TEST_F(GatewayClientTest, GoesOnWithANewTokenInTheFileAndNotWithoutOne) {
  service_.token = "second";
  EXPECT_EQ(Get().code(), absl::StatusCode::kUnauthenticated);
  EXPECT_EQ(service_.calls, 1);
  ASSERT_TRUE(WriteFile(token_file_, "second\n").ok());
  EXPECT_TRUE(Get().ok());
  EXPECT_EQ(service_.calls, 3);
  EXPECT_TRUE(Get().ok());
  EXPECT_EQ(service_.calls, 4);
}

TEST(Connect, TellsAServerThatEndsConnectionsFromOneThatSpeaksTls) {
  const BriefServer closing("");
  EXPECT_THAT(WhyNot(closing), ::testing::HasSubstr("ends connections at once"));
  const BriefServer tls(kAlert);
  EXPECT_THAT(WhyNot(tls), ::testing::HasSubstr("speaks TLS; name whom to trust"));
}

TEST_F(GatewayClientTest, ProbesWhatAServerSpeaks) {
  EXPECT_EQ(AskForTls(client_->address(), std::chrono::seconds(10)), TlsAnswer::kOther);
  EXPECT_EQ(AskForTls(BriefServer("HTTP/1.1 400 Bad Request\r\n\r\n").address(),
                      std::chrono::seconds(10)),
            TlsAnswer::kOther);
  EXPECT_EQ(AskForTls(BriefServer(kAlert).address(), std::chrono::seconds(10)), TlsAnswer::kTls);
  EXPECT_EQ(AskForTls(BriefServer("").address(), std::chrono::seconds(10)), TlsAnswer::kNothing);
}

TEST_F(GatewayClientTest, RepeatsNothingThatWasAnswered) {
  service_.failures = 2;
  service_.code = grpc::StatusCode::NOT_FOUND;
  EXPECT_EQ(Get().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(GetGenerically().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(service_.calls, 2);
}

}  // namespace
}  // namespace mortise::cli
