// Files of designs, fetched from a simulator that loses, damages and delays them.
#include "common/evaluation/design_file.h"

#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <stop_token>
#include <string>
#include <utility>

#include "common/base/digest.h"
#include "common/rpc/channel_security.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::evaluation {
namespace {

using Writer = grpc::ServerWriter<v1::Chunk>;
using Turn = std::function<grpc::Status(grpc::ServerContext&, Writer&)>;

void Send(const std::string& bytes, Writer& writer) {
  constexpr std::size_t kPiece = 1000;
  for (std::size_t at = 0; at < bytes.size(); at += kPiece) {
    v1::Chunk chunk;
    chunk.set_offset(static_cast<std::int64_t>(at));
    chunk.set_total_size(static_cast<std::int64_t>(bytes.size()));
    chunk.set_data(bytes.substr(at, kPiece));
    writer.Write(chunk);
  }
}

// Has one file. Does what was put in its turns, one a call, before it gives it.
class OneFile : public v1::SimulatorService::Service {
 public:
  explicit OneFile(std::string bytes) : bytes_(std::move(bytes)) {}

  grpc::Status DownloadBlob(grpc::ServerContext* context, const v1::DownloadBlobRequest* request,
                            Writer* writer) override {
    Turn turn;
    {
      const std::lock_guard lock(mutex_);
      ++calls_;
      if (!turns_.empty()) {
        turn = std::move(turns_.front());
        turns_.pop_front();
      }
    }
    if (turn) return turn(*context, *writer);
    if (request->sha256() != Sha256Hex(bytes_)) return {grpc::StatusCode::NOT_FOUND, "it is gone"};
    Send(bytes_, *writer);
    return grpc::Status::OK;
  }

  void Then(Turn turn) {
    const std::lock_guard lock(mutex_);
    turns_.push_back(std::move(turn));
  }
  int calls() {
    const std::lock_guard lock(mutex_);
    return calls_;
  }

 private:
  const std::string bytes_;
  std::mutex mutex_;
  std::deque<Turn> turns_;
  int calls_ = 0;
};

class DesignFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&simulator_);
    server_ = builder.BuildAndStart();
    channel_ = *rpc::MakeChannel("127.0.0.1:" + std::to_string(port), rpc::ChannelSecurity{});
  }
  void TearDown() override { server_->Shutdown(std::chrono::system_clock::now()); }

  absl::StatusOr<std::string> Fetch(const std::string& sha256, const std::stop_token& stop = {}) {
    rpc::RetryOptions retry;
    retry.stop = stop;
    return FetchDesignFile(channel_, sha256, {}, retry);
  }

  const std::string bytes_ = std::string(2500, 'x') + "end";
  const std::string digest_ = Sha256Hex(bytes_);
  OneFile simulator_{bytes_};
  std::unique_ptr<grpc::Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
};

TEST_F(DesignFileTest, ComesWhole) {
  const auto fetched = Fetch(digest_);
  ASSERT_TRUE(fetched.ok()) << fetched.status();
  EXPECT_EQ(*fetched, bytes_);
  EXPECT_EQ(simulator_.calls(), 1);
}

TEST_F(DesignFileTest, IsAskedForAgainWhereACallGetsLostOnTheWay) {
  simulator_.Then([](auto&, Writer& writer) {
    Send("half of it", writer);
    return grpc::Status(grpc::StatusCode::UNAVAILABLE, "it restarts");
  });
  const auto fetched = Fetch(digest_);
  ASSERT_TRUE(fetched.ok()) << fetched.status();
  EXPECT_EQ(*fetched, bytes_);
}

TEST_F(DesignFileTest, IsNeverTakenDamaged) {
  const auto damaged = [](auto&, Writer& writer) {
    Send("something else", writer);
    return grpc::Status::OK;
  };
  simulator_.Then(damaged);
  EXPECT_EQ(Fetch(digest_).value_or(""), bytes_);
  simulator_.Then(damaged);
  simulator_.Then(damaged);
  EXPECT_TRUE(absl::IsDataLoss(Fetch(digest_).status()));
}

TEST_F(DesignFileTest, SaysThatItIsGone) {
  EXPECT_TRUE(absl::IsNotFound(Fetch(Sha256Hex("another")).status()));
}

TEST_F(DesignFileTest, IsRefusedWhereItIsTooLarge) {
  simulator_.Then([](auto&, Writer& writer) {
    v1::Chunk chunk;
    chunk.set_total_size(std::int64_t{1} << 40);
    chunk.set_data("x");
    writer.Write(chunk);
    return grpc::Status::OK;
  });
  EXPECT_TRUE(absl::IsResourceExhausted(Fetch(digest_).status()));
}

TEST_F(DesignFileTest, IsGivenUpWhenAskedTo) {
  std::promise<void> begun;
  simulator_.Then([&begun](grpc::ServerContext& context, Writer& writer) {
    Send("a beginning", writer);
    begun.set_value();
    while (!context.IsCancelled()) std::this_thread::yield();
    return grpc::Status::CANCELLED;
  });
  std::stop_source stop;
  auto fetched = std::async(std::launch::async, [&] { return Fetch(digest_, stop.get_token()); });
  begun.get_future().wait();
  stop.request_stop();
  EXPECT_FALSE(fetched.get().ok());
}

}  // namespace
}  // namespace mortise::evaluation
