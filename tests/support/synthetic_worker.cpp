// A worker of the evaluator evaluators/synthetic: what it computes is trivial, how long it takes
// and how often it is killed is told by flags. For tests of faults and benches of scale.
#include <grpcpp/grpcpp.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <random>
#include <string>
#include <thread>

#include "mortise/v1/simulator.grpc.pb.h"

namespace {

using mortise::v1::LeaseTasksRequest;
using mortise::v1::LeaseTasksResponse;
using mortise::v1::ReportTaskRequest;
using mortise::v1::ReportTaskResponse;
using mortise::v1::SimulatorService;
using mortise::v1::Task;

struct Flags {
  std::string address;
  int limit = 4;
  double lease = 5;         // s
  double task_seconds = 0;  // of one task
  double death_rate = 0;    // chance of being killed at a task
  int seed = 1;
};

class Worker {
 public:
  explicit Worker(const Flags& flags)
      : flags_(flags),
        random_(flags.seed),
        stub_(SimulatorService::NewStub(
            grpc::CreateChannel(flags.address, grpc::InsecureChannelCredentials()))) {}

  [[noreturn]] void Run() {
    LeaseTasksRequest request;
    request.set_evaluator("evaluators/synthetic");
    request.set_worker("synthetic-" + std::to_string(getpid()));
    request.set_limit(flags_.limit);
    request.set_lease_seconds(flags_.lease);
    request.set_wait_seconds(10);
    while (true) {
      grpc::ClientContext context;
      context.set_wait_for_ready(true);
      LeaseTasksResponse leased;
      if (!stub_->LeaseTasks(&context, request, &leased).ok()) continue;
      for (const Task& task : leased.tasks()) WorkOn(task, leased);
    }
  }

 private:
  // kill -9. Tasks that have lost two workers are spared: a third would rightly put them aside.
  void MayDie(const LeaseTasksResponse& held) {
    if (std::uniform_real_distribution<>()(random_) >= flags_.death_rate / 3) return;
    const bool is_spared = std::any_of(held.tasks().begin(), held.tasks().end(),
                                       [](const Task& task) { return task.attempt() > 2; });
    if (!is_spared) raise(SIGKILL);
  }

  void WorkOn(const Task& task, const LeaseTasksResponse& held) {
    MayDie(held);
    std::this_thread::sleep_for(std::chrono::duration<double>(flags_.task_seconds));
    ReportTaskRequest report;
    report.mutable_task()->set_name(task.name());
    report.mutable_task()->set_attempt(task.attempt());
    for (const std::string& name : task.metrics()) {
      auto& metric = *report.mutable_result()->add_metrics();
      metric.set_name(name);
      // What was computed, or a mark that tells one computation from another.
      metric.set_value(name == "square" ? task.point().parameters(0) * task.point().parameters(0)
                                        : std::uniform_real_distribution<>()(mark_));
    }
    MayDie(held);
    // Until somebody has it: the service may be restarting.
    while (true) {
      grpc::ClientContext context;
      context.set_wait_for_ready(true);
      ReportTaskResponse response;
      const grpc::Status status = stub_->ReportTask(&context, report, &response);
      if (status.error_code() != grpc::StatusCode::UNAVAILABLE) break;
    }
    MayDie(held);
  }

  const Flags flags_;
  std::mt19937 random_;
  std::random_device mark_;
  const std::unique_ptr<SimulatorService::Stub> stub_;
};

}  // namespace

int main(int argc, char** argv) {
  Flags flags;
  CLI::App app("A worker of evaluators/synthetic");
  app.add_option("address", flags.address, "the simulator's or the gateway's")->required();
  app.add_option("--limit", flags.limit, "tasks leased at a time");
  app.add_option("--lease-seconds", flags.lease, "how long");
  app.add_option("--task-seconds", flags.task_seconds, "how long one takes");
  app.add_option("--death-rate", flags.death_rate, "chance of being killed at a task");
  app.add_option("--seed", flags.seed, "of the chance");
  CLI11_PARSE(app, argc, argv);
  Worker(flags).Run();
}
