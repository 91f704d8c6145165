// Streams through a real server: order, back-pressure, cancellation, both ways.
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "common/base/errors.h"
#include "common/host/chunk_stream.h"
#include "tests/unit/common/host/stream_fixture.h"

namespace mortise::testing {
namespace {

TEST_F(StreamTest, SendsInOrderThenTheStatus) {
  handlers_.follow = [](const rpc::Call&, const ReadRequest& request,
                        const ResponseWriter& writer) -> absl::Status {
    for (int i = 0; i < 100; ++i) EXPECT_TRUE(writer->Write(Number(i)));
    writer->Finish(request.name() == "fail" ? StaleRevision("x", 1, 2) : absl::OkStatus());
    EXPECT_FALSE(writer->Write(Number(-1)));
    return absl::OkStatus();
  };
  StartServer();
  Received received = Follow();
  EXPECT_OK(received.status);
  ASSERT_EQ(received.numbers.size(), 100u);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(received.numbers[i], i);

  ReadRequest request;
  request.set_name("fail");
  received = Follow(request);
  EXPECT_EQ(received.numbers.size(), 100u);
  EXPECT_EQ(DetailOf(received.status).reason, "STALE_REVISION");
}

TEST_F(StreamTest, AFailureToStartIsTheStatus) {
  handlers_.follow = [](const rpc::Call&, const ReadRequest&, const ResponseWriter&) {
    return ResourceNotFound("operations/x");
  };
  StartServer();
  EXPECT_EQ(Follow().status.code(), absl::StatusCode::kNotFound);
  auto context = rpc::MakeClientContext(As(rpc::Role::kNone));
  ReadResponse response;
  auto reader = stub_->Follow(context.get(), {});
  EXPECT_FALSE(reader->Read(&response));
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::PERMISSION_DENIED);
}

TEST_F(StreamTest, LaterMessagesComeFromAnyThread) {
  ResponseWriter kept;
  Signal started;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    kept = writer;
    started.Set();
    return absl::OkStatus();
  };
  StartServer();
  std::thread source([&] {
    ASSERT_TRUE(started.Wait());
    for (int i = 0; i < 10; ++i) kept->Write(Number(i));
    kept->Finish(absl::OkStatus());
  });
  EXPECT_EQ(Follow().numbers.size(), 10u);
  source.join();
}

TEST_F(StreamTest, LearnsThatTheReaderIsGone) {
  Signal ended;
  ResponseWriter kept;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    writer->OnEnd([&] { ended.Set(); });
    writer->Write(Number(1));
    kept = writer;
    return absl::OkStatus();
  };
  StartServer();
  auto context = Context(rpc::Role::kViewer);
  auto reader = stub_->Follow(context.get(), {});
  ReadResponse response;
  ASSERT_TRUE(reader->Read(&response));
  context->TryCancel();
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
  ASSERT_TRUE(ended.Wait());
  EXPECT_TRUE(kept->cancelled());
  EXPECT_FALSE(kept->Write(Number(2)));
  Signal late;
  kept->OnEnd([&] { late.Set(); });
  EXPECT_TRUE(late.Wait());
}

TEST_F(StreamTest, ASlowReaderIsCutOff) {
  Signal full;
  handlers_.follow_options.capacity = 8;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    ReadResponse big;
    big.set_filler(std::string(100000, 'x'));
    for (int i = 0; i < 100000 && writer->Write(big); ++i) {
    }
    full.Set();
    return absl::OkStatus();
  };
  StartServer();
  auto context = Context(rpc::Role::kViewer);
  auto reader = stub_->Follow(context.get(), {});
  ASSERT_TRUE(full.Wait());
  ReadResponse response;
  while (reader->Read(&response)) {
  }
  const absl::Status status = rpc::FromGrpc(reader->Finish());
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(DetailOf(status).reason, "SLOW_READER");
}

TEST_F(StreamTest, OfStatesOnlyTheLatestWaits) {
  handlers_.follow_options.capacity = 2;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    for (int i = 0; i <= 1000; ++i) EXPECT_TRUE(writer->WriteLatest(Number(i)));
    writer->Finish(absl::OkStatus());
    return absl::OkStatus();
  };
  StartServer();
  const Received received = Follow();
  EXPECT_OK(received.status);
  ASSERT_FALSE(received.numbers.empty());
  EXPECT_EQ(received.numbers.back(), 1000);
}

TEST_F(StreamTest, PullsNoFasterThanTheReader) {
  auto pulled = std::make_shared<std::atomic<int>>(0);
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    writer->Pull([pulled]() -> absl::StatusOr<std::optional<ReadResponse>> {
      ReadResponse response = Number((*pulled)++);
      response.set_filler(std::string(2'000'000, 'x'));
      return std::optional<ReadResponse>(response);
    });
    return absl::OkStatus();
  };
  StartServer();
  auto context = Context(rpc::Role::kViewer);
  auto reader = stub_->Follow(context.get(), {});
  ReadResponse response;
  for (int i = 0; i < 50; ++i) ASSERT_TRUE(reader->Read(&response));
  EXPECT_EQ(response.number(), 49);
  // What gRPC and TCP buffer is some megabytes, the more the busier the machine.
  EXPECT_LT(*pulled, 50 + 40);
  context->TryCancel();
}

