#include "services/simulator/worker/analysis_codec.h"

#include <cmath>

#include "common/design/metric_registry.h"
#include "common/messages/vector_codec.h"

namespace mortise::simulator {
namespace {

// How much stronger a part is than its stress, which only load cases tell.
constexpr char kSafetyFactor[] = "safety_factor";

v1::SolverReport ReportOf(const ElasticitySummary& summary) {
  const bool is_direct = summary.solver.kind == SolverKind::kDirect;
  v1::SolverReport report;
  report.set_kind(is_direct ? v1::DIRECT : v1::ITERATIVE);
  if (!is_direct) report.set_iterations(summary.solver.iterations);
  report.set_residual(summary.residual);
  report.set_preparation_seconds(summary.assembly_seconds + summary.preparation_seconds);
  report.set_solution_seconds(summary.solution_seconds);
  return report;
}

}  // namespace

v1::Metric ToProto(const Metric& metric) {
  v1::Metric message;
  message.set_name(metric.name);
  message.set_unit(metric.unit);
  message.set_value(metric.value);
  return message;
}

SolverKind SolverKindOf(v1::SolverKind kind) {
  switch (kind) {
    case v1::DIRECT:
      return SolverKind::kDirect;
    case v1::ITERATIVE:
      return SolverKind::kIterative;
    default:
      return SolverKind::kAutomatic;
  }
}

void Fill(const CaseOutcome& outcome, const std::vector<std::string>& parts,
          v1::CaseResult& message) {
  message.set_name(outcome.name);
  const ElasticitySummary& summary = outcome.summary;
  const auto add = [&message](BuiltInMetric metric, double value) {
    *message.add_metrics() = ToProto(MetricOf(metric, value));
  };
  add(BuiltInMetric::kMaxDisplacement, summary.maximum_displacement);
  add(BuiltInMetric::kMaxVonMises, outcome.maximum_von_mises);
  add(BuiltInMetric::kMaxPrincipal, outcome.maximum_principal);
  add(BuiltInMetric::kMeanVonMises, outcome.mean_von_mises);
  add(BuiltInMetric::kRmsVonMises, outcome.rms_von_mises);
  add(BuiltInMetric::kVonMisesP99, outcome.von_mises_p99);
  add(BuiltInMetric::kVonMisesIntegral, outcome.von_mises_integral);
  add(BuiltInMetric::kStrainEnergy, summary.strain_energy);
  add(BuiltInMetric::kCompliance, summary.compliance);
  add(BuiltInMetric::kRelativeError, outcome.relative_error);
  const double safety = outcome.part_safety_factor.minCoeff();
  if (std::isfinite(safety)) *message.add_metrics() = ToProto(Metric{kSafetyFactor, "1", safety});
  *message.mutable_total_load() = VectorToProto(summary.total_load);
  *message.mutable_total_reaction() = VectorToProto(summary.total_reaction);
  for (const Eigen::Vector3d& reaction : outcome.reactions) {
    *message.add_reactions() = VectorToProto(reaction);
  }
  *message.mutable_max_displacement_at() = VectorToProto(outcome.maximum_displacement_at);
  *message.mutable_max_von_mises_at() = VectorToProto(outcome.maximum_von_mises_at);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    v1::CaseResult::PartResult& part = *message.add_parts();
    part.set_name(parts[p]);
    part.set_max_von_mises(outcome.part_maximum_von_mises[p]);
    if (std::isfinite(outcome.part_safety_factor[p])) {
      part.set_safety_factor(outcome.part_safety_factor[p]);
    }
  }
  if (summary.solution_seconds > 0) *message.mutable_solver() = ReportOf(summary);
}

void Fill(const HeatOutcome& outcome, v1::HeatResult& message) {
  message.set_minimum(outcome.minimum);
  message.set_maximum(outcome.maximum);
  message.set_supplied(outcome.supplied);
  message.set_through_temperatures(outcome.through_temperatures);
  for (const double power : outcome.convected) message.add_convected(power);
}

void Fill(const AirflowSolution& solution, const Eigen::Vector3d& wind,
          v1::AirflowResult& message) {
  *message.mutable_wind() = VectorToProto(wind);
  *message.mutable_force() = VectorToProto(solution.force);
  *message.mutable_friction() = VectorToProto(solution.friction);
  message.set_force_swing(solution.force_swing);
  message.set_minimum_pressure(solution.minimum_pressure);
  message.set_maximum_pressure(solution.maximum_pressure);
  message.set_cells(solution.cells);
  message.set_iterations(solution.iterations);
}

}  // namespace mortise::simulator
