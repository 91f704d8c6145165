// Unary calls through a real server: who may call, what is refused, how failures arrive.
#include <gtest/gtest.h>

#include <condition_variable>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "tests/unit/common/rpc/probe_server.h"

namespace mortise::testing {
namespace {

class UnaryCallTest : public ProbeServerTest {
 protected:
  void SetUp() override {
    handlers_.read = [this](const rpc::Call& call,
                            const ReadRequest& request) -> absl::StatusOr<ReadResponse> {
      ++reads_;
      ReadResponse response;
      response.set_text(call.identity().subject + " asked for " + request.name());
      return response;
    };
    begun_ = absl::Now();
    StartServer();
  }

  absl::Status ReadWith(grpc::ClientContext* context) {
    ReadResponse response;
    return rpc::FromGrpc(stub_->Read(context, {}, &response));
  }

  absl::Time begun_;  // before there was a server or a channel
  std::atomic<int> reads_ = 0;
};

TEST_F(UnaryCallTest, AnswersWhoMayAsk) {
  ReadRequest request;
  request.set_name("items/board");
  const auto response = Read(request);
  ASSERT_OK(response);
  EXPECT_EQ(response->text(), "users/ada asked for items/board");
}

TEST_F(UnaryCallTest, RefusesCallersWithoutIdentity) {
  grpc::ClientContext nobody;
  EXPECT_EQ(ReadWith(&nobody).code(), absl::StatusCode::kUnauthenticated);
  grpc::ClientContext forged;
  forged.AddMetadata(rpc::kIdentityMetadata, "forged");
  EXPECT_EQ(ReadWith(&forged).code(), absl::StatusCode::kUnauthenticated);
  grpc::ClientContext impostor;
  const auto probe = *rpc::IdentitySigner::Load(keys(), "probe");
  impostor.AddMetadata(rpc::kIdentityMetadata, probe->Sign("users/ada", rpc::Role::kAdmin, "r"));
  EXPECT_EQ(DetailOf(ReadWith(&impostor)).reason, "IDENTITY_INVALID");
  EXPECT_EQ(reads_, 0);
}

TEST_F(UnaryCallTest, EnforcesTheRoleOfEachMethod) {
  EXPECT_EQ(Read({}, rpc::Role::kNone).status().code(), absl::StatusCode::kPermissionDenied);
  EXPECT_OK(Read({}, rpc::Role::kViewer));
  EXPECT_OK(Read({}, rpc::Role::kAdmin));
  const absl::Status refused = Keep({}, rpc::Role::kViewer).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(DetailOf(refused).reason, "ROLE_REQUIRED");
  EXPECT_EQ(DetailOf(refused).field, "mortise.testing.ProbeService/Keep");
}

TEST_F(UnaryCallTest, RefusesMethodsWithoutARule) {
  ReadResponse response;
  const absl::Status status =
      rpc::FromGrpc(stub_->Undeclared(Context(rpc::Role::kAdmin).get(), {}, &response));
  EXPECT_EQ(status.code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(DetailOf(status).reason, "ACCESS_UNDECLARED");
  EXPECT_EQ(reads_, 0);
}

TEST_F(UnaryCallTest, RefusesNumbersAndEnumsThatNoHandlerShouldSee) {
  ReadRequest numbers;
  numbers.add_parts()->set_number(std::numeric_limits<double>::quiet_NaN());
  const absl::Status not_finite = Read(numbers).status();
  EXPECT_EQ(not_finite.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(DetailOf(not_finite).field, "parts[0].number");

  ReadRequest shades;
  shades.add_shades(static_cast<Shade>(99));
  EXPECT_EQ(DetailOf(Read(shades).status()).field, "shades[0]");
  EXPECT_EQ(reads_, 0);
}

TEST_F(UnaryCallTest, RefusesMessagesOverFourMebibytes) {
  ReadRequest request;
  request.set_filler(std::string(rpc::kMaxMessageBytes - 100, 'x'));
  EXPECT_OK(Read(request));
  request.set_filler(std::string(rpc::kMaxMessageBytes + 1, 'x'));
  EXPECT_EQ(Read(request).status().code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(reads_, 1);
}

TEST_F(UnaryCallTest, TheLogAndTheHandlerShareTheTraceId) {
  std::string trace;
  handlers_.read = [&](const rpc::Call&, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
    trace = CurrentTraceId();
    return ReadResponse();
  };
  ASSERT_OK(Read());
  EXPECT_EQ(trace, "trace-7");
}

TEST_F(UnaryCallTest, AnIdentityForManyRequestsLeavesTheTraceIdToTheCall) {
  std::string trace;
  handlers_.read = [&](const rpc::Call& call, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
    trace = call.identity().trace_id;
    return ReadResponse();
  };
  const std::string identity = gateway_->Sign("users/ada", rpc::Role::kViewer, "");
  for (const std::string given : {"request-1", "request-2", "not one"}) {
    grpc::ClientContext context;
    context.AddMetadata(rpc::kIdentityMetadata, identity);
    context.AddMetadata(rpc::kTraceMetadata, given);
    ASSERT_OK(ReadWith(&context));
    if (given == "not one") {
      EXPECT_NE(trace, given);
      EXPECT_FALSE(trace.empty());
    } else {
      EXPECT_EQ(trace, given);
    }
  }
}

TEST_F(UnaryCallTest, FailuresKeepTheirDetails) {
  handlers_.read = [](const rpc::Call&, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
    return StaleRevision("items/board", 2, 5);
  };
  const absl::Status status = Read().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kAborted);
  EXPECT_EQ(DetailOf(status).reason, "STALE_REVISION");
  EXPECT_EQ(DetailOf(status).field, "items/board");
}

TEST_F(UnaryCallTest, ExceptionsBecomeInternalAndTellNothing) {
  handlers_.read = [](const rpc::Call&, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
    throw std::runtime_error("secret path");
  };
  const absl::Status status = Read().status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal);
  EXPECT_EQ(status.message().find("secret"), absl::string_view::npos);
  EXPECT_NE(status.message().find("trace-7"), absl::string_view::npos);
  handlers_.read = [](const rpc::Call&, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
    throw 7;
  };
  EXPECT_EQ(Read().status().code(), absl::StatusCode::kInternal);
}

TEST_F(UnaryCallTest, TheDeadlineReachesTheHandler) {
  absl::Time seen = absl::InfinitePast();
  absl::Time arrived = absl::InfinitePast();
  handlers_.read = [&](const rpc::Call& call, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
    seen = call.deadline();
    arrived = absl::Now();
    return ReadResponse();
  };
  // gRPC sends not the deadline but the time left, in milliseconds rounded up to three digits (to
  // 100 ms from 10 s on, to 1 s from 100 s on, to 10 s from 1000 s on; so 100 s and any fraction of
  // a millisecond are sent as 101 s), and the server adds it to its own time. Up to the resolution,
  // the deadline comes at most a hundredth of the time left late, and whatever the way took. gRPC's
  // two readings of the time fall between begun_ and `arrived`, which bounds their difference.
  constexpr absl::Duration kResolution = absl::Milliseconds(3);  // two readings and the deadline
  rpc::Origin origin = As(rpc::Role::kViewer);
  for (const double seconds : {55.05, 100.0, 100.5, 1001.0, 4000.0}) {
    SCOPED_TRACE(seconds);
    origin.deadline = absl::Now() + absl::Seconds(seconds);
    ASSERT_OK(ReadWith(rpc::MakeClientContext(origin).get()));
    EXPECT_GE(seen, begun_ + (origin.deadline - arrived) - kResolution);
    EXPECT_LE(seen, arrived + 1.01 * (origin.deadline - begun_) + kResolution);
  }

  origin.deadline = absl::InfiniteFuture();
  ASSERT_OK(ReadWith(rpc::MakeClientContext(origin).get()));
  EXPECT_EQ(seen, absl::InfiniteFuture());
}

TEST_F(UnaryCallTest, AWaitingHandlerLearnsThatTheCallerIsGone) {
  std::mutex mutex;
  std::condition_variable changed;
  bool begun = false;
  bool told = false;
  handlers_.await = [&](const rpc::Call& call, const ReadRequest&,
                        const rpc::Responder<ReadResponse>& respond) {
    call.OnStop([&, call, respond] {
      EXPECT_TRUE(call.cancelled());
      respond(absl::CancelledError("stopped"));
      std::lock_guard lock(mutex);
      told = true;
      changed.notify_all();
    });
    std::lock_guard lock(mutex);
    begun = true;
    changed.notify_all();
    return absl::OkStatus();
  };
  auto context = Context(rpc::Role::kViewer);
  std::thread canceller([&] {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return begun; });
    context->TryCancel();
  });
  ReadResponse response;
  EXPECT_EQ(stub_->Await(context.get(), {}, &response).error_code(), grpc::StatusCode::CANCELLED);
  canceller.join();
  std::unique_lock lock(mutex);
  EXPECT_TRUE(changed.wait_for(lock, std::chrono::seconds(20), [&] { return told; }));
}

TEST_F(UnaryCallTest, AWaitingCallHoldsNoThread) {
  std::mutex mutex;
  std::condition_variable changed;
  std::vector<rpc::Responder<ReadResponse>> waiting;
  handlers_.await = [&](const rpc::Call&, const ReadRequest&,
                        const rpc::Responder<ReadResponse>& respond) {
    std::lock_guard lock(mutex);
    waiting.push_back(respond);
    changed.notify_all();
    return absl::OkStatus();
  };
  constexpr std::size_t kCalls = 20;  // five times the threads there are
  std::vector<std::thread> callers;
  std::atomic<int> answered = 0;
  for (std::size_t i = 0; i < kCalls; ++i) {
    callers.emplace_back([&] {
      ReadResponse response;
      EXPECT_TRUE(stub_->Await(Context(rpc::Role::kViewer).get(), {}, &response).ok());
      answered += static_cast<int>(response.number());
    });
  }
  {
    std::unique_lock lock(mutex);
    changed.wait(lock, [&] { return waiting.size() == kCalls; });
    EXPECT_OK(Read()) << "threads are left for other calls";
    EXPECT_EQ(dispatcher_->calls(), static_cast<int>(kCalls));
    for (const auto& respond : waiting) {
      ReadResponse response;
      response.set_number(1);
      respond(response);
      respond(absl::InternalError("only the first answer counts"));
    }
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(answered, static_cast<int>(kCalls));
}

TEST_F(UnaryCallTest, SurvivesRandomBytesAsIdentity) {
  std::string bytes;
  for (int i = 0; i < 256; ++i) {
    bytes.push_back(static_cast<char>(i * 37));
    grpc::ClientContext context;
    context.AddMetadata(rpc::kIdentityMetadata, bytes);
    EXPECT_EQ(ReadWith(&context).code(), absl::StatusCode::kUnauthenticated);
  }
}

}  // namespace
}  // namespace mortise::testing
