// A whole service in the test's process: its operations, events and audit records over gRPC.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/host/operation_codec.h"
#include "common/host/run_service.h"
#include "common/operations/operations.h"
#include "common/rpc/channel.h"
#include "mortise/v1/audit.grpc.pb.h"
#include "mortise/v1/events.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "tests/support/status_assertions.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/common/rpc/probe_service.h"

namespace mortise::testing {
namespace {

using rpc::CallUnary;

class RunningServiceTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_OK(rpc::CreateIdentityKey(folder_.path() / "keys", "gateway"));
    ASSERT_OK(rpc::CreateIdentityKey(folder_.path() / "keys", "probe"));
    gateway_ = *rpc::IdentitySigner::Load(folder_.path() / "keys", "gateway");
    handlers_.begin = [this](const rpc::Call& call, const KeepRequest& request,
                             store::Transaction& transaction) -> absl::StatusOr<v1::Operation> {
      jobs::NewOperation wanted =
          rpc::OperationOf(call, "probe.work", "things/" + request.name(), request.value());
      if (!keeps_methods_) wanted.method.clear();
      MORTISE_ASSIGN_OR_RETURN(jobs::Operation operation,
                               service_->environment().operations->Start(transaction, wanted));
      return rpc::ToProto(operation);
    };
    Start();
  }

  void TearDown() override {
    Release();
    service_.reset();
  }

  rpc::ServiceOptions Options() {
    rpc::ServiceOptions options;
    options.name = "probe";
    options.store = "sqlite:" + (folder_.path() / "probe.db").string();
    options.blobs = folder_.path() / "blobs";
    options.keys = folder_.path() / "keys";
    options.metrics = "127.0.0.1:0";
    options.port_file = folder_.path() / "ports.json";
    return options;
  }

  void Start() {
    auto service = rpc::RunningService::Start(Options(), [this](rpc::ServiceEnvironment& given) {
      given.operations->Register("probe.work",
                                 [this](jobs::OperationContext& context) { return Work(context); });
      return absl::StatusOr<std::vector<std::shared_ptr<grpc::Service>>>(
          std::vector<std::shared_ptr<grpc::Service>>{
              std::make_shared<ProbeAdapter>(given.dispatcher, &handlers_)});
    });
    ASSERT_OK(service);
    service_ = *std::move(service);
    const auto channel = *rpc::MakeChannel(service_->address(), {});
    probe_ = ProbeService::NewStub(channel);
    operations_ = v1::OperationService::NewStub(channel);
    events_ = v1::EventService::NewStub(channel);
    audit_ = v1::AuditService::NewStub(channel);
  }

  // Reports progress, then waits to be released or cancelled.
  absl::StatusOr<std::string> Work(jobs::OperationContext& context) {
    context.ReportProgress({.done = 1, .total = 2, .message = "half"});
    if (context.request() == "fail") return InvalidField("value", "was told to fail");
    std::unique_lock lock(mutex_);
    if (!changed_.wait(lock, context.stop_token(), [this] { return released_; })) {
      return absl::CancelledError("cancelled");
    }
    Kept kept;
    kept.set_value(context.request());
    return rpc::PackResult(kept);
  }

  void Release() {
    std::lock_guard lock(mutex_);
    released_ = true;
    changed_.notify_all();
  }

  rpc::Origin As(rpc::Role role) {
    rpc::Origin origin;
    origin.deadline = absl::Now() + absl::Seconds(30);
    origin.identity = [this, role] { return gateway_->Sign("users/ada", role, "trace-9"); };
    return origin;
  }

  v1::Operation Begin(const std::string& id, const std::string& value) {
    KeepRequest request;
    request.set_request_id(id);
    request.set_name("a");
    request.set_value(value);
    const auto operation =
        CallUnary(*probe_, &ProbeService::Stub::Begin, request, As(rpc::Role::kOperator));
    EXPECT_OK(operation);
    return operation.ok() ? *operation : v1::Operation();
  }

  absl::StatusOr<v1::Operation> Wait(const std::string& name, std::optional<double> seconds = {}) {
    v1::WaitOperationRequest request;
    request.set_name(name);
    if (seconds) request.set_timeout_seconds(*seconds);
    return CallUnary(*operations_, &v1::OperationService::Stub::WaitOperation, request,
                     As(rpc::Role::kViewer));
  }

  absl::StatusOr<v1::Operation> Cancel(const std::string& id, const std::string& name,
                                       rpc::Role role = rpc::Role::kOperator) {
    v1::CancelOperationRequest request;
    request.set_request_id(id);
    request.set_name(name);
    return CallUnary(*operations_, &v1::OperationService::Stub::CancelOperation, request, As(role));
  }

