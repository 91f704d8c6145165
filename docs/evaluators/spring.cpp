#include <google/protobuf/text_format.h>
#include <grpcpp/grpcpp.h>
#include <unistd.h>
#include <cmath>
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/simulator.grpc.pb.h"
using namespace mortise::v1;

int main(int, char** argv) {
  const auto channel = grpc::CreateChannel(argv[1], grpc::InsecureChannelCredentials());
  CreateEvaluatorRequest create;
  google::protobuf::TextFormat::ParseFromString(R"(evaluator { name: 'evaluators/stiffness' space {
    parameters { name: 'wire' unit: 'm' minimum: 1e-3 maximum: 5e-3 default_value: 3e-3 }
    parameters { name: 'diameter' unit: 'm' minimum: 0.02 maximum: 0.06 default_value: 0.03 }
    metrics { name: 'stiffness' unit: 'N/m' } } })", &create);
  create.set_request_id("spring-" + std::to_string(getpid()));
  grpc::ClientContext creating;
  EvaluatorService::NewStub(channel)->CreateEvaluator(&creating, create, create.mutable_evaluator());
  const auto tasks = SimulatorService::NewStub(channel);
  LeaseTasksRequest lease;
  google::protobuf::TextFormat::ParseFromString(
      "evaluator: 'evaluators/stiffness' limit: 4 lease_seconds: 10 wait_seconds: 20", &lease);
  lease.set_worker(create.request_id());
  while (true) {
    LeaseTasksResponse leased;
    if (grpc::ClientContext context; !tasks->LeaseTasks(&context, lease, &leased).ok()) sleep(1);
    for (const Task& task : leased.tasks()) {
      const double wire = task.point().parameters(0), diameter = task.point().parameters(1);
      ReportTaskRequest report;
      report.mutable_task()->set_name(task.name());
      report.mutable_task()->set_attempt(task.attempt());
      Metric& stiffness = *report.mutable_result()->add_metrics();
      stiffness.set_name(task.metrics(0));
      stiffness.set_value(1.25e9 * std::pow(wire, 4) / std::pow(diameter, 3));
      grpc::ClientContext context;
      ReportTaskResponse answer;  // a report that is refused will not be better the next time
      tasks->ReportTask(&context, report, &answer);
    }
  }
}
