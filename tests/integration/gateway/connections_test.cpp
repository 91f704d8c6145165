// How many clients the doors let in, and what their health says of it.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>

#include "mortise/v1/catalog.grpc.pb.h"
#include "tests/integration/gateway/gateway_fixture.h"

namespace mortise::gateway {
namespace {

using ::testing::HasSubstr;

// What a client of HTTP/2 begins with: its preface and empty settings.
const std::string kPreface("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n\0\0\0\4\0\0\0\0\0", 33);
constexpr char kKeptAlive[] = "GET /version HTTP/1.1\r\nHost: localhost\r\n\r\n";

class ConnectionsTest : public GatewayTest {
 protected:
  void Start(int most_connections) {
    GatewayOptions options = Options();
    options.most_connections = most_connections;
    StartGateway(options);
  }

  // A connection of its own.
  std::shared_ptr<grpc::Channel> Connect() {
    grpc::ChannelArguments own_connection;
    own_connection.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel(gateway_->addresses().grpc, grpc::InsecureChannelCredentials(),
                                     own_connection);
  }

  grpc::Status CallGrpc() { return CallGrpc(Connect()); }

  grpc::Status CallGrpc(const std::shared_ptr<grpc::Channel>& channel) {
    grpc::ClientContext context;
    context.set_wait_for_ready(true);
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    v1::GetItemRequest request;
    request.set_name("items/echo");
    v1::Item item;
    return v1::CatalogService::NewStub(channel)->GetItem(&context, request, &item);
  }

  // Asks until health says so, for ten seconds.
  bool BecomesHealthy(bool healthy) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (std::chrono::steady_clock::now() < deadline) {
      health_ = Http(gateway_->addresses().http, "GET", "/healthz");
      if (health_.status == (healthy ? 200 : 503)) return true;
    }
    return false;
  }

  HttpAnswer health_;
};

TEST_F(ConnectionsTest, SilentClientsKeepNobodyOut) {
  Start(4);
  std::vector<std::unique_ptr<HttpStream>> silent;
  for (int i = 0; i < 20; ++i) {
    silent.push_back(HttpStream::Send(gateway_->addresses().http, ""));
    silent.push_back(HttpStream::Send(gateway_->addresses().grpc, ""));
  }
  EXPECT_EQ(Http(gateway_->addresses().http, "GET", "/version").status, 200);
  EXPECT_TRUE(CallGrpc().ok());
  EXPECT_TRUE(BecomesHealthy(true)) << health_.body;
}

TEST_F(ConnectionsTest, IdleClientsOfTheHttpDoorMakeRoom) {
  Start(3);
  std::vector<std::unique_ptr<HttpStream>> idle;
  for (int i = 0; i < 8; ++i) {
    idle.push_back(HttpStream::Send(gateway_->addresses().http, kKeptAlive));
    EXPECT_THAT(idle.back()->ReadUntil("}"), HasSubstr("200 OK")) << i;
  }
}

TEST_F(ConnectionsTest, AFullGrpcDoorSaysSoAndRecovers) {
  Start(2);
  std::vector<std::shared_ptr<grpc::Channel>> clients;
  for (int i = 0; i < 2; ++i) {
    clients.push_back(Connect());
    EXPECT_TRUE(CallGrpc(clients.back()).ok());
  }
  EXPECT_TRUE(BecomesHealthy(false));
  EXPECT_THAT(health_.body, HasSubstr(gateway_->addresses().grpc + " takes no more connections"));
  clients.clear();
  EXPECT_TRUE(CallGrpc().ok());
  EXPECT_TRUE(BecomesHealthy(true));
}

// Clients that speak HTTP/2, and make no call that is admitted.
TEST_F(ConnectionsTest, StrangersKeepNobodyOut) {
  Start(3);
  const auto known = Connect();
  EXPECT_TRUE(CallGrpc(known).ok());
  std::vector<std::unique_ptr<HttpStream>> strangers;
  for (int i = 0; i < 6; ++i) {
    strangers.push_back(HttpStream::Send(gateway_->addresses().grpc, kPreface));
    strangers.back()->ReadUntil(std::string("\4", 1));  // the door's own settings
  }
  EXPECT_TRUE(CallGrpc().ok());
  EXPECT_TRUE(BecomesHealthy(true)) << health_.body;
  EXPECT_EQ(known->GetState(false), GRPC_CHANNEL_READY) << "who is known keeps its connection";
  EXPECT_TRUE(strangers.front()->AwaitClose());
}

TEST_F(ConnectionsTest, WhoIsNotAdmittedIsAStranger) {
  const TokenSigner signer("EdDSA");
  GatewayOptions options = SecureOptions(signer);
  options.most_connections = 2;
  StartGateway(options);
  const auto refused = [&] {
    const auto channel = Connect();
    EXPECT_EQ(CallGrpc(channel).error_code(), grpc::StatusCode::UNAUTHENTICATED);
    return channel;
  };
  const auto first = refused();
  const auto second = refused();
  const auto third = refused();  // would be told nothing if the others were counted as clients
  EXPECT_TRUE(BecomesHealthy(true)) << health_.body;
}

}  // namespace
}  // namespace mortise::gateway
