// TLS between processes: who is let in, and who is not.
#include <gtest/gtest.h>

#include <memory>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "tests/support/reserved_port.h"
#include "tests/unit/common/rpc/probe_server.h"
#include "tests/unit/common/rpc/self_signed.h"

namespace mortise::testing {
namespace {

class TlsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ours_ = Write("ours");
    theirs_ = Write("theirs");
    handlers_.read = [](const rpc::Call&, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
      return ReadResponse();
    };
    dispatcher_ = rpc::Dispatcher::Create({.service = "probe", .threads = 2});
  }

  void TearDown() override {
    if (host_) host_->Shutdown();
    dispatcher_->WaitIdle();
    host_.reset();
  }

  // Files of a new certificate, which is its own authority.
  rpc::ChannelSecurity Write(const std::string& name) {
    const SelfSigned made;
    rpc::ChannelSecurity security;
    security.certificate = folder_.path() / (name + ".crt");
    security.key = folder_.path() / (name + ".key");
    security.authority = security.certificate;
    EXPECT_OK(WriteFile(security.certificate, made.certificate));
    EXPECT_OK(WriteFile(security.key, made.key));
    return security;
  }

  absl::Status Start(const rpc::ChannelSecurity& security, const std::string& listen) {
    rpc::ServerHost::Options options;
    options.listen = listen;
    options.security = security;
    options.dispatcher = dispatcher_.get();
    options.services = {std::make_shared<ProbeAdapter>(dispatcher_.get(), &handlers_)};
    MORTISE_ASSIGN_OR_RETURN(host_, rpc::ServerHost::Start(std::move(options)));
    return absl::OkStatus();
  }

  absl::Status Read(const rpc::ChannelSecurity& security) {
    const std::string& address = host_->address();
    const auto channel =
        rpc::MakeChannel("127.0.0.1" + address.substr(address.rfind(':')), security);
    if (!channel.ok()) return channel.status();
    const auto stub = ProbeService::NewStub(*channel);
    grpc::ClientContext context;
    context.set_deadline(absl::ToChronoTime(absl::Now() + absl::Seconds(20)));
    ReadResponse response;
    return rpc::FromGrpc(stub->Read(&context, {}, &response));
  }

  TemporaryFolder folder_;
  ProbeHandlers handlers_;
  rpc::ChannelSecurity ours_;
  rpc::ChannelSecurity theirs_;
  std::unique_ptr<rpc::Dispatcher> dispatcher_;
  std::unique_ptr<rpc::ServerHost> host_;
};

TEST_F(TlsTest, BothSidesShowCertificates) {
  ASSERT_OK(Start(ours_, "0.0.0.0:0")) << "with TLS it may leave the machine";
  EXPECT_OK(Read(ours_));
  rpc::ChannelSecurity nameless;
  nameless.authority = ours_.authority;
  EXPECT_FALSE(Read(nameless).ok()) << "the client shows no certificate";
  rpc::ChannelSecurity stranger = theirs_;
  stranger.authority = ours_.authority;
  EXPECT_FALSE(Read(stranger).ok()) << "the client's certificate is of another house";
  EXPECT_FALSE(Read(theirs_).ok()) << "the server's certificate is of another house";
  EXPECT_FALSE(Read({}).ok()) << "plain text";
}

TEST_F(TlsTest, WithoutAuthorityClientsNeedNoCertificate) {
  rpc::ChannelSecurity open = ours_;
  open.authority.clear();
  ASSERT_OK(Start(open, "127.0.0.1:0"));
  rpc::ChannelSecurity client;
  client.authority = ours_.certificate;
  EXPECT_OK(Read(client));
}

// A handshake goes on only while somebody waits on the channel: retries must get through all the
// same.
TEST_F(TlsTest, RetriesReachAServerThatStartsLate) {
  const ReservedPort port;
  const auto channel = rpc::MakeChannel(port.address(), ours_);
  ASSERT_OK(channel);
  const auto stub = ProbeService::NewStub(*channel);
  rpc::Origin origin;
  origin.deadline = absl::Now() + absl::Minutes(1);
  int tries = 0;
  const auto attempt = [&](grpc::ClientContext* context) {
    if (++tries == 3) {
      EXPECT_OK(Start(ours_, port.address()));
    }
    ReadResponse response;
    return stub->Read(context, {}, &response);
  };
  EXPECT_OK(rpc::CallWithRetry(origin, {.patience = absl::Minutes(1)}, attempt));
  EXPECT_GT(tries, 2);
}

TEST_F(TlsTest, IncompleteOrMissingFilesAreNamed) {
  rpc::ChannelSecurity no_key = ours_;
  no_key.key.clear();
  EXPECT_EQ(DetailOf(Start(no_key, "127.0.0.1:0")).field, "tls-key");
  rpc::ChannelSecurity missing = ours_;
  missing.authority = folder_.path() / "none.crt";
  EXPECT_EQ(Start(missing, "127.0.0.1:0").code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace mortise::testing
