// mortise analyze: finite elements on a template at parameters, or on an uploaded mesh; the air
// around a template; its metrics.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/client/tag_options.h"
#include "cli/commands/commands.h"
#include "cli/files/analysis_setup.h"
#include "cli/files/evaluation_flags.h"
#include "cli/files/mesh_analysis.h"
#include "cli/files/metric_definitions.h"
#include "cli/files/metric_evaluation.h"
#include "cli/files/metric_report.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/simulator.grpc.pb.h"

namespace mortise::cli {
namespace {

constexpr double kDifferenceStep = 0.05;

struct AnalyzeOptions {
  std::string subject;
  std::vector<std::string> parameters;
  std::vector<std::string> metrics;  // these and nothing else, if there are any
  MetricDefinitionFlags own;
  bool gradients = false;
  double difference_step = kDifferenceStep;
  EvaluationFlags evaluation;  // with wind, the air around the design besides
  SetupFlags setup;
  std::string solver;  // "direct", "iterative" or empty
  int modes = 0;
  std::filesystem::path mesh;  // with it, `subject` is the file of a case
  TagOptions tags;
  std::filesystem::path out;
  bool detach = false;
};

v1::SolverKind SolverOf(const AnalyzeOptions& options) {
  if (options.solver.empty()) return v1::SOLVER_KIND_UNSPECIFIED;
  return options.solver == "direct" ? v1::DIRECT : v1::ITERATIVE;
}

absl::Status DownloadArtifacts(const v1::Analysis& analysis, const std::filesystem::path& out,
                               v1::SimulatorService::Stub& stub, const GatewayClient& client,
                               const Output& output) {
  for (const v1::Artifact& artifact : analysis.artifacts()) {
    v1::DownloadArtifactRequest request;
    request.set_name(analysis.name());
    request.set_file_name(artifact.file_name());
    const std::filesystem::path path = out / artifact.file_name();
    MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
      return Receive(*stub.DownloadArtifact(&context, request), path).status();
    }));
    output.Line(absl::StrCat("  ", path.string()));
  }
  return absl::OkStatus();
}

absl::Status AnalyzeMesh(const AnalyzeOptions& options, Session& session, Output& output) {
  if (!options.parameters.empty() || options.evaluation.any() || !options.metrics.empty() ||
      !options.own.define.empty() || !options.own.point.empty() || options.gradients ||
      !options.setup.empty()) {
    return InvalidField(
        "--mesh",
        "is a mesh already: --set, --metric, --define, --point, --gradients, --element-size, "
        "--size-scale, --relative-error, --linear, --wind, --air-cells, --support, --load and "
        "--setup are for templates");
  }
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::SimulatorService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<v1::Analysis> done,
      AnalyzeMeshFiles({options.subject, options.mesh, SolverOf(options), options.tags},
                       session.Work(options.detach), *stub, *client, output));
  if (!done) return absl::OkStatus();
  const v1::Analysis& analysis = *done;
  PrintMeshAnalysis(analysis, output);
  if (!options.out.empty()) {
    MORTISE_RETURN_IF_ERROR(DownloadArtifacts(analysis, options.out, *stub, *client, output));
  }
  output.DocumentOf(analysis);
  return absl::OkStatus();
}

void PrintMetrics(const Metrics& metrics, const Output& output) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::Metric& metric : metrics) {
    rows.push_back({metric.name(), MetricReport(metric, metrics)});
  }
  output.Table({"metric", "value"}, rows);
}

// Of a whole analysis, whose metrics nobody has chosen, those that say something of the design.
void PrintReport(const v1::Analysis& analysis, const Output& output) {
  Metrics told;
  for (const v1::Metric& metric : analysis.metrics()) {
    if (!IsBeside(metric.name(), analysis.metrics())) *told.Add() = metric;
  }
  PrintMetrics(told, output);
}

void PrintNotes(const v1::Analysis& analysis, const Output& output) {
  for (const std::string& note : analysis.notes()) {
    if (IsNoteBeside(note, analysis.metrics())) continue;
    output.Line(absl::StrCat("  note: ", note));
  }
  const std::string advice = AdviceOnError(analysis);
  if (!advice.empty()) output.Line(absl::StrCat("  note: ", advice));
}

