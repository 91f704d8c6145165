// A whole service in the test's process: its life, its events and its audit records.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/host/run_service.h"
#include "common/rpc/channel.h"
#include "mortise/v1/audit.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/support/status_assertions.h"
#include "tests/unit/common/host/running_service_fixture.h"
#include "tests/unit/common/rpc/probe_service.h"

namespace mortise::testing {
namespace {

using rpc::CallUnary;

TEST_F(RunningServiceTest, EventsAreFollowedInOrder) {
  Release();
  const std::string name = Begin("r-1", "x").name();
  const std::vector<v1::Event> events = FollowUntil("operation.succeeded");
  ASSERT_FALSE(events.empty());
  for (std::size_t i = 0; i < events.size(); ++i) {
    EXPECT_EQ(events[i].number(), static_cast<int64_t>(i) + 1);
    EXPECT_EQ(events[i].stream(), "probe");
  }
  EXPECT_EQ(events.back().subject(), name);
  EXPECT_EQ(events.back().trace_id(), "trace-9");
  EXPECT_EQ(events.back().data().front(), '{');

  v1::FollowEventsRequest only_ends;
  only_ends.add_type_prefixes("operation.succ");
  EXPECT_EQ(FollowUntil("operation.succeeded", only_ends).size(), 1u);
  v1::ReadEventsRequest read;
  read.set_stream("probe");
  read.set_after_number(1);
  const auto page =
      CallUnary(*events_, &v1::EventService::Stub::ReadEvents, read, As(rpc::Role::kViewer));
  ASSERT_OK(page);
  EXPECT_EQ(page->events(0).number(), 2);
  EXPECT_GE(page->latest_number(), static_cast<int64_t>(events.size()));
  read.set_stream("other");
  EXPECT_EQ(DetailOf(CallUnary(*events_, &v1::EventService::Stub::ReadEvents, read,
                               As(rpc::Role::kViewer))
                         .status())
                .field,
            "stream");
}

TEST_F(RunningServiceTest, AFollowerOfTheFutureSeesOnlyWhatComes) {
  Release();
  Begin("r-1", "x");
  const int64_t past = FollowUntil("operation.succeeded").back().number();
  v1::FollowEventsRequest request;
  request.set_after_number(-1);
  auto context = rpc::MakeClientContext(As(rpc::Role::kViewer));
  auto reader = events_->FollowEvents(context.get(), request);
  // When the follower has begun cannot be seen from here, so things go on happening until it has.
  std::atomic<bool> seen = false;
  std::thread later([&] {
    for (int i = 2; !seen; ++i) Wait(Begin("r-" + std::to_string(i), "x").name()).IgnoreError();
  });
  v1::Event event;
  EXPECT_TRUE(reader->Read(&event));
  seen = true;
  later.join();
  EXPECT_GT(event.number(), past);
  context->TryCancel();
  reader->Finish();
}

TEST_F(RunningServiceTest, TheAuditLogIsForAdministrators) {
  const std::string name = Begin("r-1", "x").name();
  const auto list = [&](rpc::Role role) {
    return CallUnary(*audit_, &v1::AuditService::Stub::ListAuditRecords, {}, As(role));
  };
  EXPECT_EQ(list(rpc::Role::kOperator).status().code(), absl::StatusCode::kPermissionDenied);
  const auto records = list(rpc::Role::kAdmin);
  ASSERT_OK(records);
  ASSERT_EQ(records->records_size(), 1);
  EXPECT_EQ(records->records(0).method(), "mortise.testing.ProbeService/Begin");
  EXPECT_EQ(records->records(0).resource(), name);
  v1::ListAuditRecordsRequest garbage;
  garbage.set_page_token("no such token");
  EXPECT_EQ(DetailOf(CallUnary(*audit_, &v1::AuditService::Stub::ListAuditRecords, garbage,
                               As(rpc::Role::kAdmin))
                         .status())
                .field,
            "page_token");
}

TEST_F(RunningServiceTest, UnfinishedOperationsGoOnAfterARestart) {
  const std::string name = Begin("r-1", "x").name();
  service_.reset();
  Start();
  Release();
  const auto done = Wait(name);
  ASSERT_OK(done);
  EXPECT_EQ(done->state(), v1::Operation::SUCCEEDED);
}

TEST_F(RunningServiceTest, ThePortFileTellsTheAddresses) {
  const auto text = ReadFile(folder_.path() / "ports.json");
  ASSERT_OK(text);
  EXPECT_NE(text->find("\"grpc\":\"" + service_->address() + "\""), std::string::npos) << *text;
  EXPECT_NE(text->find("\"metrics\":\"" + service_->metrics_address() + "\""), std::string::npos);
}

TEST_F(RunningServiceTest, StartFailsClearly) {
  const auto start = [](rpc::ServiceOptions options) {
    return rpc::RunningService::Start(options,
                                      [](rpc::ServiceEnvironment&) {
                                        return std::vector<std::shared_ptr<grpc::Service>>();
                                      })
        .status();
  };
  rpc::ServiceOptions no_keys = Options();
  no_keys.keys = folder_.path() / "none";
  EXPECT_FALSE(start(no_keys).ok());

  rpc::ServiceOptions bad_store = Options();
  bad_store.store = "sqlite:/proc/none/probe.db";
  EXPECT_NE(start(bad_store).message().find("/proc/none"), absl::string_view::npos);

  rpc::ServiceOptions open = Options();
  open.keys.clear();
  open.insecure_development = true;
  open.listen = "0.0.0.0:0";
  EXPECT_EQ(DetailOf(start(open)).field, "insecure-development");
}

TEST_F(RunningServiceTest, DevelopmentTakesEveryoneForAnAdministrator) {
  rpc::ServiceOptions options = Options();
  options.store = "sqlite:" + (folder_.path() / "other.db").string();
  options.keys.clear();
  options.insecure_development = true;
  ProbeHandlers handlers;
  handlers.read = [](const rpc::Call& call, const ReadRequest&) -> absl::StatusOr<ReadResponse> {
    ReadResponse response;
    response.set_text(call.identity().subject + " " + call.identity().trace_id);
    return response;
  };
  auto service = rpc::RunningService::Start(options, [&](rpc::ServiceEnvironment& environment) {
    return std::vector<std::shared_ptr<grpc::Service>>{
        std::make_shared<ProbeAdapter>(environment.dispatcher, &handlers)};
  });
  ASSERT_OK(service);
  const auto stub = ProbeService::NewStub(*rpc::MakeChannel((*service)->address(), {}));
  const auto response =
      CallUnary(*stub, &ProbeService::Stub::Read, {},
                rpc::OwnOrigin(nullptr, rpc::Role::kViewer, "trace-3", absl::Seconds(20)));
  ASSERT_OK(response);
  EXPECT_EQ(response->text(), "users/developer trace-3");
}

}  // namespace
}  // namespace mortise::testing
