#include "services/simulator/task_evaluation.h"

#include <algorithm>
#include <exception>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "services/simulator/analysis_report.h"
#include "services/simulator/design_analysis.h"
#include "services/simulator/mesh_task.h"
#include "services/simulator/stopping.h"
#include "services/simulator/template_model.h"

namespace mortise::simulator {
namespace {

// Geometry, mesh, solution, stresses, files; where they are wanted, frequencies.
int StagesOf(const v1::Task& task) { return task.modes() > 0 ? 6 : 5; }

void FillAnalysis(const DesignAnalysis& analysis, const parametric::EvaluatedDesign& design,
                  v1::Analysis& message) {
  const ElasticitySummary& summary = analysis.solution->summary;
  for (const parametric::NamedValue& value : design.parameters) {
    auto* parameter = message.add_parameters();
    parameter->set_name(value.name);
    parameter->set_value(value.value);
  }
  *message.mutable_total_load() = ToProto(summary.total_load);
  *message.mutable_total_reaction() = ToProto(summary.total_reaction);
  message.set_nodes(summary.nodes);
  message.set_elements(summary.elements);
  message.set_unknowns(summary.solver.unknowns);
  message.set_seconds(analysis.seconds);
  for (const RefinementStep& step : analysis.refinements) {
    v1::RefinementStep* refinement = message.add_refinements();
    refinement->set_elements(step.elements);
    refinement->set_nodes(step.nodes);
    refinement->set_relative_error(step.relative_error);
  }
  if (!analysis.shortfall.empty()) message.add_notes(analysis.shortfall);
  for (const std::string& note : analysis.notes) message.add_notes(note);
  if (!analysis.vibration) return;
  for (const Mode& mode : analysis.vibration->modes) {
    v1::Mode& to = *message.add_modes();
    to.set_frequency(mode.frequency);
    to.set_rigid(mode.rigid);
  }
}

// modes.vtu, and mode-1.png … of the lowest that deform.
absl::Status KeepModes(const DesignAnalysis& analysis, const std::string& title,
                       const TaskSurroundings& surroundings) {
  constexpr std::size_t kPictures = 6;  // each takes about a second
  const std::vector<Mode>& modes = analysis.vibration->modes;
  MORTISE_ASSIGN_OR_RETURN(std::string fields,
                           mesh::WriteVtu(*analysis.mesh, ShapeFields(*analysis.vibration)));
  MORTISE_RETURN_IF_ERROR(surroundings.keep({"modes.vtu", "model/vnd.vtu", std::move(fields)}));
  const auto rigid = static_cast<std::size_t>(analysis.vibration->rigid_motions);
  for (std::size_t m = rigid; m < std::min(modes.size(), rigid + kPictures); ++m) {
    MORTISE_RETURN_IF_ERROR(CheckStopped(surroundings.stop));
    const std::string number = absl::StrCat("mode-", m + 1);
    MORTISE_ASSIGN_OR_RETURN(std::string picture, DrawMode(*analysis.mesh, modes[m],
                                                           absl::StrCat(title, ": mode ", m + 1)));
    MORTISE_RETURN_IF_ERROR(
        surroundings.keep({absl::StrCat(number, ".png"), "image/png", std::move(picture)}));
  }
  return absl::OkStatus();
}

void Begin(const TaskSurroundings& surroundings, const char* stage) {
  if (surroundings.progress != nullptr) surroundings.progress->Begin(stage);
}

absl::Status Evaluate(const v1::Task& task, const TaskSurroundings& surroundings,
                      v1::ReportTaskRequest& report) {
  MORTISE_ASSIGN_OR_RETURN(const auto compiled,
                           surroundings.templates.GetByDigest(task.subject(), task.revision(),
                                                              task.digest(), surroundings.origin));
  if (surroundings.progress != nullptr) surroundings.progress->Expect(StagesOf(task));
  Begin(surroundings, "geometry");
  const Eigen::VectorXd parameters = Eigen::Map<const Eigen::VectorXd>(
      task.point().parameters().data(), task.point().parameters_size());
  MORTISE_ASSIGN_OR_RETURN(const parametric::EvaluatedDesign design,
                           compiled->function->Evaluate(parameters));
  const std::vector<std::string> metrics(task.metrics().begin(), task.metrics().end());
  // Before the parts are fused, which takes a while and would fail for every design alike.
  if (!task.fields() && NeedsSolution(metrics)) {
    MORTISE_RETURN_IF_ERROR(CheckSupported(design));
    MORTISE_RETURN_IF_ERROR(CheckLoaded(design));
  }
  MORTISE_ASSIGN_OR_RETURN(const DesignModel model,
                           MakeDesignModel(*compiled->function, parameters, design,
                                           task.fields() || NeedsSurface(metrics)));
  MORTISE_RETURN_IF_ERROR(CheckStopped(surroundings.stop));
  DesignAnalysisOptions options;
  // Nobody chose the metrics of an analysis.
  options.leave_out_inapplicable = task.fields();
  options.modes = task.modes();
  options.mesh.element_size = task.mesh().element_size();
  options.mesh.quadratic = !task.mesh().linear();
  options.wanted_error = task.mesh().relative_error();
  options.elasticity.threads = surroundings.threads;
  options.elasticity.solver.memory_limit = surroundings.memory_limit;
  options.progress = surroundings.progress;
  options.elasticity.before_recovery = [&surroundings] { Begin(surroundings, "stresses"); };
  options.elasticity.solver.progress = [&surroundings](int iteration, double) {
    if (surroundings.progress != nullptr) surroundings.progress->Iterate(iteration);
    return CheckStopped(surroundings.stop);
  };
  const absl::StatusOr<DesignAnalysis> analyzed =
      AnalyzeDesign(model, metrics, task.fields(), options);
  if (!analyzed.ok()) return WithLeftOutParts(analyzed.status(), design);
  const DesignAnalysis& analysis = *analyzed;
  v1::EvaluationResult& result = *report.mutable_result();
  for (const Metric& metric : analysis.metrics) {
    v1::Metric* message = result.add_metrics();
    message->set_name(metric.name);
    message->set_unit(metric.unit);
    message->set_value(metric.value);
  }
  if (task.gradients()) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<MetricGradient> gradients,
                             MetricGradients(*compiled->function, parameters, metrics));
    for (const MetricGradient& gradient : gradients) {
      v1::Gradient* message = result.add_gradients();
      message->set_metric(gradient.metric);
      for (const double value : gradient.values) message->add_values(value);
    }
  }
  if (!task.fields()) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(CheckStopped(surroundings.stop));
  Begin(surroundings, "files");
  FillAnalysis(analysis, design, *report.mutable_analysis());
  MORTISE_ASSIGN_OR_RETURN(std::string fields, WriteFields(analysis));
  MORTISE_RETURN_IF_ERROR(surroundings.keep({"analysis.vtu", "model/vnd.vtu", std::move(fields)}));
  MORTISE_ASSIGN_OR_RETURN(std::string picture,
                           DrawStress(analysis, compiled->function->head().title));
  MORTISE_RETURN_IF_ERROR(surroundings.keep({"stress.png", "image/png", std::move(picture)}));
  return analysis.vibration ? KeepModes(analysis, compiled->function->head().title, surroundings)
                            : absl::OkStatus();
}

}  // namespace

v1::ReportTaskRequest EvaluateTask(const v1::Task& task, const TaskSurroundings& surroundings) {
  v1::ReportTaskRequest report;
  absl::Status status = absl::OkStatus();
  try {
    status = task.has_case_() ? EvaluateMeshTask(task, surroundings, report)
                              : Evaluate(task, surroundings, report);
  } catch (const std::bad_alloc&) {
    status = TooLarge("the evaluation", "the memory at hand");
  } catch (const std::exception& error) {
    status = absl::InternalError(absl::StrCat("the evaluation failed: ", error.what()));
  }
  if (status.ok()) return report;
  report.Clear();
  *report.mutable_result()->mutable_error() = rpc::ToProto(status);
  return report;
}

}  // namespace mortise::simulator