// A row for each metric and parameter, in SI units.
void PrintGradients(const EvaluatedMetrics& evaluated, const Output& output) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::Gradient& gradient : evaluated.result.gradients()) {
    std::string unit;
    for (const v1::Metric& metric : evaluated.result.metrics()) {
      if (metric.name() == gradient.metric()) unit = metric.unit();
    }
    for (int k = 0; k < gradient.values_size(); ++k) {
      const auto& parameter = evaluated.space.parameters(k);
      rows.push_back({gradient.metric(), parameter.name(),
                      absl::StrFormat("%.5g %s per %s", gradient.values(k), unit,
                                      parameter.unit().empty() ? "1" : parameter.unit()),
                      gradient.by_differences() ? "by differences" : "exact"});
    }
  }
  if (!rows.empty()) output.Table({"metric", "parameter", "gradient", ""}, rows);
}

absl::Status Evaluate(const AnalyzeOptions& options, const v1::AnalyzeDesignRequest& asked,
                      Session& session, Output& output) {
  if (options.modes > 0) {
    return InvalidField("--modes", "are of a whole analysis: ask for --metric natural_frequency");
  }
  if (!options.solver.empty()) {
    return InvalidField("--solver", "is for a whole analysis, not for --metric and --define");
  }
  if (!options.tags.empty()) {
    return InvalidField(options.tags.labels.empty() ? "--external-id" : "--label",
                        "is for a whole analysis: --metric makes nothing to find again");
  }
  if (!options.out.empty()) {
    return InvalidField("--out", "is for a whole analysis: --metric makes no files");
  }
  if (!options.setup.empty()) {
    return InvalidField(!options.setup.supports.empty() ? "--support"
                        : !options.setup.loads.empty()  ? "--load"
                                                        : "--setup",
                        "is for a whole analysis: --metric and --define are of the template alone");
  }
  MORTISE_ASSIGN_OR_RETURN(const v1::MetricDefinitions definitions,
                           ParseMetricDefinitions(options.own));
  v1::EvaluateBatchRequest request;
  *request.mutable_metrics() = {options.metrics.begin(), options.metrics.end()};
  if (options.metrics.empty()) {
    for (const auto& metric : definitions.expressions()) request.add_metrics(metric.name());
  }
  *request.mutable_metric_definitions() = definitions;
  *request.mutable_mesh() = asked.mesh();
  *request.mutable_airflow() = asked.airflow();
  request.set_gradients(options.gradients);
  if (options.gradients) request.set_difference_step(options.difference_step);
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(
      const EvaluatedMetrics evaluated,
      EvaluateMetrics(asked.template_(), {asked.parameters().begin(), asked.parameters().end()},
                      request, *client));
  PrintMetrics(evaluated.result.metrics(), output);
  PrintGradients(evaluated, output);
  output.DocumentOf(evaluated.result);
  return absl::OkStatus();
}

void PrintAirflow(const v1::Analysis& analysis, const Output& output) {
  if (!analysis.has_airflow()) return;
  const v1::AirflowResult& airflow = analysis.airflow();
  output.Line(absl::StrFormat(
      "  air: %d cells, %d iterations; the force swings by %.2g N; %.2g N of it is friction",
      airflow.cells(), airflow.iterations(), airflow.force_swing(),
      std::hypot(airflow.friction().x(), airflow.friction().y(), airflow.friction().z())));
}

absl::Status Analyze(const AnalyzeOptions& options, FieldSources& sources, Session& session,
                     Output& output) {
  if (!options.mesh.empty()) return AnalyzeMesh(options, session, output);
  if (LowerCaseExtension(options.subject) == ".json") {
    return InvalidField("--mesh", "is missing: a case needs the file of its mesh");
  }
  v1::AnalyzeDesignRequest request;
  request.set_request_id(NewIdentifier());
  request.set_template_(ResourceName("templates", options.subject));
  MORTISE_ASSIGN_OR_RETURN(const auto parameters, ParseParameters(options.parameters));
  request.mutable_parameters()->Assign(parameters.begin(), parameters.end());
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_mesh(), MeshOf(options.evaluation));
  request.set_modes(options.modes);
  request.set_solver(SolverOf(options));
  MORTISE_ASSIGN_OR_RETURN(const auto airflow, AirflowOf(options.evaluation));
  if (airflow) *request.mutable_airflow() = *airflow;
  if (!options.setup.empty()) {
    MORTISE_ASSIGN_OR_RETURN(*request.mutable_setup(), SetupOf(options.setup, sources));
  }
  MORTISE_RETURN_IF_ERROR(AddTags(options.tags, &request));
  if (!options.metrics.empty() || !options.own.define.empty()) {
    return Evaluate(options, request, session, output);
  }
  if (options.gradients) {
    return InvalidField("--gradients", "are of metrics: say which with --metric or --define");
  }
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::SimulatorService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<v1::Analysis> done,
      RunTo<v1::Analysis>(
          *client, session.Work(options.detach),
          [&](grpc::ClientContext& context, v1::Operation* operation) {
            return rpc::FromGrpc(stub->AnalyzeDesign(&context, request, operation));
          },
          output));
  if (!done) return absl::OkStatus();
  const v1::Analysis& analysis = *done;
  output.Line(analysis.elements() == 0
                  ? analysis.name()
                  : absl::StrCat(analysis.name(), ": ", analysis.elements(), " elements, ",
                                 analysis.unknowns(), " unknowns"));
  PrintReport(analysis, output);
  if (analysis.cases_size() > 1) PrintCases(analysis, output);
  PrintSolvers(analysis, output);
  PrintHeat(analysis, " K", output);
  PrintAirflow(analysis, output);
  PrintModes(analysis, output);
  for (const v1::RefinementStep& step : analysis.refinements()) {
    output.Line(absl::StrFormat("  %d elements: estimated error %.2g %%", step.elements(),
                                100 * step.relative_error()));
  }
  PrintNotes(analysis, output);
  if (!options.out.empty()) {
    MORTISE_RETURN_IF_ERROR(DownloadArtifacts(analysis, options.out, *stub, *client, output));
  }
  output.DocumentOf(analysis);
  return absl::OkStatus();
}

