// The server itself: drain, health, reflection, metrics, addresses.
#include "common/rpc/server_host.h"

#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "common/base/errors.h"
#include "tests/unit/common/rpc/probe_server.h"

namespace mortise::testing {
namespace {

// Sends raw bytes to 127.0.0.1 and returns everything that comes back.
std::string Exchange(const std::string& address, const std::string& request) {
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  const int socket_handle = socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in peer = {};
  peer.sin_family = AF_INET;
  peer.sin_port = htons(static_cast<uint16_t>(port));
  peer.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  std::string answer;
  if (connect(socket_handle, reinterpret_cast<sockaddr*>(&peer), sizeof(peer)) == 0 &&
      send(socket_handle, request.data(), request.size(), 0) == ssize_t(request.size())) {
    char buffer[4096];
    for (ssize_t n; (n = recv(socket_handle, buffer, sizeof(buffer), 0)) > 0;) {
      answer.append(buffer, static_cast<std::size_t>(n));
    }
  }
  close(socket_handle);
  return answer;
}

// grpc.health.v1.Health/Check by hand: the package has no generated client. The answer's field 1 is
// 1 for SERVING, 2 for NOT_SERVING; -1 if the call failed.
int Health(const std::shared_ptr<grpc::Channel>& channel) {
  grpc::GenericStub stub(channel);
  grpc::ClientContext context;
  grpc::CompletionQueue queue;
  grpc::Slice empty;
  const grpc::ByteBuffer request(&empty, 1);
  const auto call =
      stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check", request, &queue);
  call->StartCall();
  grpc::ByteBuffer response;
  grpc::Status status;
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);
  if (!status.ok()) return -1;
  std::vector<grpc::Slice> slices;
  response.Dump(&slices);
  std::string bytes;
  for (const grpc::Slice& slice : slices) bytes.append(slice.begin(), slice.end());
  return bytes.size() == 2 && bytes[0] == 8 ? bytes[1] : -1;
}

class ServerHostTest : public ProbeServerTest {
 protected:
  void SetUp() override {
    handlers_.read = [this](const rpc::Call& call,
                            const ReadRequest&) -> absl::StatusOr<ReadResponse> {
      std::unique_lock lock(mutex_);
      running_ = true;
      changed_.notify_all();
      while (!released_ && !call.cancelled()) changed_.wait_for(lock, std::chrono::milliseconds(5));
      return ReadResponse();
    };
  }

  void WaitUntilRunning() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return running_; });
  }

  void Release() {
    std::lock_guard lock(mutex_);
    released_ = true;
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  bool running_ = false;
  bool released_ = false;
};

TEST_F(ServerHostTest, DrainingFinishesCallsInFlight) {
  StartServer();
  absl::Status status = absl::InternalError("not called");
  std::thread caller([&] { status = Read().status(); });
  WaitUntilRunning();
  std::thread shutdown([this] { host_->Shutdown(); });
  // New calls are refused while the old one goes on.
  const auto late = *rpc::MakeChannel(host_->address(), {});
  while (true) {
    const auto stub = ProbeService::NewStub(late);
    ReadResponse response;
    auto context = rpc::MakeClientContext(As(rpc::Role::kViewer, absl::Milliseconds(200)));
    if (stub->Undeclared(context.get(), {}, &response).error_code() ==
        grpc::StatusCode::UNAVAILABLE) {
      break;
    }
  }
  Release();
  caller.join();
  shutdown.join();
  EXPECT_OK(status);
}

TEST_F(ServerHostTest, WhatIsLeftAtTheDeadlineIsCancelled) {
  StartServer(absl::Milliseconds(50));
  absl::Status status;
  std::thread caller([&] { status = Read().status(); });
  WaitUntilRunning();
  host_->Shutdown();
  caller.join();
  EXPECT_FALSE(status.ok());
  EXPECT_NE(status.code(), absl::StatusCode::kUnknown);
}

