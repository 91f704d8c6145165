// Commands that wait, as a person at a terminal meets them: what they say at once, what Ctrl-C and
// SIGTERM do, and `mortise operations`; against a gateway that this test plays.
#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/files.h"
#include "mortise/v1/fabplanner.grpc.pb.h"
#include "mortise/v1/operations.grpc.pb.h"
#include "mortise/v1/pareto.pb.h"
#include "tests/support/child_process.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kPlanning[] = "operations/fabplanner/p1";
constexpr char kCutting[] = "operations/fabplanner/w1";

// Operations that go on until they are cancelled or the test ends them.
class PlayedHouse final : public v1::OperationService::Service,
                          public v1::FabPlannerService::Service {
 public:
  grpc::Status CreatePlan(grpc::ServerContext*, const v1::CreatePlanRequest*,
                          v1::Operation* response) override {
    std::unique_lock lock(mutex_);
    planning_asked_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return answers_; });
    *response = Begin(kPlanning, "CreatePlan", "templates/table");
    return grpc::Status::OK;
  }

  grpc::Status ReleaseWorkOrder(grpc::ServerContext*, const v1::ReleaseWorkOrderRequest*,
                                v1::Operation* response) override {
    const std::lock_guard lock(mutex_);
    *response = Begin(kCutting, "ReleaseWorkOrder", "workOrders/o1");
    return grpc::Status::OK;
  }

  grpc::Status GetOperation(grpc::ServerContext*, const v1::GetOperationRequest* request,
                            v1::Operation* response) override {
    const std::lock_guard lock(mutex_);
    const auto found = operations_.find(request->name());
    if (found == operations_.end()) return {grpc::StatusCode::NOT_FOUND, "no such operation"};
    *response = found->second;
    return grpc::Status::OK;
  }

  grpc::Status ListOperations(grpc::ServerContext*, const v1::ListOperationsRequest* request,
                              v1::ListOperationsResponse* response) override {
    const std::lock_guard lock(mutex_);
    listed_.push_back(*request);
    // Pages of one, as those of large operations are.
    auto next = request->page_token().empty() ? operations_.begin()
                                              : operations_.upper_bound(request->page_token());
    if (next == operations_.end()) return grpc::Status::OK;
    *response->add_operations() = next->second;
    if (std::next(next) != operations_.end()) response->set_next_page_token(next->first);
    return grpc::Status::OK;
  }

  grpc::Status CancelOperation(grpc::ServerContext*, const v1::CancelOperationRequest* request,
                               v1::Operation* response) override {
    const std::lock_guard lock(mutex_);
    cancelled_.push_back(request->name());
    v1::Operation& operation = operations_[request->name()];
    operation.set_cancel_requested(true);
    if (stops_) {
      operation.set_state(v1::Operation::CANCELLED);
      v1::Front front;
      front.set_name("fronts/best");
      operation.mutable_result()->PackFrom(front);
    }
    *response = operation;
    changed_.notify_all();
    return grpc::Status::OK;
  }

  grpc::Status WatchOperation(grpc::ServerContext* context,
                              const v1::WatchOperationRequest* request,
                              grpc::ServerWriter<v1::Operation>* writer) override {
    std::unique_lock lock(mutex_);
    while (!context->IsCancelled()) {
      const v1::Operation now = operations_[request->name()];
      if (!writer->Write(now)) break;
      if (now.state() != v1::Operation::RUNNING) break;
      // Looks now and then whether the watcher is still there.
      changed_.wait_for(lock, std::chrono::milliseconds(50));
    }
    return grpc::Status::OK;
  }

  v1::Operation Begin(const std::string& name, const std::string& method,
                      const std::string& subject) {
    v1::Operation& operation = operations_[name];
    operation.set_name(name);
    operation.set_kind("fabplanner.work");
    operation.set_method("mortise.v1.FabPlannerService/" + method);
    operation.set_subject(subject);
    operation.set_creator("users/ada");
    operation.set_state(v1::Operation::RUNNING);
    operation.mutable_progress()->set_done(3);
    operation.mutable_progress()->set_total(10);
    operation.mutable_progress()->set_message("laying out boards");
    operation.mutable_create_time()->set_seconds(1);
    return operation;
  }

  void Add(const std::string& name) {
    const std::lock_guard lock(mutex_);
    Begin(name, "CreatePlan", "templates/table");
  }

  template <typename Message>
  void Finish(const std::string& name, const Message& result) {
    const std::lock_guard lock(mutex_);
    operations_[name].set_state(v1::Operation::SUCCEEDED);
    operations_[name].mutable_result()->PackFrom(result);
    changed_.notify_all();
  }

  // Whether the start of operations is answered, and whether they stop when cancelled.
  void SetAnswers(bool answers) {
    const std::lock_guard lock(mutex_);
    answers_ = answers;
    changed_.notify_all();
  }
  void SetStops(bool stops) {
    const std::lock_guard lock(mutex_);
    stops_ = stops;
  }

  void AwaitPlanning() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return planning_asked_; });
  }

  std::vector<std::string> cancelled() {
    const std::lock_guard lock(mutex_);
    return cancelled_;
  }

  std::vector<v1::ListOperationsRequest> listed() {
    const std::lock_guard lock(mutex_);
    return listed_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool answers_ = true;  // guarded by mutex_, as all below
  bool stops_ = true;
  bool planning_asked_ = false;
  std::map<std::string, v1::Operation> operations_;
  std::vector<std::string> cancelled_;
  std::vector<v1::ListOperationsRequest> listed_;
};

