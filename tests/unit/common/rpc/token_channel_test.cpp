// Channels whose calls carry a bearer token from a file.
#include "common/rpc/token_channel.h"

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/status_mapping.h"
#include "probe.grpc.pb.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/rpc/self_signed.h"

namespace mortise::testing {
namespace {

// Answers with the header of the call that tokens travel in.
class TokenEcho final : public ProbeService::Service {
 public:
  grpc::Status Read(grpc::ServerContext* context, const ReadRequest*,
                    ReadResponse* response) override {
    const auto found = context->client_metadata().find("authorization");
    if (found != context->client_metadata().end()) {
      response->set_text({found->second.data(), found->second.size()});
    }
    return grpc::Status::OK;
  }
};

class TokenChannelTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const SelfSigned made;
    security_.authority = folder_.path() / "authority.pem";
    const rpc::ChannelSecurity server{folder_.path() / "server.pem", folder_.path() / "server.key"};
    for (const auto& [path, text] :
         {std::pair(security_.authority, made.certificate),
          std::pair(server.certificate, made.certificate), std::pair(server.key, made.key)}) {
      ASSERT_OK(WriteFile(path, text));
    }
    ASSERT_OK(WriteFile(token_, "first\n"));
    const auto credentials = rpc::MakeServerCredentials("127.0.0.1:0", server);
    ASSERT_OK(credentials);
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", *credentials, &port);
    builder.RegisterService(&echo_);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }

  void TearDown() override {
    if (server_) server_->Shutdown();
  }

  // What arrives of the token.
  static absl::StatusOr<std::string> Ask(const std::shared_ptr<grpc::Channel>& channel) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
    context.set_wait_for_ready(true);
    ReadResponse response;
    const grpc::Status status = ProbeService::NewStub(channel)->Read(&context, {}, &response);
    if (!status.ok()) return rpc::FromGrpc(status);
    return response.text();
  }

  TemporaryFolder folder_;
  const std::filesystem::path token_ = folder_.path() / "token";
  rpc::ChannelSecurity security_;
  TokenEcho echo_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
};

TEST_F(TokenChannelTest, CallsCarryWhatTheFileHasThen) {
  const auto channel = rpc::MakeTokenChannel(address_, security_, token_);
  ASSERT_OK(channel);
  EXPECT_EQ(Ask(*channel).value(), "Bearer first");
  ASSERT_OK(WriteFile(token_, "second\n"));
  EXPECT_EQ(Ask(*channel).value(), "Bearer second");
}

TEST_F(TokenChannelTest, FileThatIsGoneOrNoTokenIsNamed) {
  const auto channel = rpc::MakeTokenChannel(address_, security_, token_);
  ASSERT_OK(channel);
  for (const std::string& text : {std::string(70000, 'x'), std::string("two\nlines")}) {
    ASSERT_OK(WriteFile(token_, text));
    const absl::Status refused = Ask(*channel).status();
    EXPECT_TRUE(absl::IsUnavailable(refused)) << refused;
    EXPECT_NE(refused.message().find(token_.string()), std::string::npos) << refused;
  }
  std::filesystem::remove(token_);
  EXPECT_TRUE(absl::IsUnavailable(Ask(*channel).status()));
  ASSERT_OK(WriteFile(token_, "third"));
  EXPECT_EQ(Ask(*channel).value(), "Bearer third");
}

TEST_F(TokenChannelTest, TokensTravelInTlsOnly) {
  const auto plain = rpc::MakeTokenChannel(address_, {}, token_);
  EXPECT_TRUE(absl::IsInvalidArgument(plain.status()));
  EXPECT_EQ(DetailOf(plain.status()).field, "tls-authority");
}

TEST_F(TokenChannelTest, FilesMustBeThere) {
  EXPECT_TRUE(absl::IsNotFound(
      rpc::MakeTokenChannel(address_, security_, folder_.path() / "absent").status()));
  EXPECT_TRUE(absl::IsNotFound(
      rpc::MakeTokenChannel(address_, {{}, {}, folder_.path() / "absent"}, token_).status()));
}

}  // namespace
}  // namespace mortise::testing
