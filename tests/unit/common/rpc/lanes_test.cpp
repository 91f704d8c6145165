// Calls, streams and what is urgent do not wait for each other; nor do they expand what is
// compressed.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "tests/unit/common/rpc/probe_server.h"

namespace mortise::testing {
namespace {

// Holds whoever passes until it is opened.
class Gate {
 public:
  void Pass() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [this] { return open_; });
  }
  void Open() {
    std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  bool WaitFor(int waiting) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, std::chrono::seconds(20), [&] { return waiting_ >= waiting; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int waiting_ = 0;
  bool open_ = false;
};

// As many as there are threads of each kind in ProbeServerTest.
constexpr int kThreads = 4;

class LanesTest : public ProbeServerTest {
 protected:
  void SetUp() override {
    handlers_.follow = [this](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
      streams_.Pass();
      writer->Finish(absl::OkStatus());
      return absl::OkStatus();
    };
    handlers_.read = [this](const rpc::Call&,
                            const ReadRequest& asked) -> absl::StatusOr<ReadResponse> {
      if (asked.name() == "slow") calls_.Pass();
      return ReadResponse();
    };
    handlers_.hurry = [](const rpc::Call&, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
      return ReadResponse();
    };
    handlers_.await = [](const rpc::Call&, const ReadRequest&,
                         const rpc::Responder<ReadResponse>& respond) {
      respond(ReadResponse());
      return absl::OkStatus();
    };
    StartServer();
  }

  void TearDown() override {
    calls_.Open();
    streams_.Open();
    for (std::thread& client : clients_) client.join();
    ProbeServerTest::TearDown();
  }

  // Keeps all threads of calls, or all of streams, busy.
  void FillCalls() {
    for (int i = 0; i < kThreads; ++i) {
      clients_.emplace_back([this] {
        auto context = Context(rpc::Role::kViewer);
        ReadRequest slow;
        slow.set_name("slow");
        ReadResponse response;
        EXPECT_OK(rpc::FromGrpc(stub_->Read(context.get(), slow, &response)));
      });
    }
    ASSERT_TRUE(calls_.WaitFor(kThreads));
  }

  void FillStreams() {
    for (int i = 0; i < kThreads; ++i) {
      clients_.emplace_back([this] {
        auto context = Context(rpc::Role::kViewer);
        EXPECT_OK(rpc::FromGrpc(stub_->Follow(context.get(), {})->Finish()));
      });
    }
    ASSERT_TRUE(streams_.WaitFor(kThreads));
  }

  absl::Status Do(grpc::Status (ProbeService::Stub::*method)(grpc::ClientContext*,
                                                             const ReadRequest&, ReadResponse*)) {
    auto context = Context(rpc::Role::kViewer);
    ReadResponse response;
    return rpc::FromGrpc((stub_.get()->*method)(context.get(), {}, &response));
  }

  Gate calls_;
  Gate streams_;
  std::vector<std::thread> clients_;
};

TEST_F(LanesTest, CallsDoNotWaitForStreams) {
  FillStreams();
  EXPECT_OK(Do(&ProbeService::Stub::Read));
  EXPECT_OK(Do(&ProbeService::Stub::Hurry));
}

TEST_F(LanesTest, StreamsAndWaitsDoNotWaitForCalls) {
  FillCalls();
  EXPECT_OK(Do(&ProbeService::Stub::Await));
}

TEST_F(LanesTest, WhatIsUrgentWaitsForNothing) {
  FillCalls();
  FillStreams();
  EXPECT_OK(Do(&ProbeService::Stub::Hurry));
}

TEST_F(LanesTest, CompressedMessagesAreNotExpanded) {
  for (const auto algorithm : {GRPC_COMPRESS_GZIP, GRPC_COMPRESS_DEFLATE}) {
    auto context = Context(rpc::Role::kViewer);
    context->set_compression_algorithm(algorithm);
    ReadRequest bomb;
    bomb.set_filler(std::string(64 << 20, 'x'));
    ReadResponse response;
    EXPECT_EQ(stub_->Read(context.get(), bomb, &response).error_code(),
              grpc::StatusCode::UNIMPLEMENTED);
  }
}

}  // namespace
}  // namespace mortise::testing