class LongWorkTest : public ::testing::Test {
 protected:
  LongWorkTest() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(static_cast<v1::OperationService::Service*>(&house_));
    builder.RegisterService(static_cast<v1::FabPlannerService::Service*>(&house_));
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  ~LongWorkTest() override { server_->Shutdown(std::chrono::system_clock::now()); }

  // `mortise` at this gateway.
  std::unique_ptr<testing::ChildProcess> Start(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command = {testing::BuiltProgram("mortise"), "--gateway", address_};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return std::make_unique<testing::ChildProcess>(command);
  }

  // The same with standard output in a file, so that it is told from standard error.
  std::unique_ptr<testing::ChildProcess> StartJson(const std::string& arguments) const {
    const std::string line =
        absl::StrCat("exec ", testing::BuiltProgram("mortise"), " --json --gateway ", address_, " ",
                     arguments, " > ", (folder_.path() / "out").string());
    return std::make_unique<testing::ChildProcess>(std::vector<std::string>{"/bin/sh", "-c", line});
  }

  // What was written there: exactly one document.
  Json Document() const {
    const std::string text = ReadFile(folder_.path() / "out").value_or("");
    const Json document = Json::parse(text, nullptr, /*allow_exceptions=*/false);
    EXPECT_FALSE(document.is_discarded()) << text;
    return document;
  }

  std::string Command() const { return "mortise --gateway " + address_; }

  PlayedHouse house_;
  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  testing::TemporaryFolder folder_;
};

TEST_F(LongWorkTest, CtrlCCancelsWhatTheCommandStartedAndSaysWhatIsKept) {
  const auto plan = Start({"plan", "table"});
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  EXPECT_TRUE(house_.cancelled().empty());
  EXPECT_EQ(plan->End(SIGINT), 130);
  EXPECT_EQ(house_.cancelled(), std::vector<std::string>{kPlanning});
  EXPECT_THAT(plan->Output(), HasSubstr(absl::StrCat(kPlanning,
                                                     " was cancelled; its best so far "
                                                     "is kept in fronts/best")));
}

TEST_F(LongWorkTest, SigtermDoesTheSame) {
  const auto plan = Start({"plan", "table"});
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  EXPECT_EQ(plan->End(SIGTERM), 143);
  EXPECT_EQ(house_.cancelled(), std::vector<std::string>{kPlanning});
}

TEST_F(LongWorkTest, ASecondCtrlCLeavesAtOnceAndSaysHowToGoOn) {
  house_.SetStops(false);
  const auto plan = Start({"plan", "table"});
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  plan->Signal(SIGINT);
  ASSERT_TRUE(plan->AwaitOutput("Ctrl-C again leaves at once")) << plan->Output();
  EXPECT_EQ(plan->End(SIGINT), 130);
  EXPECT_THAT(plan->Output(),
              AllOf(HasSubstr(absl::StrCat(Command(), " operations watch ", kPlanning)),
                    HasSubstr(absl::StrCat(Command(), " operations cancel ", kPlanning))));
}

// What is asked for is begun by the time somebody could cancel it, and must not be left behind.
TEST_F(LongWorkTest, CtrlCWhileTheOperationIsBeingStartedCancelsItToo) {
  house_.SetAnswers(false);
  const auto plan = Start({"plan", "table"});
  house_.AwaitPlanning();
  plan->Signal(SIGINT);
  EXPECT_TRUE(plan->AwaitOutput("cancelling once it has started")) << plan->Output();
  house_.SetAnswers(true);
  EXPECT_EQ(plan->Wait(), 130);
  EXPECT_EQ(house_.cancelled(), std::vector<std::string>{kPlanning});
}

TEST_F(LongWorkTest, JsonStaysOneDocument) {
  const auto plan = StartJson("plan table");
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  EXPECT_EQ(plan->End(SIGINT), 130);
  const Json error = Document()["error"];
  EXPECT_EQ(error["code"], "CANCELLED");
  EXPECT_EQ(error["reason"], "INTERRUPTED");
  EXPECT_EQ(error["field"], kPlanning);
}

TEST_F(LongWorkTest, JsonStaysOneDocumentWhereACommandLeavesAtOnce) {
  house_.SetStops(false);
  const auto plan = StartJson("plan table");
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  plan->Signal(SIGINT);
  ASSERT_TRUE(plan->AwaitOutput("Ctrl-C again leaves at once")) << plan->Output();
  EXPECT_EQ(plan->End(SIGTERM), 143);
  EXPECT_EQ(Document()["error"]["reason"], "INTERRUPTED");
}

