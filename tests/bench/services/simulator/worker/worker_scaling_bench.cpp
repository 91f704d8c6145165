// How busy one service keeps many workers: tasks that take 50 ms wherever they run, so that what is
// left is the queue's.
#include <benchmark/benchmark.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
#include "tests/integration/services/call_service.h"
#include "tests/integration/services/service_under_test.h"
#include "tests/support/private_postgresql.h"

namespace mortise::simulator {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int kWorkers = 64;
constexpr int kTasksAhead = 4;  // leased at a time
constexpr Seconds kTaskTime{0.05};
constexpr int kBatches = 8;
constexpr int kBatch = 960;  // points; six seconds for all

// From when to when a worker was at a task.
struct Span {
  Clock::time_point begin;
  Clock::time_point end;
};

// Does tasks until there are none.
class Worker {
 public:
  Worker(const std::string& address, int number)
      : name_("worker-" + std::to_string(number)),
        stub_(v1::SimulatorService::NewStub(ChannelTo(address))) {}

  void Run() {
    v1::LeaseTasksRequest request;
    request.set_evaluator("evaluators/synthetic");
    request.set_worker(name_);
    request.set_limit(kTasksAhead);
    request.set_lease_seconds(30);
    request.set_wait_seconds(3);
    while (true) {
      idle_since_ = Clock::now();
      grpc::ClientContext context;
      v1::LeaseTasksResponse leased;
      if (!stub_->LeaseTasks(&context, request, &leased).ok() || leased.tasks_size() == 0) break;
      for (const v1::Task& task : leased.tasks()) WorkOn(task);
    }
  }

  const std::vector<Span>& spans() const { return spans_; }
  Clock::time_point idle_since() const { return idle_since_; }

 private:
  // A connection of its own, as a process has.
  static std::shared_ptr<grpc::Channel> ChannelTo(const std::string& address) {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
    return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
  }

  void WorkOn(const v1::Task& task) {
    const Clock::time_point begin = Clock::now();
    std::this_thread::sleep_until(begin + kTaskTime);
    spans_.push_back({begin, Clock::now()});
    v1::ReportTaskRequest report;
    report.mutable_task()->set_name(task.name());
    report.mutable_task()->set_attempt(task.attempt());
    for (const std::string& name : task.metrics()) {
      auto& metric = *report.mutable_result()->add_metrics();
      metric.set_name(name);
      metric.set_value(task.point().parameters(0));
    }
    grpc::ClientContext context;
    v1::ReportTaskResponse response;
    if (!stub_->ReportTask(&context, report, &response).ok()) std::abort();
  }

  const std::string name_;
  const std::unique_ptr<v1::SimulatorService::Stub> stub_;
  std::vector<Span> spans_;
  Clock::time_point idle_since_;
};

void Register(testing::ServiceUnderTest& service) {
  v1::CreateEvaluatorRequest create;
  google::protobuf::TextFormat::ParseFromString(
      "request_id: 'create' evaluator { name: 'evaluators/synthetic' title: 'Synthetic' version: "
      "'1'"
      " space { parameters { name: 'x' unit: 'm' minimum: 0 maximum: 1e6 }"
      " metrics { name: 'same' unit: 'm' } } }",
      &create);
  const auto evaluators = v1::EvaluatorService::NewStub(service.channel());
  const auto created =
      testing::Call(*evaluators, &v1::EvaluatorService::Stub::CreateEvaluator, create);
  if (!created.ok()) std::abort();
}

// Asks for points from `first` on and takes all results.
void Evaluate(testing::ServiceUnderTest& service, int first, int points) {
  v1::EvaluateBatchRequest request;
  request.set_subject("evaluators/synthetic");
  request.add_metrics("same");
  for (int i = 0; i < points; ++i) request.add_points()->add_parameters(first + i);
  const auto evaluators = v1::EvaluatorService::NewStub(service.channel());
  grpc::ClientContext context;
  const auto reader = evaluators->EvaluateBatch(&context, request);
  v1::EvaluationResult result;
  int results = 0;
  while (reader->Read(&result)) ++results;
  const grpc::Status status = reader->Finish();
  if (!status.ok() || results != points) {
    std::cerr << results << " results, " << status.error_message() << "\n";
    std::abort();
  }
}

// The share of the workers' time that they were at tasks, from when the last of them had its first
// to when the first found no more.
double BusyShare(const std::vector<std::unique_ptr<Worker>>& workers) {
  Clock::time_point begin = Clock::time_point::min(), end = Clock::time_point::max();
  for (const auto& worker : workers) {
    begin = std::max(begin, worker->spans().front().begin);
    end = std::min(end, worker->idle_since());
  }
  Seconds busy{0};
  for (const auto& worker : workers) {
    for (const Span& span : worker->spans()) {
      busy += std::max(Seconds(0), Seconds(std::min(span.end, end) - std::max(span.begin, begin)));
    }
  }
  return busy / (static_cast<double>(workers.size()) * Seconds(end - begin));
}

void Scale(benchmark::State& state, const std::string& store) {
  for (auto _ : state) {
    testing::ServiceUnderTest service("mortise-simulator", {"--peer=catalog=127.0.0.1:1"}, store);
    Register(service);
    std::vector<std::unique_ptr<Worker>> workers;
    for (int i = 0; i < kWorkers; ++i) {
      workers.push_back(std::make_unique<Worker>(service.address(), i));
    }
    std::vector<std::thread> clients;
    for (int i = 0; i < kBatches; ++i) {
      clients.emplace_back([&service, i] { Evaluate(service, i * kBatch, kBatch); });
    }
    std::vector<std::thread> threads;
    for (auto& worker : workers) threads.emplace_back([&worker] { worker->Run(); });
    for (std::thread& thread : threads) thread.join();
    for (std::thread& client : clients) client.join();
    state.counters["busy"] = BusyShare(workers);
    state.counters["workers"] = kWorkers;
  }
}

void BM_SixtyFourWorkersOnSqlite(benchmark::State& state) { Scale(state, ""); }
BENCHMARK(BM_SixtyFourWorkersOnSqlite)->Iterations(1)->UseRealTime()->Unit(benchmark::kSecond);

void BM_SixtyFourWorkersOnPostgresql(benchmark::State& state) {
  const auto server = testing::PrivatePostgresql::Start();
  if (!server.ok()) return state.SkipWithError(std::string(server.status().message()).c_str());
  Scale(state, (*server)->url());
}
BENCHMARK(BM_SixtyFourWorkersOnPostgresql)->Iterations(1)->UseRealTime()->Unit(benchmark::kSecond);

}  // namespace
}  // namespace mortise::simulator

BENCHMARK_MAIN();