// Declares how a design or a mesh is solved, and where files go.
void AddSolvingFlags(CommandFlags& flags, AnalyzeOptions& options) {
  AddEvaluationFlags(flags, options.evaluation, "",
                     "The air around it besides, computed by OpenFOAM: how it blows, \"X, Y, Z\" "
                     "(m/s), such as \"-10, 0, 0\"");
  AddSetupFlags(flags, options.setup);
  flags.Add("--modes", options.modes, "How many natural frequencies besides, up to 100", "modes");
  flags
      .Add("--solver", options.solver,
           "How load cases are solved: direct, by one factor for all, or iterative; by default "
           "whichever should be sooner")
      ->check(CLI::IsMember({"direct", "iterative"}));
  flags.Add("--mesh", options.mesh,
            "Mesh of the case: Gmsh (MSH 2.2, 4.1), Abaqus or CalculiX (.inp)");
  flags.Add("--out", options.out, "Folder for pictures (PNG), fields (VTU) and probes (CSV)");
}

}  // namespace

void AddAnalyzeCommand(CLI::App& app, Session& session) {
  auto options = std::make_shared<AnalyzeOptions>();
  CommandFlags flags(*app.add_subcommand("analyze", "Check a design or a mesh by finite elements"));
  flags
      .Add("template", options->subject,
           "Template, such as table; with --mesh the file of a case, such as bar.json")
      ->required();
  flags.Add("--set", options->parameters,
            "NAME=VALUE, such as length=1500mm (metres without unit) or armrests=both",
            "parameters");
  // The evaluator speaks of points in the template's order, not of names.
  flags.AlsoGives("--set", "points[0].parameters");
  flags.Add("--metric", options->metrics,
            "Only this, such as mass, cost, draught or max_displacement; again for more",
            "metrics");
  AddMetricDefinitionFlags(flags, options->own, "; only those and --metric are computed");
  flags.command().add_flag("--gradients", options->gradients,
                           "With --metric or --define: how they change with each parameter");
  flags
      .Add("--difference-step", options->difference_step,
           "Of gradients that are not exact, as a share of the parameters' ranges; 0 for exact "
           "ones only",
           "difference_step")
      ->capture_default_str();
  AddSolvingFlags(flags, *options);
  AddTagOptions(flags, options->tags);
  AddDetach(flags.command(), options->detach)
      ->excludes("--out")
      ->excludes("--metric")
      ->excludes("--define");
  flags.command().footer(
      "Example: mortise analyze table --set length=1500mm --out out/table\n"
      "Example: mortise analyze table --metric mass --metric max_displacement --gradients\n"
      "Example: mortise analyze boat --metric draught --metric metacentric_height\n"
      "Example: mortise analyze tray --support board/z_min --load board/z_max=0,0,-100N\n"
      "Example: mortise analyze collection/meshes/bracket.json --mesh "
      "collection/meshes/bracket.msh --out out/bracket");
  flags.Run(session, [options](FieldSources& sources, Session& s, Output& o) {
    AddSources(options->own, "metric_definitions", sources);
    return Analyze(*options, sources, s, o);
  });
}

}  // namespace mortise::cli