TEST_F(StreamTest, APullThatHasNothingWaitsForWake) {
  ResponseWriter kept;
  std::mutex mutex;
  std::vector<int> source;  // guarded by mutex
  Signal asked;
  handlers_.follow = [&](const rpc::Call&, const ReadRequest&, const ResponseWriter& writer) {
    kept = writer;
    writer->Pull([&]() -> absl::StatusOr<std::optional<ReadResponse>> {
      std::lock_guard lock(mutex);
      asked.Set();
      if (source.empty()) return std::optional<ReadResponse>();
      const int next = source.back();
      source.pop_back();
      if (next < 0) return ResourceNotFound("more");
      return std::optional<ReadResponse>(Number(next));
    });
    return absl::OkStatus();
  };
  StartServer();
  std::thread feeder([&] {
    ASSERT_TRUE(asked.Wait());
    {
      std::lock_guard lock(mutex);
      source = {-1, 2, 1};
    }
    kept->Wake();
  });
  const Received received = Follow();
  feeder.join();
  EXPECT_EQ(received.numbers, (std::vector<int64_t>{1, 2}));
  EXPECT_EQ(received.status.code(), absl::StatusCode::kNotFound);
}

// ---- Both ways ---------------------------------------------------------------------------------

// Answers each message with its number; "end" finishes, "bad" fails.
class Echo : public rpc::StreamReader<ReadRequest> {
 public:
  Echo(ResponseWriter writer, Signal* ended) : writer_(std::move(writer)), ended_(ended) {}
  absl::Status OnMessage(const ReadRequest& message) override {
    if (message.name() == "bad") return InvalidField("name", "is bad");
    if (message.name() == "end") {
      writer_->Finish(absl::OkStatus());
      return absl::OkStatus();
    }
    writer_->Write(Number(static_cast<int64_t>(message.number())));
    return absl::OkStatus();
  }
  void OnEnd() override {
    writer_->Finish(absl::OkStatus());
    ended_->Set();
  }

 private:
  ResponseWriter writer_;
  Signal* ended_;
};

class ChatTest : public StreamTest {
 protected:
  void SetUp() override {
    handlers_.chat = [this](const rpc::Call&, ResponseWriter writer)
        -> absl::StatusOr<std::unique_ptr<rpc::StreamReader<ReadRequest>>> {
      return std::make_unique<Echo>(std::move(writer), &ended_);
    };
    StartServer(absl::Seconds(20));
    context_ = Context(rpc::Role::kViewer);
    stream_ = stub_->Chat(context_.get());
  }

  void Send(double number, const std::string& name = "") {
    ReadRequest request;
    request.set_number(number);
    request.set_name(name);
    stream_->Write(request);
  }

  Signal ended_;
  std::unique_ptr<grpc::ClientContext> context_;
  std::unique_ptr<grpc::ClientReaderWriter<ReadRequest, ReadResponse>> stream_;
};

TEST_F(ChatTest, TalksInOrderUntilTheClientHasFinished) {
  ReadResponse response;
  for (int i = 0; i < 50; ++i) {
    Send(i);
    ASSERT_TRUE(stream_->Read(&response));
    EXPECT_EQ(response.number(), i);
  }
  stream_->WritesDone();
  EXPECT_FALSE(stream_->Read(&response));
  EXPECT_TRUE(stream_->Finish().ok());
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, TheServerMayFinishFirst) {
  Send(0, "end");
  ReadResponse response;
  EXPECT_FALSE(stream_->Read(&response));
  EXPECT_TRUE(stream_->Finish().ok());
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, ABadMessageEndsIt) {
  Send(std::numeric_limits<double>::infinity());
  EXPECT_EQ(DetailOf(rpc::FromGrpc(stream_->Finish())).field, "number");
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, AFailureOfTheHandlerEndsIt) {
  Send(0, "bad");
  EXPECT_EQ(DetailOf(rpc::FromGrpc(stream_->Finish())).field, "name");
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, TheReaderLearnsThatTheClientIsGone) {
  Send(1);
  ReadResponse response;
  ASSERT_TRUE(stream_->Read(&response));
  context_->TryCancel();
  stream_->Finish();
  EXPECT_TRUE(ended_.Wait());
}

TEST_F(ChatTest, DrainingEndsIt) {
  Send(1);
  ReadResponse response;
  ASSERT_TRUE(stream_->Read(&response));
  std::thread shutdown([this] { host_->Shutdown(); });
  EXPECT_FALSE(stream_->Read(&response));
  const absl::Status status = rpc::FromGrpc(stream_->Finish());
  EXPECT_EQ(status.code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(DetailOf(status).reason, "SHUTTING_DOWN");
  shutdown.join();
  EXPECT_TRUE(ended_.Wait());
}

}  // namespace
}  // namespace mortise::testing
