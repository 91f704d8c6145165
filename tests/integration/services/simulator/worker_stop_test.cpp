// Work that nobody wants any more leaves its worker, also where it cannot be stopped, so that what
// comes next does not wait behind it.
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>

#include "mortise/v1/evaluator.grpc.pb.h"
#include "tests/integration/services/simulator/simulator_process.h"

namespace mortise::simulator {
namespace {

// A catalog that answers nobody, however long: whoever asks it is in the middle of a call that does
// not stop by itself, as that of a library.
class SilentCatalog final : public v1::CatalogService::CallbackService {
 public:
  SilentCatalog() {
    grpc::ServerBuilder builder;
    int port = 0;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
    address_ = "127.0.0.1:" + std::to_string(port);
  }
  ~SilentCatalog() override { server_->Shutdown(std::chrono::system_clock::now()); }

  grpc::ServerUnaryReactor* GetTemplateBundle(grpc::CallbackServerContext* context,
                                              const v1::GetTemplateBundleRequest*,
                                              v1::TemplateBundle*) override {
    const std::lock_guard lock(mutex_);
    ++asked_;
    changed_.notify_all();
    return new Silence(this, context->deadline());
  }

  const std::string& address() const { return address_; }

  void AwaitCallers(int count) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return asked_ >= count; });
  }

  // Waits until a caller has left; whether that was before its own patience was over.
  bool AwaitEarlyLeave() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return left_; });
    return left_early_;
  }

 private:
  // Of one call: ends when the caller has gone.
  class Silence final : public grpc::ServerUnaryReactor {
   public:
    Silence(SilentCatalog* catalog, std::chrono::system_clock::time_point patience_ends)
        : catalog_(catalog), patience_ends_(patience_ends) {}
    void OnCancel() override {
      catalog_->NoteLeave(std::chrono::system_clock::now() < patience_ends_);
      Finish({grpc::StatusCode::CANCELLED, "gone"});
    }
    void OnDone() override { delete this; }

   private:
    SilentCatalog* const catalog_;
    const std::chrono::system_clock::time_point patience_ends_;
  };

  void NoteLeave(bool early) {
    const std::lock_guard lock(mutex_);
    if (!left_) left_early_ = early;
    left_ = true;
    changed_.notify_all();
  }

  std::unique_ptr<grpc::Server> server_;
  std::string address_;
  std::mutex mutex_;
  std::condition_variable changed_;
  int asked_ = 0;            // guarded by mutex_
  bool left_ = false;        // guarded by mutex_
  bool left_early_ = false;  // guarded by mutex_
};

class WorkerStopTest : public SimulatorProcessTest {
 protected:
  std::unique_ptr<testing::ChildProcess> StartStuckWorker() const {
    return std::make_unique<testing::ChildProcess>(std::vector<std::string>{
        testing::BuiltProgram("mortise-simulator"), "--worker", "--worker-name=stuck",
        "--insecure-development", "--log-level=info", "--lease-seconds=60",
        "--peer=simulator=" + service_.address(), "--peer=catalog=" + silent_.address()});
  }

  int Count(v1::TaskState state) const {
    v1::ListTasksRequest request;
    request.set_state(state);
    v1::ListTasksResponse response;
    const auto context = Context();
    EXPECT_TRUE(Simulator()->ListTasks(context.get(), request, &response).ok());
    return response.tasks_size();
  }

  SilentCatalog silent_;
};

TEST_F(WorkerStopTest, ACancelledAnalysisLeavesItsWorker) {
  const auto worker = StartStuckWorker();
  v1::AnalyzeDesignRequest request;
  request.set_request_id("r-1");
  request.set_template_("templates/table");
  v1::Operation operation;
  ASSERT_TRUE(Simulator()->AnalyzeDesign(Context().get(), request, &operation).ok());
  silent_.AwaitCallers(1);
  v1::CancelOperationRequest cancel;
  cancel.set_request_id("c-1");
  cancel.set_name(operation.name());
  const auto operations = v1::OperationService::NewStub(service_.channel());
  v1::Operation ignored;
  ASSERT_TRUE(operations->CancelOperation(Context().get(), cancel, &ignored).ok());
  EXPECT_EQ(Wait(operation.name()).state(), v1::Operation::CANCELLED);
  EXPECT_TRUE(silent_.AwaitEarlyLeave());
  // The process is the same one, at work again.
  EXPECT_TRUE(worker->AwaitOutput("breaking off")) << worker->Output();
  request.set_request_id("r-2");
  ASSERT_TRUE(Simulator()->AnalyzeDesign(Context().get(), request, &operation).ok());
  silent_.AwaitCallers(2);
}

// A discovery, or a command, that is cancelled closes its stream of evaluations.
TEST_F(WorkerStopTest, WhatAStreamAskedForLeavesItsWorkerWhenNobodyAsksAgain) {
  const auto worker = StartStuckWorker();
  v1::EvaluateBatchRequest request;
  request.set_subject("templates/table");
  request.add_metrics("mass");
  for (int i = 0; i < 3; ++i) {
    v1::DesignPoint& point = *request.add_points();
    for (const v1::Parameter& parameter : catalog_.table().parameters()) {
      const double share = 0.4 + 0.1 * i;
      point.add_parameters(parameter.minimum() +
                           share * (parameter.maximum() - parameter.minimum()));
    }
  }
  const auto context = Context();
  const auto evaluators = v1::EvaluatorService::NewStub(service_.channel());
  const auto reader = evaluators->EvaluateBatch(context.get(), request);
  silent_.AwaitCallers(1);
  context->TryCancel();
  EXPECT_EQ(reader->Finish().error_code(), grpc::StatusCode::CANCELLED);
  EXPECT_TRUE(silent_.AwaitEarlyLeave());
  EXPECT_EQ(Count(v1::QUEUED), 0);
  EXPECT_EQ(Count(v1::LEASED), 0);
}

}  // namespace
}  // namespace mortise::simulator
