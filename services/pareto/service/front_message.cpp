#include "services/pareto/service/front_message.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "mortise/v1/pareto.pb.h"
#include "services/pareto/front/front.h"
#include "services/pareto/front/front_remarks.h"

namespace mortise::pareto {
namespace {

std::vector<std::string> Names(const std::vector<Objective>& objectives) {
  std::vector<std::string> names;
  for (const Objective& objective : objectives) names.push_back(objective.metric);
  return names;
}

bool AnyChoice(const DiscoveryProblem& problem) {
  return std::ranges::any_of(problem.choices, [](const auto& names) { return !names.empty(); });
}

// Empty for a number.
std::string ChoiceOf(const DiscoveryProblem& problem, const Eigen::VectorXd& x, Eigen::Index i) {
  const std::vector<std::string>& names = problem.choices[static_cast<std::size_t>(i)];
  return names.empty() ? "" : names[static_cast<std::size_t>(std::lround(x[i]))];
}

void AddCombinations(const DiscoveryProblem& problem, const AskTell::Summary& summary,
                     v1::Front& message) {
  if (AnyChoice(problem)) {
    for (const std::vector<std::string>& names : problem.choices) {
      message.add_parameter_choices()->mutable_names()->Add(names.begin(), names.end());
    }
  }
  v1::FrontCombinations& combinations = *message.mutable_combinations();
  combinations.set_possible(summary.combinations);
  combinations.set_tried(summary.combinations_tried);
  combinations.set_given_up(summary.combinations_pruned);
}

// What the numbers of the points are.
void AddColumns(const DiscoveryProblem& problem, v1::Front& message) {
  for (const std::string& name : problem.parameter_names) message.add_parameter_names(name);
  for (const Objective& objective : problem.objectives) {
    message.add_metric_names(objective.metric);
    message.add_metric_units(objective.unit);
  }
  for (const Constraint& constraint : problem.constraints) {
    message.add_constraint_units(constraint.unit);
  }
  message.mutable_parameter_minima()->Add(problem.space.lower.begin(), problem.space.lower.end());
  message.mutable_parameter_maxima()->Add(problem.space.upper.begin(), problem.space.upper.end());
}

// How far tolerances make the metrics deviate, and from which means.
void AddDeviations(const DiscoveryProblem& problem, const FrontPoint& point, v1::FrontPoint& to) {
  if (problem.robustness.tolerances.empty()) return;
  const Eigen::VectorXd means = problem.Signs().cwiseProduct(
      point.metrics - problem.robustness.deviations * point.deviations);
  to.mutable_metric_deviations()->Add(point.deviations.begin(), point.deviations.end());
  to.mutable_metric_means()->Add(means.begin(), means.end());
}

void AddPoint(const DiscoveryProblem& problem, const FrontPoint& point, v1::Front& message) {
  v1::FrontPoint& to = *message.add_points();
  const Eigen::VectorXd metrics = point.metrics.cwiseProduct(problem.Signs());
  to.mutable_parameters()->Add(point.x.begin(), point.x.end());
  to.mutable_metrics()->Add(metrics.begin(), metrics.end());
  for (Eigen::Index i = 0; AnyChoice(problem) && i < point.x.size(); ++i) {
    to.add_choices(ChoiceOf(problem, point.x, i));
  }
  to.set_cell(static_cast<int>(point.cell));
  to.set_piece(point.piece);
  to.mutable_embedding()->Add(point.embedding.begin(), point.embedding.end());
  to.set_approximation_error(point.approximation_error);
  to.set_jump(point.jump);
  AddDeviations(problem, point, to);
  Eigen::Index row = 0;
  for (const Constraint& constraint : problem.constraints) {
    to.add_constraint_metrics(constraint.ValueOf(point.constraints[row]));
    row += constraint.rows();
  }
}

void AddPiece(const FrontPiece& piece, v1::Front& message) {
  v1::FrontPiece& to = *message.add_affine_pieces();
  to.mutable_origin()->Add(piece.origin.begin(), piece.origin.end());
  for (const auto& direction : piece.directions.colwise()) {
    to.add_directions()->mutable_values()->Add(direction.begin(), direction.end());
  }
  to.set_points(piece.points);
}

// How many evaluations it took, and what became of them.
void AddEvaluations(const DiscoveryProblem& problem, const AskTell::Summary& summary,
                    v1::Front& message) {
  message.set_evaluations(summary.evaluations);
  message.set_subject_evaluations(summary.evaluations * problem.robustness.EvaluationsPerDesign());
  message.set_failed_evaluations(summary.failed);
  message.set_violating_evaluations(summary.violating);
  for (const evaluation::FailureCount& failure : summary.failures) {
    v1::EvaluationFailure& to = *message.add_failures();
    to.set_reason(failure.reason);
    to.set_count(failure.count);
    to.set_message(failure.message);
    to.mutable_parameters()->Add(failure.x.begin(), failure.x.end());
  }
}

void AddSurrogateQuality(const AskTell::Summary& summary, v1::Front& message) {
  if (summary.surrogate.proposals <= 0) return;
  v1::SurrogateQuality& to = *message.mutable_surrogate_quality();
  to.set_proposals(summary.surrogate.proposals);
  to.set_predictions(summary.surrogate.predictions);
  to.set_within_two_deviations(summary.surrogate.within_two_deviations);
  to.set_median_error(summary.surrogate.median_error);
}

void AddRemarks(const DiscoveryProblem& problem, const AskTell& discovery, const Front& front,
                v1::Front& message) {
  for (std::string& remark : FrontRemarks(discovery.archive(), front, Names(problem.objectives))) {
    message.add_remarks(std::move(remark));
  }
  for (std::string& remark : BandRemarks(problem.constraints)) {
    message.add_remarks(std::move(remark));
  }
  if (problem.robustness.first_order) {
    message.add_remarks(
        "deviations are to first order, from gradients, and means those of designs");
  }
}

}  // namespace

v1::Front MakeFront(const DiscoveryProblem& problem, const AskTell& discovery) {
  v1::Front message;
  AddColumns(problem, message);
  const Front front = discovery.front();
  for (const FrontPoint& point : front.points) AddPoint(problem, point, message);
  for (const FrontPiece& piece : front.pieces) AddPiece(piece, message);
  const AskTell::Summary summary = discovery.summary();
  AddCombinations(problem, summary, message);
  AddEvaluations(problem, summary, message);
  AddSurrogateQuality(summary, message);
  message.set_pieces(static_cast<int>(front.pieces.size()));
  message.set_hypervolume(summary.hypervolume);
  message.set_cells_covered(static_cast<int>(summary.cells_covered));
  message.set_stop_reason(StopReasonName(summary.stop_reason));
  message.set_point_count(static_cast<int>(front.points.size()));
  AddRemarks(problem, discovery, front, message);
  return message;
}

}  // namespace mortise::pareto