TEST_F(ServerHostTest, DrainingAsksWaitingCallsToAnswer) {
  handlers_.await = [this](const rpc::Call& call, const ReadRequest&,
                           const rpc::Responder<ReadResponse>& respond) {
    call.OnStop([respond] { respond(ReadResponse()); });
    std::lock_guard lock(mutex_);
    running_ = true;
    changed_.notify_all();
    return absl::OkStatus();
  };
  StartServer(absl::Seconds(20));
  absl::Status status = absl::InternalError("not called");
  std::thread caller([&] {
    ReadResponse response;
    status = rpc::FromGrpc(stub_->Await(Context(rpc::Role::kViewer).get(), {}, &response));
  });
  WaitUntilRunning();
  const absl::Time begin = absl::Now();
  host_->Shutdown();
  caller.join();
  EXPECT_OK(status);
  EXPECT_LT(absl::Now() - begin, absl::Seconds(15));
}

TEST_F(ServerHostTest, HealthFollowsReadiness) {
  StartServer();
  EXPECT_EQ(Health(channel_), 1);
  rpc::ServerHost::Options options;
  auto unready = rpc::ServerHost::Start(std::move(options));
  ASSERT_OK(unready);
  const auto channel = *rpc::MakeChannel((*unready)->address(), {});
  EXPECT_EQ(Health(channel), 2);
  (*unready)->SetReady();
  EXPECT_EQ(Health(channel), 1);
}

TEST_F(ServerHostTest, ATakenPortIsAClearError) {
  StartServer();
  rpc::ServerHost::Options options;
  options.listen = host_->address();
  const absl::Status status = rpc::ServerHost::Start(std::move(options)).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(DetailOf(status).reason, "ADDRESS_IN_USE");
  EXPECT_NE(status.message().find(host_->address()), absl::string_view::npos);

  rpc::ServerHost::Options metrics;
  metrics.metrics = host_->metrics_address();
  EXPECT_EQ(DetailOf(rpc::ServerHost::Start(std::move(metrics)).status()).reason, "ADDRESS_IN_USE");
}

TEST_F(ServerHostTest, PlainTextDoesNotLeaveTheMachine) {
  rpc::ServerHost::Options options;
  options.listen = "0.0.0.0:0";
  EXPECT_EQ(DetailOf(rpc::ServerHost::Start(std::move(options)).status()).field, "listen");
  EXPECT_EQ(rpc::MakeChannel("example.com:1", {}).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST_F(ServerHostTest, MetricsCountCallsByMethodAndCode) {
  released_ = true;
  StartServer();
  ASSERT_OK(Read());
  ASSERT_OK(Read());
  EXPECT_FALSE(Read({}, rpc::Role::kNone).ok());
  const std::string text =
      Exchange(host_->metrics_address(), "GET /metrics HTTP/1.0\r\nHost: x\r\n\r\n");
  EXPECT_NE(text.find("200 OK"), std::string::npos);
  EXPECT_NE(text.find("mortise_requests_total{code=\"OK\",method=\"mortise.testing.ProbeService/"
                      "Read\"} 2"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("code=\"PERMISSION_DENIED\""), std::string::npos);
  EXPECT_NE(text.find("mortise_request_seconds_bucket"), std::string::npos);
  EXPECT_NE(text.find("mortise_requests_in_flight 0"), std::string::npos);
}

TEST_F(ServerHostTest, TooManyCallsAreRefused) {
  released_ = true;
  StartServer();
  rpc::DispatcherOptions options;
  options.max_calls = 0;
  auto full = rpc::Dispatcher::Create(options);
  rpc::ServerHost::Options host;
  host.services = {std::make_shared<ProbeAdapter>(full.get(), &handlers_)};
  auto server = rpc::ServerHost::Start(std::move(host));
  ASSERT_OK(server);
  const auto stub = ProbeService::NewStub(*rpc::MakeChannel((*server)->address(), {}));
  ReadResponse response;
  grpc::ClientContext context;
  EXPECT_EQ(DetailOf(rpc::FromGrpc(stub->Read(&context, {}, &response))).reason, "TOO_MANY_CALLS");
  grpc::ClientContext stream_context;
  EXPECT_EQ(stub->Follow(&stream_context, {})->Finish().error_code(),
            grpc::StatusCode::RESOURCE_EXHAUSTED);
  (*server)->Shutdown();
}

}  // namespace
}  // namespace mortise::testing
