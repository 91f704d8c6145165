// A service as a real process: start, addresses, signals, crash, and failures to start.
#include <fcntl.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "common/base/files.h"
#include "common/bus/broker.h"
#include "common/bus/subscriber.h"
#include "common/rpc/channel.h"
#include "common/rpc/identity.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "probe.grpc.pb.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"

extern char** environ;

namespace mortise::testing {
namespace {

using rpc::CallUnary;

constexpr absl::Duration kPatience = absl::Seconds(60);

// A child process whose standard error goes to a file.
class Process {
 public:
  Process(std::vector<std::string> arguments, const std::filesystem::path& errors) {
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0600);
    EXPECT_EQ(posix_spawn(&pid_, pointers[0], &actions, nullptr, pointers.data(), environ), 0);
    posix_spawn_file_actions_destroy(&actions);
  }

  ~Process() {
    Signal(SIGKILL);
    Wait();
  }

  void Signal(int signal_number) {
    if (pid_ > 0) kill(pid_, signal_number);
  }

  // The exit code, or minus the signal that ended it.
  int Wait() {
    if (pid_ <= 0) return 0;
    int status = 0;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

 private:
  pid_t pid_ = -1;
};

class ProcessTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_OK(rpc::CreateIdentityKey(Path("keys"), "gateway"));
    ASSERT_OK(rpc::CreateIdentityKey(Path("keys"), "probe"));
    gateway_ = *rpc::IdentitySigner::Load(Path("keys"), "gateway");
  }

  std::filesystem::path Path(const std::string& name) const { return folder_.path() / name; }

  std::unique_ptr<Process> Run(const std::vector<std::string>& further = {}) {
    // The probe is built beside this test.
    std::vector<std::string> arguments = {
        (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "rpc_probe").string(),
        "--store",
        "sqlite:" + Path("probe.db").string(),
        "--blobs",
        Path("blobs").string(),
        "--keys",
        Path("keys").string(),
        "--port-file",
        Path("ports.json").string(),
        "--metrics",
        "127.0.0.1:0"};
    arguments.insert(arguments.end(), further.begin(), further.end());
    return std::make_unique<Process>(arguments, Path("errors"));
  }

  std::unique_ptr<Process> RunUntilServing(const std::vector<std::string>& further = {}) {
    std::filesystem::remove(Path("ports.json"));
    auto process = Run(further);
    const absl::Time end = absl::Now() + kPatience;
    while (!std::filesystem::exists(Path("ports.json")) && absl::Now() < end) {
      absl::SleepFor(absl::Milliseconds(5));
    }
    const auto text = ReadFile(Path("ports.json"));
    EXPECT_OK(text) << Errors();
    if (!text.ok()) return process;
    address_ = nlohmann::json::parse(*text)["grpc"];
    channel_ = *rpc::MakeChannel(address_, {});
    probe_ = ProbeService::NewStub(channel_);
    operations_ = v1::OperationService::NewStub(channel_);
    return process;
  }

  std::string Errors() const {
    const auto text = ReadFile(Path("errors"));
    return text.ok() ? *text : "";
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
  std::string address_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<ProbeService::Stub> probe_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
};

TEST_F(ProcessTest, TerminationLetsCallsInFlightFinish) {
  auto process = RunUntilServing();
  ReadRequest request;
  request.set_name(Path("release").string());
  absl::Status status = absl::InternalError("not called");
  std::thread caller([&] {
    ReadResponse response;
    status = rpc::CallWithRetry(As(rpc::Role::kViewer), {}, [&](grpc::ClientContext* context) {
      return probe_->Read(context, request, &response);
    });
  });
  // A call has begun when the operation of the same connection that was sent after it has.
  Begin(Path("never"));
  process->Signal(SIGTERM);
  const absl::Time end = absl::Now() + kPatience;
  while (Errors().find("draining") == std::string::npos && absl::Now() < end) {
    absl::SleepFor(absl::Milliseconds(5));
  }
  ASSERT_OK(WriteFile(Path("release"), ""));
  caller.join();
  EXPECT_OK(status) << Errors();
  EXPECT_EQ(process->Wait(), 0);
}

TEST_F(ProcessTest, AnOperationSurvivesKill) {
  auto process = RunUntilServing();
  const std::string name = Begin(Path("release")).name();
  process->Signal(SIGKILL);
  EXPECT_EQ(process->Wait(), -SIGKILL);
  process = RunUntilServing();
  ASSERT_OK(WriteFile(Path("release"), ""));
  v1::WaitOperationRequest request;
  request.set_name(name);
  const auto done = CallUnary(*operations_, &v1::OperationService::Stub::WaitOperation, request,
                              As(rpc::Role::kViewer));
  ASSERT_OK(done);
  EXPECT_EQ(done->state(), v1::Operation::SUCCEEDED) << done->ShortDebugString();
  process->Signal(SIGINT);
  EXPECT_EQ(process->Wait(), 0);
}

TEST_F(ProcessTest, EventsReachTheBus) {
  auto broker = bus::Broker::Start({});
  ASSERT_OK(broker);
  auto subscriber = bus::Subscriber::Connect(
      {.endpoint = (*broker)->subscriber_endpoint(), .topics = {"probe/"}});
  ASSERT_OK(subscriber);
  auto process = RunUntilServing({"--bus-publish", (*broker)->publisher_endpoint()});
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
  auto first = RunUntilServing();
  auto second = Run({"--listen", address_, "--store", "sqlite:" + Path("other.db").string()});
  EXPECT_EQ(second->Wait(), 1);
  EXPECT_NE(Errors().find("mortise-probe: cannot listen on " + address_), std::string::npos)
      << Errors();
}

TEST_F(ProcessTest, AnUnwritableStateFolderEndsTheStartClearly) {
  ASSERT_OK(WriteFile(Path("file"), "in the way"));
  auto process = Run({"--store", "sqlite:" + (Path("file") / "probe.db").string()});
  EXPECT_EQ(process->Wait(), 1);
  EXPECT_NE(Errors().find(Path("file").string()), std::string::npos) << Errors();
}

TEST_F(ProcessTest, BadFlagsAndMissingKeysEndTheStartClearly) {
  EXPECT_EQ(Run({"--no-such-flag"})->Wait(), 2);
  EXPECT_NE(Errors().find("--no-such-flag"), std::string::npos) << Errors();
  EXPECT_EQ(Run({"--keys", Path("none").string()})->Wait(), 1);
  EXPECT_NE(Errors().find("none"), std::string::npos) << Errors();
}

}  // namespace
}  // namespace mortise::testing