  absl::StatusOr<v1::ListOperationsResponse> List(const v1::ListOperationsRequest& request) {
    return CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                     As(rpc::Role::kViewer));
  }

  // Events from the first on, until one of `type`.
  std::vector<v1::Event> FollowUntil(const std::string& type,
                                     const v1::FollowEventsRequest& request = {}) {
    auto context = rpc::MakeClientContext(As(rpc::Role::kViewer));
    auto reader = events_->FollowEvents(context.get(), request);
    std::vector<v1::Event> events;
    v1::Event event;
    while (reader->Read(&event)) {
      events.push_back(event);
      if (event.type() == type) break;
    }
    context->TryCancel();
    reader->Finish();
    return events;
  }

  TemporaryFolder folder_;
  ProbeHandlers handlers_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  bool released_ = false;
  bool keeps_methods_ = true;  // as versions do that keep which method started an operation
  std::unique_ptr<rpc::IdentitySigner> gateway_;
  std::unique_ptr<rpc::RunningService> service_;
  std::unique_ptr<ProbeService::Stub> probe_;
  std::unique_ptr<v1::OperationService::Stub> operations_;
  std::unique_ptr<v1::EventService::Stub> events_;
  std::unique_ptr<v1::AuditService::Stub> audit_;
};

TEST_F(RunningServiceTest, AnOperationRunsToItsResult) {
  const v1::Operation begun = Begin("r-1", "x");
  EXPECT_EQ(begun.subject(), "things/a");
  EXPECT_EQ(begun.creator(), "users/ada");
  EXPECT_EQ(Begin("r-1", "x").name(), begun.name()) << "one request, one operation";
  Release();
  const auto done = Wait(begun.name());
  ASSERT_OK(done);
  EXPECT_EQ(done->state(), v1::Operation::SUCCEEDED);
  EXPECT_EQ(done->progress().total(), 2);
  Kept kept;
  ASSERT_TRUE(done->result().UnpackTo(&kept));
  EXPECT_EQ(kept.value(), "x");
}

TEST_F(RunningServiceTest, AFailureKeepsItsDetails) {
  const auto failed = Wait(Begin("r-1", "fail").name());
  ASSERT_OK(failed);
  EXPECT_EQ(failed->state(), v1::Operation::FAILED);
  EXPECT_EQ(failed->error().code(), 3);
  EXPECT_EQ(failed->error().details_size(), 2);
}

TEST_F(RunningServiceTest, AWaitEndsInTime) {
  const std::string name = Begin("r-1", "x").name();
  const auto waited = Wait(name, 0.05);
  ASSERT_OK(waited);
  EXPECT_NE(waited->state(), v1::Operation::SUCCEEDED);
  // A wait of 0 is one, and not the default of a minute.
  const auto now = Wait(name, 0);
  ASSERT_OK(now);
  EXPECT_NE(now->state(), v1::Operation::SUCCEEDED);
  EXPECT_EQ(DetailOf(Wait(name, -1).status()).field, "timeout_seconds");
  EXPECT_TRUE(absl::IsNotFound(Wait("operations/probe/none").status()));
}

TEST_F(RunningServiceTest, AnOperationIsCancelled) {
  const std::string name = Begin("r-1", "x").name();
  ASSERT_OK(Cancel("c-1", name));
  ASSERT_OK(Cancel("c-1", name));
  const auto done = Wait(name);
  ASSERT_OK(done);
  EXPECT_EQ(done->state(), v1::Operation::CANCELLED);
}

// Beginning takes an operator: so does stopping what was begun.
TEST_F(RunningServiceTest, CancellingTakesTheRoleOfWhatStartedIt) {
  const v1::Operation begun = Begin("r-1", "x");
  EXPECT_EQ(begun.method(), "mortise.testing.ProbeService/Begin");
  const absl::Status refused = Cancel("c-1", begun.name(), rpc::Role::kDesigner).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kPermissionDenied) << refused;
  EXPECT_EQ(DetailOf(refused).reason, "ROLE_REQUIRED");
  EXPECT_EQ(DetailOf(refused).field, begun.method());
  const auto running = Wait(begun.name(), 0.05);
  ASSERT_OK(running);
  EXPECT_FALSE(running->cancel_requested());
  EXPECT_NE(running->state(), v1::Operation::CANCELLED);
  const auto stopping = Cancel("c-2", begun.name(), rpc::Role::kOperator);
  ASSERT_OK(stopping);
  EXPECT_TRUE(stopping->cancel_requested());
  EXPECT_EQ(Wait(begun.name())->state(), v1::Operation::CANCELLED);
}

// Which role the method of an earlier version needed is not known: the most that any did.
TEST_F(RunningServiceTest, CancellingWhatAnEarlierVersionStartedTakesAnOperator) {
  keeps_methods_ = false;
  const v1::Operation begun = Begin("r-1", "x");
  EXPECT_EQ(begun.method(), "");
  EXPECT_EQ(Cancel("c-1", begun.name(), rpc::Role::kDesigner).status().code(),
            absl::StatusCode::kPermissionDenied);
  EXPECT_OK(Cancel("c-2", begun.name(), rpc::Role::kOperator));
}