TEST_F(LongWorkTest, AnUndisturbedCommandPrintsItsResult) {
  const auto plan = StartJson("plan table");
  ASSERT_TRUE(plan->AwaitOutput(absl::StrCat(kPlanning, " started"))) << plan->Output();
  v1::Plan made;
  made.set_name("plans/p1");
  house_.Finish(kPlanning, made);
  EXPECT_EQ(plan->Wait(), 0);
  EXPECT_EQ(Document()["name"], "plans/p1");
  EXPECT_TRUE(house_.cancelled().empty());
}

TEST_F(LongWorkTest, MachinesGoOnWhenACommandIsLeft) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto release = Start({"fab", "release", "plans/p1"});
    ASSERT_TRUE(release->AwaitOutput("Ctrl-C leaves it running")) << release->Output();
    EXPECT_EQ(release->End(signal), 128 + signal);
    EXPECT_THAT(
        release->Output(),
        AllOf(HasSubstr("workOrders/o1 goes on"), HasSubstr(Command() + " fab hold workOrders/o1"),
              HasSubstr(Command() + " fab watch workOrders/o1"),
              HasSubstr(absl::StrCat(Command(), " operations cancel ", kCutting))));
  }
  EXPECT_TRUE(house_.cancelled().empty());
}

TEST_F(LongWorkTest, DetachedWorkIsStartedAndLeft) {
  const auto plan = Start({"plan", "table", "--detach"});
  EXPECT_EQ(plan->Wait(), 0);
  EXPECT_THAT(plan->Output(), HasSubstr(absl::StrCat("operations watch ", kPlanning)));
  const auto release = StartJson("fab release plans/p1 --detach");
  EXPECT_EQ(release->Wait(), 0);
  EXPECT_EQ(Document()["name"], kCutting);
  EXPECT_TRUE(house_.cancelled().empty());
  const auto with_files = Start({"plan", "table", "--detach", "--out", "x"});
  EXPECT_EQ(with_files->Wait(), 2);
}

TEST_F(LongWorkTest, WatchingEndsWithoutCancelling) {
  house_.Add(kPlanning);
  const auto watch = Start({"operations", "watch", "fabplanner/p1"});
  ASSERT_TRUE(watch->AwaitOutput("laying out boards")) << watch->Output();
  EXPECT_EQ(watch->End(SIGINT), 130);
  EXPECT_THAT(watch->Output(), HasSubstr(absl::StrCat(kPlanning, " goes on")));
  EXPECT_TRUE(house_.cancelled().empty());
  const auto to_the_end = StartJson(absl::StrCat("operations watch ", kPlanning));
  v1::Plan made;
  made.set_name("plans/p1");
  house_.Finish(kPlanning, made);
  EXPECT_EQ(to_the_end->Wait(), 0);
  EXPECT_EQ(Document()["result"]["name"], "plans/p1");
  const auto unknown = Start({"operations", "watch", "operations/fabplanner/none"});
  EXPECT_EQ(unknown->Wait(), 1);
}

TEST_F(LongWorkTest, ListsWhatRunsFromAllPages) {
  house_.Add("operations/fabplanner/a");
  house_.Add("operations/pareto/b");
  const auto list = Start({"operations", "list", "--active", "--subject", "templates/table"});
  EXPECT_EQ(list->Wait(), 0);
  EXPECT_THAT(list->Output(),
              AllOf(HasSubstr("operations/fabplanner/a"), HasSubstr("operations/pareto/b"),
                    HasSubstr("running"), HasSubstr("CreatePlan"), HasSubstr("templates/table"),
                    HasSubstr("3/10  laying out boards")));
  ASSERT_EQ(house_.listed().size(), 2u);
  const v1::ListOperationsRequest asked = house_.listed().front();
  EXPECT_EQ(asked.states_size(), 2);
  EXPECT_EQ(asked.subject(), "templates/table");
  EXPECT_TRUE(asked.omit_results());
  const auto first = StartJson("operations list --limit 1");
  EXPECT_EQ(first->Wait(), 0);
  EXPECT_EQ(Document().size(), 1u);
}

TEST_F(LongWorkTest, ShowsOne) {
  house_.Add(kPlanning);
  const auto show = Start({"operations", "show", kPlanning});
  EXPECT_EQ(show->Wait(), 0);
  EXPECT_THAT(show->Output(), AllOf(HasSubstr("running"), HasSubstr("FabPlannerService/CreatePlan"),
                                    HasSubstr("users/ada")));
}

TEST_F(LongWorkTest, CancelsSeveralAndSaysWhatIsKept) {
  house_.Add("operations/fabplanner/a");
  house_.Add("operations/pareto/b");
  const auto cancel = Start({"operations", "cancel", "fabplanner/a", "operations/pareto/b"});
  EXPECT_EQ(cancel->Wait(), 0);
  EXPECT_EQ(house_.cancelled(),
            (std::vector<std::string>{"operations/fabplanner/a", "operations/pareto/b"}));
  EXPECT_THAT(cancel->Output(), HasSubstr("operations/pareto/b: cancelled, fronts/best is kept"));
}

}  // namespace
}  // namespace mortise::cli
