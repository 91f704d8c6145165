#include "services/simulator/service/evaluation_methods.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/files/evaluation_settings.h"
#include "common/rpc/channel.h"
#include "mortise/v1/simulator.pb.h"
#include "services/simulator/service/design_fields_checks.h"
#include "services/simulator/service/difference_gradients.h"
#include "services/simulator/service/evaluation_subject.h"

namespace mortise::simulator::methods {
namespace {

// What all points of a batch have in common.
v1::Task TaskOf(const v1::EvaluateBatchRequest& asked, const EvaluationSubject& subject,
                const std::string& trace_id) {
  v1::Task task;
  task.set_evaluator(subject.queue);
  task.set_subject(subject.space.subject());
  task.set_revision(subject.space.revision());
  task.set_digest(subject.digest);
  *task.mutable_metrics() = asked.metrics();
  task.set_gradients(asked.gradients());
  *task.mutable_mesh() = asked.mesh();
  *task.mutable_metric_definitions() = asked.metric_definitions();
  if (asked.has_airflow()) *task.mutable_airflow() = asked.airflow();
  if (asked.has_design_fields()) *task.mutable_design_fields() = asked.design_fields();
  task.set_trace_id(trace_id);
  return task;
}

// Everything of a request but its points, which fail one by one.
absl::StatusOr<EvaluationSubject> SubjectOf(const Evaluations& evaluations, const rpc::Call& call,
                                            const v1::EvaluateBatchRequest& asked) {
  if (asked.points_size() < 1 || asked.points_size() > kMaximumPoints) {
    return InvalidField("points", absl::StrCat("must be 1 to ", kMaximumPoints));
  }
  MORTISE_RETURN_IF_ERROR(parametric::CheckMeshSettings(asked.mesh()));
  MORTISE_RETURN_IF_ERROR(parametric::ReadAirflow(asked.airflow()).status());
  MORTISE_ASSIGN_OR_RETURN(EvaluationSubject subject,
                           FindSubject(*evaluations.core, asked.subject(), asked.revision(),
                                       asked.metric_definitions(), rpc::ForwardedFrom(call)));
  MORTISE_RETURN_IF_ERROR(
      CheckMetrics(subject.space, {asked.metrics().begin(), asked.metrics().end()}));
  if (asked.has_design_fields()) {
    MORTISE_RETURN_IF_ERROR(CheckWanted(subject.space, asked.design_fields()));
  }
  MORTISE_RETURN_IF_ERROR(CheckDifferences(asked, subject.space.parameters_size()));
  return subject;
}

}  // namespace

absl::StatusOr<v1::DesignSpace> DescribeDesignSpace(const Evaluations& evaluations,
                                                    const rpc::Call& call,
                                                    const v1::DescribeDesignSpaceRequest& asked) {
  MORTISE_ASSIGN_OR_RETURN(EvaluationSubject subject,
                           FindSubject(*evaluations.core, asked.subject(), asked.revision(),
                                       asked.metric_definitions(), rpc::ForwardedFrom(call)));
  return std::move(subject.space);
}

absl::Status EvaluateBatch(const Evaluations& evaluations, const rpc::Call& call,
                           const v1::EvaluateBatchRequest& asked,
                           const EvaluationBatch::Writer& writer) {
  MORTISE_ASSIGN_OR_RETURN(const EvaluationSubject subject, SubjectOf(evaluations, call, asked));
  const auto batch = std::make_shared<EvaluationBatch>(
      evaluations.core, evaluations.results, evaluations.queueing, writer, asked.points_size());
  writer->OnEnd([batch] { batch->Abandon(); });
  const auto space = std::make_shared<const v1::DesignSpace>(subject.space);
  v1::Task task = TaskOf(asked, subject, call.identity().trace_id);
  std::vector<EvaluationBatch::Evaluation> wanted;
  for (int i = 0; i < asked.points_size(); ++i) {
    const auto send = [batch, i](v1::EvaluationResult result) {
      result.set_index(i);
      batch->Send(result);
    };
    const absl::Status usable =
        CheckPoint(subject.space, asked.points(i), absl::StrCat("points[", i, "]"));
    if (!usable.ok()) {
      send(FailedResult(usable));
      continue;
    }
    *task.mutable_point() = asked.points(i);
    wanted.push_back(
        {task, asked.difference_step() == 0
                   ? EvaluationBatch::Receiver(send)
                   : WithDifferences(batch, space, task, asked.difference_step(), send)});
  }
  batch->Evaluate(std::move(wanted));
  return absl::OkStatus();
}

}  // namespace mortise::simulator::methods
