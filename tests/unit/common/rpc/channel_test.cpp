// Calling other services: what travels with a call, and what is tried again.
#include "common/rpc/channel.h"

#include <gtest/gtest.h>

#include <stop_token>
#include <thread>

#include "common/base/errors.h"
#include "tests/unit/common/rpc/probe_server.h"

namespace mortise::testing {
namespace {

using rpc::CallUnary;

class ChannelTest : public ProbeServerTest {
 protected:
  void SetUp() override {
    handlers_.read = [this](const rpc::Call& call,
                            const ReadRequest& request) -> absl::StatusOr<ReadResponse> {
      if (request.name() == "forward") {
        ReadRequest onward;
        onward.set_name("end");
        return CallUnary(*stub_, &ProbeService::Stub::Read, onward, rpc::ForwardedFrom(call));
      }
      if (failures_-- > 0) return absl::UnavailableError("not now");
      ReadResponse response;
      response.set_text(call.identity().subject + " " + call.identity().trace_id);
      response.set_number(absl::ToInt64Seconds(call.deadline() - absl::Now()));
      return response;
    };
    StartServer();
  }

  std::atomic<int> failures_ = 0;
};

TEST_F(ChannelTest, IdentityTraceAndDeadlineTravelOn) {
  ReadRequest request;
  request.set_name("forward");
  const auto response = CallUnary(*stub_, &ProbeService::Stub::Read, request,
                                  As(rpc::Role::kViewer, absl::Seconds(100)));
  ASSERT_OK(response);
  EXPECT_EQ(response->text(), "users/ada trace-7");
  EXPECT_GT(response->number(), 90);
  // gRPC rounds the time left up, by a hundredth at most.
  EXPECT_LE(response->number(), 101);
}

TEST_F(ChannelTest, AServiceCallsInItsOwnName) {
  const auto signer = *rpc::IdentitySigner::Load(keys(), "probe");
  const auto response =
      CallUnary(*stub_, &ProbeService::Stub::Read, {},
                rpc::OwnOrigin(signer.get(), rpc::Role::kOperator, "trace-8", absl::Seconds(20)));
  ASSERT_OK(response);
  EXPECT_EQ(response->text(), "services/probe trace-8");
}

TEST_F(ChannelTest, UnavailableIsTriedAgain) {
  failures_ = 3;
  EXPECT_OK(CallUnary(*stub_, &ProbeService::Stub::Read, {}, As(rpc::Role::kViewer),
                      {.first_delay = absl::Milliseconds(1)}));
  EXPECT_EQ(failures_, -1);
}

TEST_F(ChannelTest, TriesEndWithPatienceTheDeadlineOrAStop) {
  failures_ = 1000000;
  EXPECT_TRUE(absl::IsUnavailable(
      CallUnary(*stub_, &ProbeService::Stub::Read, {}, As(rpc::Role::kViewer),
                {.first_delay = absl::Milliseconds(1), .patience = absl::Milliseconds(30)})
          .status()));
  const absl::Time begin = absl::Now();
  EXPECT_FALSE(CallUnary(*stub_, &ProbeService::Stub::Read, {},
                         As(rpc::Role::kViewer, absl::Milliseconds(100)))
                   .ok());
  EXPECT_LT(absl::Now() - begin, absl::Seconds(5));
  // Stopped in the middle of a pause that nobody would wait for.
  std::stop_source stop;
  std::jthread stopper;
  const absl::Status stopped =
      rpc::CallWithRetry({},
                         {.first_delay = absl::Hours(1),
                          .patience = absl::InfiniteDuration(),
                          .stop = stop.get_token()},
                         [&](grpc::ClientContext*) {
                           stopper = std::jthread([&] { stop.request_stop(); });
                           return grpc::Status(grpc::StatusCode::UNAVAILABLE, "away");
                         });
  EXPECT_TRUE(absl::IsUnavailable(stopped));
}

TEST_F(ChannelTest, OtherFailuresAreNot) {
  int tries = 0;
  const absl::Status status = rpc::CallWithRetry({}, {}, [&](grpc::ClientContext*) {
    ++tries;
    return rpc::ToGrpc(ResourceNotFound("x"));
  });
  EXPECT_TRUE(absl::IsNotFound(status));
  EXPECT_EQ(tries, 1);
}

TEST_F(ChannelTest, PeersAreFoundByName) {
  rpc::Peers peers({{"probe", host_->address()}}, {});
  const auto channel = peers.Channel("probe");
  ASSERT_OK(channel);
  EXPECT_EQ(*channel, *peers.Channel("probe"));
  EXPECT_EQ(DetailOf(peers.Channel("simulator").status()).reason, "PEER_UNKNOWN");
}

}  // namespace
}  // namespace mortise::testing
