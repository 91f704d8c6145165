// A service as a real process: start, addresses, signals, crash, and failures to start.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>
#include <thread>

#include "common/base/files.h"
#include "common/bus/broker.h"
#include "common/bus/subscriber.h"
#include "common/rpc/channel.h"
#include "common/rpc/identity.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "probe.grpc.pb.h"
#include "tests/support/child_process.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

namespace mortise::testing {
namespace {

using rpc::CallUnary;
using ::testing::HasSubstr;

constexpr absl::Duration kPatience = absl::Seconds(60);

class ProcessTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_OK(rpc::CreateIdentityKey(Path("keys"), "gateway"));
    ASSERT_OK(rpc::CreateIdentityKey(Path("keys"), "probe"));
    gateway_ = *rpc::IdentitySigner::Load(Path("keys"), "gateway");
  }

  std::filesystem::path Path(const std::string& name) const { return folder_.path() / name; }

  // The probe is built beside this test.
  static std::string Program() {
    return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "rpc_probe").string();
  }

  std::vector<std::string> Flags(const std::vector<std::string>& further) const {
    std::vector<std::string> flags = {"--store=sqlite:" + Path("probe.db").string(),
                                      "--blobs=" + Path("blobs").string(),
                                      "--keys=" + Path("keys").string(), "--metrics=127.0.0.1:0"};
    flags.insert(flags.end(), further.begin(), further.end());
    return flags;
  }

  // One that is not meant to serve.
  std::unique_ptr<ChildProcess> Run(const std::vector<std::string>& further) const {
    std::vector<std::string> arguments = Flags(further);
    arguments.insert(arguments.begin(), Program());
    return std::make_unique<ChildProcess>(arguments);
  }

  std::unique_ptr<ServiceProcess> Serve(const std::vector<std::string>& further = {}) {
    auto process = std::make_unique<ServiceProcess>(Program(), Flags(further), Path("ports.json"));
    channel_ = *rpc::MakeChannel(process->address(), {});
    probe_ = ProbeService::NewStub(channel_);
    operations_ = v1::OperationService::NewStub(channel_);
    return process;
  }

  rpc::Origin As(rpc::Role role) const {
    rpc::Origin origin;
    origin.deadline = absl::Now() + kPatience;
    origin.identity = [this, role] { return gateway_->Sign("users/ada", role, "trace-5"); };
    return origin;
  }

  v1::Operation Begin(const std::filesystem::path& until) {
    KeepRequest request;
    request.set_request_id("r-1");
    request.set_name("things/a");
    request.set_value(until.string());
    const auto operation =
        CallUnary(*probe_, &ProbeService::Stub::Begin, request, As(rpc::Role::kOperator));
    EXPECT_OK(operation);
    return operation.ok() ? *operation : v1::Operation();
  }

  TemporaryFolder folder_;
  std::unique_ptr<rpc::IdentitySigner> gateway_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<ProbeService::Stub> probe_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
};

TEST_F(ProcessTest, TerminationLetsCallsInFlightFinish) {
  auto process = Serve();
  ReadRequest request;
  request.set_name(Path("release").string());
  absl::Status status = absl::InternalError("not called");
  std::thread caller([&] {
    ReadResponse response;
    status = rpc::CallWithRetry(As(rpc::Role::kViewer), {}, [&](grpc::ClientContext* context) {
      return probe_->Read(context, request, &response);
    });
  });
  EXPECT_TRUE(process->AwaitOutput("waiting for"));
  process->Signal(SIGTERM);
  EXPECT_TRUE(process->AwaitOutput("draining"));
  EXPECT_OK(WriteFile(Path("release"), ""));
  caller.join();
  EXPECT_OK(status);
  EXPECT_EQ(process->Wait(), 0);
}

// Whichever of its threads is given the signal.
TEST_F(ProcessTest, TerminationWhileItStartsEndsItInOrder) {
  std::vector<std::string> arguments = Flags({});
  arguments.insert(arguments.begin(), {"/usr/bin/env", "END_AT_START=1", Program()});
  ChildProcess process(arguments);
  EXPECT_EQ(process.Wait(), 0) << process.Output();
}

TEST_F(ProcessTest, AnOperationSurvivesKill) {
  auto process = Serve();
  const std::string name = Begin(Path("release")).name();
  EXPECT_EQ(process->End(SIGKILL), -SIGKILL);
  process = Serve();
  ASSERT_OK(WriteFile(Path("release"), ""));
  v1::WaitOperationRequest request;
  request.set_name(name);
  const auto done = CallUnary(*operations_, &v1::OperationService::Stub::WaitOperation, request,
                              As(rpc::Role::kViewer));
  ASSERT_OK(done);
  EXPECT_EQ(done->state(), v1::Operation::SUCCEEDED) << done->ShortDebugString();
  EXPECT_EQ(process->End(SIGINT), 0);
}

TEST_F(ProcessTest, EventsReachTheBus) {
  auto broker = bus::Broker::Start({});
  ASSERT_OK(broker);
  auto subscriber = bus::Subscriber::Connect(
      {.endpoint = (*broker)->subscriber_endpoint(), .topics = {"probe/"}});
  ASSERT_OK(subscriber);
  auto process = Serve({"--bus-publish", (*broker)->publisher_endpoint()});
  // The bus may lose what was said before all were connected; a heartbeat shows that they are.
  ASSERT_OK((*subscriber)->Receive(kPatience));
  Begin(Path("never"));
  const absl::Time end = absl::Now() + kPatience;
  std::string type;
  while (type.empty() && absl::Now() < end) {
    const auto message = (*subscriber)->Receive(absl::Seconds(1));
    ASSERT_OK(message);
    if (message->has_value() && (*message)->kind == bus::Message::Kind::kEvent) {
      type = (*message)->event.type;
    }
  }
  EXPECT_EQ(type.rfind("operation.", 0), 0u) << type;
}

TEST_F(ProcessTest, ATakenPortEndsTheStartClearly) {
  const auto first = Serve();
  const auto second =
      Run({"--listen=" + first->address(), "--store=sqlite:" + Path("other.db").string()});
  EXPECT_EQ(second->Wait(), 1);
  EXPECT_THAT(second->Output(), HasSubstr("mortise-probe: cannot listen on " + first->address()));
}

TEST_F(ProcessTest, AnUnwritableStateFolderEndsTheStartClearly) {
  ASSERT_OK(WriteFile(Path("file"), "in the way"));
  const auto process = Run({"--store=sqlite:" + (Path("file") / "probe.db").string()});
  EXPECT_EQ(process->Wait(), 1);
  EXPECT_THAT(process->Output(), HasSubstr(Path("file").string()));
}

TEST_F(ProcessTest, BadFlagsAndMissingKeysEndTheStartClearly) {
  const auto bad_flag = Run({"--no-such-flag"});
  EXPECT_EQ(bad_flag->Wait(), 2);
  EXPECT_THAT(bad_flag->Output(), HasSubstr("--no-such-flag"));
  const auto no_keys = Run({"--keys=" + Path("none").string()});
  EXPECT_EQ(no_keys->Wait(), 1);
  EXPECT_THAT(no_keys->Output(), HasSubstr("none"));
}

}  // namespace
}  // namespace mortise::testing
