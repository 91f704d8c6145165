#include "services/simulator/worker/task_evaluation.h"

#include <algorithm>
#include <exception>
#include <memory>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/fem/linear/stopping.h"
#include "common/files/evaluation_settings.h"
#include "common/host/file_quota.h"
#include "common/mesh/tetrahedra/mesher.h"
#include "common/messages/vector_codec.h"
#include "common/rpc/status_mapping.h"
#include "services/simulator/analysis/analysis_report.h"
#include "services/simulator/analysis/design_analysis.h"
#include "services/simulator/analysis/design_fields.h"
#include "services/simulator/worker/analysis_codec.h"
#include "services/simulator/worker/analysis_setup.h"
#include "services/simulator/worker/design_conditions.h"
#include "services/simulator/worker/fields_codec.h"
#include "services/simulator/worker/mesh_task.h"
#include "services/simulator/worker/subject_metrics.h"
#include "services/simulator/worker/template_model.h"

namespace mortise::simulator {
namespace {

// What of a design is computed; `options` say what is besides the metrics.
MetricDemands DemandsOf(const v1::Task& task, const MetricDemands& of_metrics,
                        const DesignAnalysisOptions& options,
                        const parametric::EvaluatedDesign& design) {
  const bool has_heat = HasHeat(design);
  MetricDemands demands = of_metrics;
  demands.loads = demands.loads || options.besides.loads;
  demands.heat = demands.heat || options.besides.heat;
  demands.surface = demands.surface || options.besides.surface;
  const bool solves_else = has_heat || task.has_airflow();
  demands.loads = demands.loads || (task.fields() && (IsLoaded(design) || !solves_else));
  const bool thermal_stress = demands.loads && has_heat && design.reference_temperature.has_value();
  demands.heat = demands.heat || thermal_stress || (task.fields() && has_heat);
  demands.modes = demands.modes || options.modes > 0;
  demands.airflow = demands.airflow || options.besides.airflow || options.with_airflow;
  demands.surface = demands.surface || task.fields();
  return demands;
}

// Geometry, cells and flow of the air, mesh, temperatures, solution and stresses of each load case,
// frequencies, files.
int StagesOf(const MetricDemands& demands, const DesignAnalysisOptions& options,
             const parametric::EvaluatedDesign& design) {
  const int load_cases = static_cast<int>(CountLoadCases(design));
  const bool has_mesh = options.with_mesh || demands.heat || demands.loads || demands.modes;
  return 2 + (demands.airflow ? 2 : 0) + (has_mesh ? 1 : 0) + (demands.heat ? 1 : 0) +
         (demands.loads ? 2 * load_cases : 0) + (demands.modes ? 1 : 0);
}

void FillCases(const DesignAnalysis& analysis, const DesignModel& model, v1::Analysis& message) {
  message.set_nodes(analysis.mesh->nodes.cols());
  message.set_elements(analysis.mesh->tetrahedra.cols());
  message.set_unknowns(analysis.cases.empty() ? analysis.mesh->nodes.cols()
                                              : analysis.cases[0].solution.summary.solver.unknowns);
  if (analysis.cases.size() == 1) {
    const ElasticitySummary& summary = analysis.cases[0].solution.summary;
    *message.mutable_total_load() = VectorToProto(summary.total_load);
    *message.mutable_total_reaction() = VectorToProto(summary.total_reaction);
  }
  const auto support_nodes = NodesOf(*analysis.mesh, model.analysis.supports);
  for (const SolvedCase& solved : analysis.cases) {
    Fill(OutcomeOf(solved.name, *analysis.mesh, solved.solution, solved.error->relative,
                   *solved.spread, support_nodes),
         analysis.mesh->part_names, *message.add_cases());
  }
}

void FillModes(const ModalSolution& vibration, v1::Analysis& message) {
  for (const Mode& mode : vibration.modes) {
    v1::Mode& to = *message.add_modes();
    to.set_frequency(mode.frequency);
    to.set_rigid(mode.rigid);
  }
  const std::string note = NoteOnRigidMotions(vibration);
  if (!note.empty()) message.add_notes(note);
}

void FillAnalysis(const DesignAnalysis& analysis, const DesignModel& model,
                  const Eigen::Vector3d& wind, const parametric::EvaluatedDesign& design,
                  v1::Analysis& message) {
  for (const parametric::NamedValue& value : design.parameters) {
    auto* parameter = message.add_parameters();
    parameter->set_name(value.name);
    parameter->set_value(value.value);
    parameter->set_choice(value.choice);
  }
  if (analysis.mesh) FillCases(analysis, model, message);
  if (analysis.heat) Fill(OutcomeOf(*analysis.heat), *message.mutable_heat());
  if (analysis.airflow) Fill(*analysis.airflow, wind, *message.mutable_airflow());
  if (analysis.vibration) FillModes(*analysis.vibration, message);
  message.set_seconds(analysis.seconds);
  for (const RefinementStep& step : analysis.refinements) {
    v1::RefinementStep* refinement = message.add_refinements();
    refinement->set_elements(step.elements);
    refinement->set_nodes(step.nodes);
    refinement->set_relative_error(step.relative_error);
  }
  if (!analysis.shortfall.empty()) message.add_notes(analysis.shortfall);
  for (const std::string& note : analysis.notes) message.add_notes(note);
}

// analysis.vtu and stress.png of the only load case; of several, each with its number and name.
absl::Status KeepCases(const DesignAnalysis& analysis, const DesignModel& model,
                       const std::string& title, const TaskContext& context) {
  const bool is_only = analysis.cases.size() == 1;
  for (std::size_t i = 0; i < analysis.cases.size(); ++i) {
    const SolvedCase& solved = analysis.cases[i];
    const std::string stem = FileStem(i + 1, solved.name);
    MORTISE_RETURN_IF_ERROR(CheckStopped(context.stop));
    MORTISE_ASSIGN_OR_RETURN(
        std::string fields,
        WriteFields(*analysis.mesh, solved.solution, solved.error->element_error,
                    model.reference_temperature.value_or(0)));
    MORTISE_RETURN_IF_ERROR(context.keep(
        {is_only ? "analysis.vtu" : stem + ".vtu", "model/vnd.vtu", std::move(fields)}));
    MORTISE_ASSIGN_OR_RETURN(std::string picture,
                             DrawStress(*analysis.mesh, solved.solution,
                                        is_only ? title : absl::StrCat(title, ": ", solved.name)));
    MORTISE_RETURN_IF_ERROR(
        context.keep({is_only ? "stress.png" : stem + ".png", "image/png", std::move(picture)}));
  }
  return absl::OkStatus();
}

// heat.vtu and heat.png.
absl::Status KeepHeat(const DesignAnalysis& analysis, const DesignModel& model,
                      const std::string& title, const TaskContext& context) {
  MORTISE_RETURN_IF_ERROR(CheckStopped(context.stop));
  const Eigen::VectorXd& temperature = analysis.heat->temperature;
  MORTISE_ASSIGN_OR_RETURN(std::string fields,
                           WriteHeat(*analysis.mesh, model.analysis.materials, temperature));
  MORTISE_RETURN_IF_ERROR(context.keep({"heat.vtu", "model/vnd.vtu", std::move(fields)}));
  MORTISE_ASSIGN_OR_RETURN(
      std::string picture,
      DrawTemperature(*analysis.mesh, temperature, absl::StrCat(title, ": temperature (K)")));
  return context.keep({"heat.png", "image/png", std::move(picture)});
}

// airflow.vtu and airflow.png.
absl::Status KeepAirflow(const AirflowSolution& airflow, const Eigen::Vector3d& wind,
                         const std::string& title, const TaskContext& context) {
  MORTISE_RETURN_IF_ERROR(CheckStopped(context.stop));
  MORTISE_ASSIGN_OR_RETURN(
      std::string fields,
      mesh::WriteVtu(airflow.surface, {{"pressure (Pa)", airflow.pressure.transpose()}}));
  MORTISE_RETURN_IF_ERROR(context.keep({"airflow.vtu", "model/vnd.vtu", std::move(fields)}));
  MORTISE_ASSIGN_OR_RETURN(
      std::string picture,
      DrawAirPressure(airflow, wind, absl::StrCat(title, ": pressure of the air (Pa)")));
  return context.keep({"airflow.png", "image/png", std::move(picture)});
}

// A report that is not finite would be refused, and the task tried again and again.
absl::Status CheckFinite(const DesignAnalysis& analysis) {
  const bool is_finite =
      (!analysis.heat || IsFinite(*analysis.heat)) &&
      std::all_of(analysis.cases.begin(), analysis.cases.end(),
                  [](const SolvedCase& solved) { return IsFinite(solved.solution); });
  if (is_finite) return absl::OkStatus();
  return InvalidField("boundary_conditions",
                      "lead to results that are not finite: some number is far too large");
}

// modes.vtu, and mode-1.png … of the lowest that deform.
absl::Status KeepModes(const DesignAnalysis& analysis, const std::string& title,
                       const TaskContext& context) {
  constexpr std::size_t kPictures = 6;  // each takes about a second
  const std::vector<Mode>& modes = analysis.vibration->modes;
  MORTISE_ASSIGN_OR_RETURN(std::string fields,
                           mesh::WriteVtu(*analysis.mesh, ShapeFields(*analysis.vibration)));
  MORTISE_RETURN_IF_ERROR(context.keep({"modes.vtu", "model/vnd.vtu", std::move(fields)}));
  const auto rigid = static_cast<std::size_t>(analysis.vibration->rigid_motions);
  for (std::size_t m = rigid; m < std::min(modes.size(), rigid + kPictures); ++m) {
    MORTISE_RETURN_IF_ERROR(CheckStopped(context.stop));
    const std::string number = absl::StrCat("mode-", m + 1);
    MORTISE_ASSIGN_OR_RETURN(std::string picture, DrawMode(*analysis.mesh, modes[m],
                                                           absl::StrCat(title, ": mode ", m + 1)));
    MORTISE_RETURN_IF_ERROR(
        context.keep({absl::StrCat(number, ".png"), "image/png", std::move(picture)}));
  }
  return absl::OkStatus();
}

void Begin(const TaskContext& context, const char* stage) {
  if (context.progress != nullptr) context.progress->Begin(stage);
}

// What a task is about: a template, and the design that it is at the task's point.
struct Subject {
  std::shared_ptr<const EvaluatedTemplate> compiled;
  Eigen::VectorXd parameters;
  parametric::EvaluatedDesign design;
  parametric::MetricExpressions own;  // metrics
};

absl::StatusOr<Subject> EvaluateSubject(const v1::Task& task, const TaskContext& context) {
  Subject subject;
  MORTISE_ASSIGN_OR_RETURN(subject.compiled,
                           context.templates.GetByDigest(task.subject(), task.revision(),
                                                         task.digest(), context.origin));
  Begin(context, "geometry");
  subject.parameters = Eigen::Map<const Eigen::VectorXd>(task.point().parameters().data(),
                                                         task.point().parameters_size());
  MORTISE_ASSIGN_OR_RETURN(subject.design,
                           subject.compiled->design_template->Evaluate(subject.parameters));
  if (task.has_setup()) {
    v1::AnalysisSetup setup = task.setup();
    MORTISE_RETURN_IF_ERROR(AddSetup(setup, subject.design));
  }
  MORTISE_ASSIGN_OR_RETURN(subject.own,
                           CustomMetricsOf(*subject.compiled, task.metric_definitions()));
  return subject;
}

// Fails where the design lacks what has to act on it.
absl::Status CheckConditions(const v1::Task& task, const MetricDemands& demands,
                             const parametric::EvaluatedDesign& design) {
  if (!task.fields() && demands.loads) {
    MORTISE_RETURN_IF_ERROR(CheckSupported(design));
    MORTISE_RETURN_IF_ERROR(CheckLoaded(design));
  }
  return demands.heat ? CheckHeated(design) : absl::OkStatus();
}

double SizeScaleOf(const v1::MeshSettings& mesh) {
  return mesh.size_scale() == 0 ? 1 : mesh.size_scale();
}

// How many elements there may be where nobody says how large they are to be.
mesh::ElementBudget BudgetOf(const v1::MeshSettings& mesh) {
  return {mesh.linear() ? mesh::kLinearBudget : mesh::kQuadraticBudget, SizeScaleOf(mesh)};
}

// `context` must outlive what is returned.
absl::StatusOr<DesignAnalysisOptions> OptionsOf(const v1::Task& task, const Subject& subject,
                                                const TaskContext& context) {
  DesignAnalysisOptions options;
  // Nobody chose the metrics of an analysis.
  options.leave_out_inapplicable = task.fields();
  options.modes = task.modes();
  options.mesh.quadratic = !task.mesh().linear();
  if (task.mesh().element_size() == 0) options.budget = BudgetOf(task.mesh());
  options.wanted_error = task.mesh().relative_error();
  options.elasticity.threads = context.threads;
  options.elasticity.solver.kind = SolverKindOf(task.solver());
  options.elasticity.solver.memory_limit = context.memory_limit;
  options.progress = context.progress;
  options.custom_metrics = subject.own;
  options.parameters = subject.parameters;
  MORTISE_ASSIGN_OR_RETURN(options.airflow, parametric::ReadAirflow(task.airflow()));
  options.airflow_solver.memory_limit = context.memory_limit;
  options.airflow_solver.progress = context.progress;
  options.airflow_solver.stop = context.stop;
  options.with_airflow = task.fields() && task.has_airflow();
  if (task.has_design_fields()) DemandFields(ReadDemand(task.design_fields()), options);
  options.elasticity.solver.progress = [&context](int iteration, double) {
    if (context.progress != nullptr) context.progress->Iterate(iteration);
    return CheckStopped(context.stop);
  };
  return options;
}

void FillMetrics(const DesignAnalysis& analysis, v1::EvaluationResult& result) {
  for (const Metric& metric : analysis.metrics) *result.add_metrics() = ToProto(metric);
}

void FillGradients(const DesignAnalysis& analysis, v1::EvaluationResult& result) {
  for (const MetricGradient& gradient : analysis.gradients) {
    v1::Gradient* message = result.add_gradients();
    message->set_metric(gradient.metric);
    for (const double value : gradient.values) message->add_values(value);
  }
}

// The files of everything that was solved.
absl::Status KeepFiles(const DesignAnalysis& analysis, const DesignModel& model,
                       const Eigen::Vector3d& wind, const std::string& title,
                       const TaskContext& context) {
  MORTISE_RETURN_IF_ERROR(KeepCases(analysis, model, title, context));
  if (analysis.heat) MORTISE_RETURN_IF_ERROR(KeepHeat(analysis, model, title, context));
  if (analysis.airflow) {
    MORTISE_RETURN_IF_ERROR(KeepAirflow(*analysis.airflow, wind, title, context));
  }
  return analysis.vibration ? KeepModes(analysis, title, context) : absl::OkStatus();
}

// The file of the shape and fields that the task asks for.
absl::Status KeepDesignFields(const v1::Task& task, const DesignAnalysis& analysis,
                              const DesignModel& model, const TaskContext& context,
                              v1::ReportTaskRequest& report) {
  MORTISE_RETURN_IF_ERROR(CheckStopped(context.stop));
  Begin(context, "fields");
  const v1::DesignFieldsRequest& wanted = task.design_fields();
  MORTISE_ASSIGN_OR_RETURN(const fields::DesignFields design,
                           CollectFields(model, analysis, ReadDemand(wanted)));
  const absl::StatusOr<std::string> bytes = fields::WriteFields(design, ReadWriteOptions(wanted));
  if (!bytes.ok()) return UnderField("design_fields", bytes.status());
  const absl::StatusOr<std::string> sha256 = context.upload(*bytes);
  // There will never be room for it.
  if (DetailOf(sha256.status()).reason == rpc::kFileBeyondQuota) {
    return UnderField("design_fields", sha256.status());
  }
  if (!sha256.ok()) {
    // No fault of the design's, whatever the reason: the next try may find room.
    return absl::UnavailableError(absl::StrCat("the file of shape and fields could not be stored: ",
                                               sha256.status().message()));
  }
  *report.mutable_result()->mutable_design_fields() = Describe(design, *sha256, bytes->size());
  return absl::OkStatus();
}

// Makes the model, and says how large its elements are to be; 0 for the default of its surface.
absl::StatusOr<DesignModel> ModelOf(const v1::Task& task, const Subject& subject,
                                    const MetricDemands& demands, double& element_size) {
  const templates::Template& function = *subject.compiled->design_template;
  const double scale = SizeScaleOf(task.mesh());
  Joining joining{demands.surface, scale * task.mesh().element_size(), task.has_design_fields()};
  MORTISE_ASSIGN_OR_RETURN(DesignModel model,
                           MakeDesignModel(function, subject.parameters, subject.design, joining));
  if (scale != 1 && joining.element_size == 0 && demands.surface) {
    // The default follows from the surface, whose round faces are drawn for the size in turn.
    joining.element_size = scale * mesh::DefaultElementSize(model.surface);
    MORTISE_ASSIGN_OR_RETURN(
        model, MakeDesignModel(function, subject.parameters, subject.design, joining));
  }
  element_size = joining.element_size;
  return model;
}

absl::Status Evaluate(const v1::Task& task, const TaskContext& context,
                      v1::ReportTaskRequest& report) {
  MORTISE_ASSIGN_OR_RETURN(const Subject subject, EvaluateSubject(task, context));
  const parametric::EvaluatedDesign& design = subject.design;
  const templates::Template& function = *subject.compiled->design_template;
  const std::vector<std::string> metrics(task.metrics().begin(), task.metrics().end());
  MORTISE_ASSIGN_OR_RETURN(DesignAnalysisOptions options, OptionsOf(task, subject, context));
  const MetricDemands demands =
      DemandsOf(task, simulator::DemandsOf(metrics, subject.own), options, design);
  if (context.progress != nullptr) {
    context.progress->Expect(StagesOf(demands, options, design));
  }
  // Before the parts are fused, which takes a while and would fail for every design alike.
  MORTISE_RETURN_IF_ERROR(CheckConditions(task, demands, design));
  MORTISE_ASSIGN_OR_RETURN(const DesignModel model,
                           ModelOf(task, subject, demands, options.mesh.element_size));
  MORTISE_RETURN_IF_ERROR(CheckStopped(context.stop));
  DesignMotion motion;
  if (task.gradients()) {
    motion = KnownMotion(function, subject.parameters, design, model);
    options.motion = &motion;
  }
  const absl::StatusOr<DesignAnalysis> analysis =
      AnalyzeDesign(model, metrics, task.fields(), options);
  if (!analysis.ok()) return WithLeftOutParts(analysis.status(), design);
  MORTISE_RETURN_IF_ERROR(CheckFinite(*analysis));
  FillMetrics(*analysis, *report.mutable_result());
  if (task.gradients()) FillGradients(*analysis, *report.mutable_result());
  if (task.has_design_fields()) {
    MORTISE_RETURN_IF_ERROR(KeepDesignFields(task, *analysis, model, context, report));
  }
  if (!task.fields()) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(CheckStopped(context.stop));
  Begin(context, "files");
  const Eigen::Vector3d& wind = options.airflow.wind;
  FillAnalysis(*analysis, model, wind, design, *report.mutable_analysis());
  return KeepFiles(*analysis, model, wind, function.head().title, context);
}

}  // namespace

v1::ReportTaskRequest EvaluateTask(const v1::Task& task, const TaskContext& context) {
  v1::ReportTaskRequest report;
  absl::Status status = absl::OkStatus();
  try {
    status = task.has_case_() ? EvaluateMeshTask(task, context, report)
                              : Evaluate(task, context, report);
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