TEST_F(RunningServiceTest, AWatchSeesTheEnd) {
  const std::string name = Begin("r-1", "x").name();
  v1::WatchOperationRequest request;
  request.set_name(name);
  auto context = rpc::MakeClientContext(As(rpc::Role::kViewer));
  auto reader = operations_->WatchOperation(context.get(), request);
  v1::Operation seen;
  ASSERT_TRUE(reader->Read(&seen));
  EXPECT_EQ(seen.name(), name);
  Release();
  while (reader->Read(&seen)) {
  }
  EXPECT_TRUE(reader->Finish().ok());
  EXPECT_EQ(seen.state(), v1::Operation::SUCCEEDED);
}

TEST_F(RunningServiceTest, ListsOperationsNewestFirst) {
  Release();
  std::vector<std::string> names;
  for (int i = 0; i < 5; ++i) names.push_back(Begin("r-" + std::to_string(i), "x").name());
  v1::ListOperationsRequest request;
  request.set_page_size(3);
  std::vector<std::string> listed;
  do {
    const auto page = CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                                As(rpc::Role::kViewer));
    ASSERT_OK(page);
    for (const v1::Operation& operation : page->operations()) listed.push_back(operation.name());
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, std::vector<std::string>(names.rbegin(), names.rend()));
  request.set_page_size(1001);
  EXPECT_EQ(DetailOf(CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                               As(rpc::Role::kViewer))
                         .status())
                .field,
            "page_size");
  request.set_page_size(3);
  // A token of the list of all services is none of the list of one.
  const auto whole = CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                               As(rpc::Role::kViewer));
  ASSERT_OK(whole);
  ASSERT_FALSE(whole->next_page_token().empty());
  request.set_page_token(whole->next_page_token());
  request.set_service("probe");
  EXPECT_EQ(DetailOf(CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                               As(rpc::Role::kViewer))
                         .status())
                .field,
            "page_token");
  request.set_page_token("no such token");
  EXPECT_EQ(DetailOf(CallUnary(*operations_, &v1::OperationService::Stub::ListOperations, request,
                               As(rpc::Role::kViewer))
                         .status())
                .field,
            "page_token");
}

// gRPC's clients take 4 MiB: a page of large operations is shorter than was asked for.
TEST_F(RunningServiceTest, APageOfLargeOperationsFitsIntoAMessage) {
  constexpr int kOperations = 12;
  Release();
  std::vector<std::string> names;
  for (int i = 0; i < kOperations; ++i) {
    names.push_back(Begin("r-" + std::to_string(i), std::string(900'000, 'x')).name());
    ASSERT_OK(Wait(names.back()));
  }
  v1::ListOperationsRequest request;
  std::vector<std::string> listed;
  int pages = 0;
  do {
    const auto page = List(request);
    ASSERT_OK(page);
    EXPECT_LT(page->ByteSizeLong(), std::size_t{4} << 20);
    for (const v1::Operation& operation : page->operations()) {
      listed.push_back(operation.name());
      EXPECT_TRUE(operation.has_result());
    }
    request.set_page_token(page->next_page_token());
    ASSERT_LE(++pages, kOperations);
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, std::vector<std::string>(names.rbegin(), names.rend()));
  EXPECT_GT(pages, 1);
  request.set_omit_results(true);
  const auto without = List(request);
  ASSERT_OK(without);
  EXPECT_EQ(without->operations_size(), kOperations);
  EXPECT_FALSE(without->operations(0).has_result());
}

TEST_F(RunningServiceTest, ListsOnlyWhatPassesTheFilters) {
  const std::string running = Begin("r-1", "x").name();
  const std::string failed = Begin("r-2", "fail").name();
  ASSERT_OK(Wait(failed));
  const auto names = [&](const v1::ListOperationsRequest& request) {
    std::vector<std::string> found;
    const auto page = List(request);
    EXPECT_OK(page);
    for (const v1::Operation& operation : page->operations()) found.push_back(operation.name());
    return found;
  };
  v1::ListOperationsRequest request;
  request.add_states(v1::Operation::FAILED);
  EXPECT_EQ(names(request), std::vector<std::string>{failed});
  request.set_states(0, v1::Operation::PENDING);
  request.add_states(v1::Operation::RUNNING);
  EXPECT_EQ(names(request), std::vector<std::string>{running});
  request.set_kind("pareto.discovery");
  EXPECT_TRUE(names(request).empty());
  request.Clear();
  request.set_subject("things/a");
  EXPECT_EQ(names(request), (std::vector<std::string>{failed, running}));
  request.set_subject("things/b");
  EXPECT_TRUE(names(request).empty());
  request.add_states(v1::Operation::STATE_UNSPECIFIED);
  EXPECT_EQ(DetailOf(List(request).status()).field, "states[0]");
}

TEST_F(RunningServiceTest, FiltersThatMeanNothingAreRefusedByName) {
  v1::ListOperationsRequest request;
  request.set_kind("zzz");
  EXPECT_EQ(List(request).status().message(),
            "kind: 'zzz' is none of fabplanner.plan, fabplanner.workOrder, pareto.discovery, "
            "simulator.analysis");
  request.set_kind("");
  request.set_subject("nope");
  EXPECT_EQ(List(request).status().message(),
            "subject: 'nope' is no resource name, such as fronts/a1");
}

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
    response.set_text(call.identity().subject + " " + call.identity().request_id);
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
