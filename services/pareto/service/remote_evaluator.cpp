// From what an evaluator answers to what discovery works on.
#include "services/pareto/service/remote_evaluator.h"

#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "mortise/v1/evaluator.pb.h"
#include "mortise/v1/pareto.pb.h"

namespace mortise::pareto {
namespace {

// Each once, those of the objectives first.
std::vector<std::string> MetricsOf(const DiscoveryProblem& problem) {
  std::vector<std::string> metrics;
  std::set<std::string> seen;
  const auto add = [&](const std::string& metric) {
    if (seen.insert(metric).second) metrics.push_back(metric);
  };
  for (const Objective& objective : problem.objectives) add(objective.metric);
  for (const Constraint& constraint : problem.constraints) add(constraint.metric);
  return metrics;
}

v1::EvaluateBatchRequest QuestionOf(const v1::DiscoverySpecification& specification,
                                    const DiscoveryProblem& problem) {
  v1::EvaluateBatchRequest question;
  question.set_subject(specification.subject());
  question.set_revision(specification.revision());
  for (const std::string& metric : MetricsOf(problem)) question.add_metrics(metric);
  question.set_gradients(problem.AnyGradient());
  if (specification.has_mesh()) *question.mutable_mesh() = specification.mesh();
  if (specification.has_airflow()) *question.mutable_airflow() = specification.airflow();
  *question.mutable_metric_definitions() = specification.metric_definitions();
  return question;
}

// Rows that are never set stay NaN.
void SetRow(const Eigen::RowVectorXd& gradient, Eigen::Index row, Eigen::Index rows,
            Eigen::MatrixXd& jacobian) {
  if (jacobian.size() == 0) {
    jacobian =
        Eigen::MatrixXd::Constant(rows, gradient.size(), std::numeric_limits<double>::quiet_NaN());
  }
  jacobian.row(row) = gradient;
}

// Reads the answers of one problem.
class AnswerReader {
 public:
  explicit AnswerReader(const DiscoveryProblem& problem)
      : problem_(problem), signs_(problem.Signs()) {
    for (const std::string& metric : MetricsOf(problem)) {
      rows_.emplace(metric, static_cast<Eigen::Index>(rows_.size()));
    }
  }

  Evaluation Read(const Eigen::VectorXd& design, const evaluation::Answer& answer) const {
    Evaluation evaluation;
    evaluation.x = design;
    if (!answer.status.ok()) {
      evaluation.message = std::string(answer.status.message());
      evaluation.reason = DetailOf(answer.status).reason;
      evaluation.code = answer.status.code();
      return evaluation;
    }
    evaluation.status = EvaluationStatus::kEvaluated;
    ReadObjectives(answer, evaluation);
    ReadConstraints(answer, evaluation);
    evaluation.message = WhatIsMissing(answer);
    return evaluation;
  }

 private:
  void ReadObjectives(const evaluation::Answer& answer, Evaluation& evaluation) const {
    const auto d = static_cast<Eigen::Index>(problem_.objectives.size());
    evaluation.metrics.resize(d);
    for (Eigen::Index i = 0; i < d; ++i) {
      const Eigen::Index row = rows_.at(problem_.objectives[static_cast<std::size_t>(i)].metric);
      evaluation.metrics[i] = signs_[i] * answer.values[row];
      if (!OffersGradient(answer, row)) continue;
      SetRow(signs_[i] * answer.gradients.row(row), i, d, evaluation.jacobian);
    }
  }

  void ReadConstraints(const evaluation::Answer& answer, Evaluation& evaluation) const {
    std::vector<double> values;
    for (const Constraint& constraint : problem_.constraints) {
      const auto first = static_cast<Eigen::Index>(values.size());
      const Eigen::Index row = rows_.at(constraint.metric);
      constraint.AppendTo(answer.values[row], values);
      if (!OffersGradient(answer, row)) continue;
      const Eigen::RowVectorXd gradient = answer.gradients.row(row);
      const Eigen::Index m = problem_.options.constraints;
      if (constraint.maximum) SetRow(gradient, first, m, evaluation.constraint_jacobian);
      if (constraint.minimum) {
        SetRow(-gradient, first + constraint.rows() - 1, m, evaluation.constraint_jacobian);
      }
    }
    evaluation.constraints =
        Eigen::VectorXd::Map(values.data(), static_cast<Eigen::Index>(values.size()));
  }

  static bool OffersGradient(const evaluation::Answer& answer, Eigen::Index row) {
    return answer.gradients.size() > 0 && !answer.gradients.row(row).array().isNaN().all();
  }

  // Which of the metrics are not there as finite numbers; empty if all are.
  std::string WhatIsMissing(const evaluation::Answer& answer) const {
    std::vector<std::string> missing;
    for (const auto& [metric, row] : rows_) {
      if (!std::isfinite(answer.values[row])) missing.push_back(metric);
    }
    if (missing.empty()) return "";
    return absl::StrCat("the evaluator left out a metric, or gave one that is not finite: ",
                        absl::StrJoin(missing, ", "));
  }

  const DiscoveryProblem& problem_;
  Eigen::VectorXd signs_;
  std::map<std::string, Eigen::Index> rows_;  // of each metric, among the answer's values
};

}  // namespace

RemoteEvaluator::RemoteEvaluator(std::shared_ptr<grpc::Channel> channel,
                                 const v1::DiscoverySpecification& specification,
                                 const DiscoveryProblem& problem,
                                 std::function<rpc::Origin(absl::Duration)> make_origin,
                                 const evaluation::EvaluatorClient::Options& options)
    : problem_(problem),
      client_(std::move(channel), QuestionOf(specification, problem), std::move(make_origin),
              options) {}

absl::StatusOr<std::vector<Evaluation>> RemoteEvaluator::Evaluate(
    const std::vector<Eigen::VectorXd>& designs) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<evaluation::Answer> answers,
                           client_.Evaluate(designs));
  const AnswerReader reader(problem_);
  std::vector<Evaluation> evaluations;
  evaluations.reserve(designs.size());
  for (std::size_t i = 0; i < designs.size(); ++i) {
    evaluations.push_back(reader.Read(designs[i], answers[i]));
  }
  return evaluations;
}

v1::DescribeDesignSpaceRequest DescriptionRequest(const v1::DiscoverySpecification& specification) {
  v1::DescribeDesignSpaceRequest request;
  request.set_subject(specification.subject());
  request.set_revision(specification.revision());
  *request.mutable_metric_definitions() = specification.metric_definitions();
  return request;
}

}  // namespace mortise::pareto
