// Calls within the process, whose answers may come before anybody asks for them.
#include "gateway/forwarding/client_call.h"

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <boost/asio/co_spawn.hpp>
#include <boost/asio/detached.hpp>
#include <boost/asio/io_context.hpp>
#include <chrono>
#include <condition_variable>
#include <mutex>

#include "gateway/forwarding/wire.h"

namespace mortise::gateway {
namespace {

namespace asio = boost::asio;

// Answers every call with its own request, or with nothing but a failure to an empty one. Tells
// when its last answer has been handed over.
class Echo final : public grpc::CallbackGenericService {
 public:
  grpc::ServerGenericBidiReactor* CreateReactor(grpc::GenericCallbackServerContext*) override {
    return new Reactor(*this);
  }

  // False after ten seconds.
  bool WaitForAnswers(int count) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(10), [&] { return given_ == count; });
  }

 private:
  class Reactor final : public grpc::ServerGenericBidiReactor {
   public:
    explicit Reactor(Echo& echo) : echo_(echo) { StartRead(&message_); }

    void OnReadDone(bool) override {
      if (message_.Length() == 0) {
        return Finish(grpc::Status(grpc::StatusCode::NOT_FOUND, "nothing there"));
      }
      StartWriteAndFinish(&message_, grpc::WriteOptions(), grpc::Status::OK);
    }

    void OnDone() override {
      {
        std::lock_guard lock(echo_.mutex_);
        ++echo_.given_;
        echo_.changed_.notify_all();
      }
      delete this;
    }

   private:
    Echo& echo_;
    grpc::ByteBuffer message_;
  };

  std::mutex mutex_;
  std::condition_variable changed_;
  int given_ = 0;  // guarded by mutex_
};

class ClientCallTest : public ::testing::Test {
 protected:
  void SetUp() override {
    grpc::ServerBuilder builder;
    builder.RegisterCallbackGenericService(&echo_);
    server_ = builder.BuildAndStart();
    stub_ = std::make_unique<GenericStub>(server_->InProcessChannel(grpc::ChannelArguments()));
  }

  // A call that nobody asks before the server is done with it, if it can be.
  std::shared_ptr<ClientCall> Answered(const std::string& request) {
    auto call = ClientCall::StartUnary(*stub_, {"/test/Echo", {}, std::nullopt}, request);
    EXPECT_TRUE(echo_.WaitForAnswers(++calls_)) << "the server's call has no end";
    return call;
  }

  std::optional<std::string> Read(ClientCall& call) {
    asio::io_context io;
    std::optional<std::string> answer;
    asio::co_spawn(
        io, [&]() -> asio::awaitable<void> { answer = co_await call.Read(); }, asio::detached);
    io.run();
    return answer;
  }

  Echo echo_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<GenericStub> stub_;
  int calls_ = 0;
};

TEST_F(ClientCallTest, AnswerThatCameBeforeItWasReadIsNotLost) {
  const auto call = Answered("payload");
  EXPECT_EQ(Read(*call), "payload");
  EXPECT_EQ(Read(*call), std::nullopt) << "a unary method answers once";
  EXPECT_TRUE(call->status().ok()) << call->status().error_message();
}

TEST_F(ClientCallTest, FailureThatCameBeforeItWasReadIsNotLost) {
  const auto call = Answered("");
  EXPECT_EQ(Read(*call), std::nullopt);
  EXPECT_EQ(call->status().error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(ClientCallTest, CallWhoseHandleIsDroppedEnds) {
  Answered("payload").reset();
  server_->Shutdown();
  server_->Wait();
}

}  // namespace
}  // namespace mortise::gateway
