// mortise map build: a design space sampled, so that it answers at once.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/client/tag_options.h"
#include "cli/commands/commands.h"
#include "cli/files/assignment.h"
#include "cli/files/evaluation_flags.h"
#include "cli/files/metric_definitions.h"
#include "cli/files/metric_evaluation.h"
#include "cli/output/map_output.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/evaluator.grpc.pb.h"
#include "mortise/v1/interpolator.grpc.pb.h"

namespace mortise::cli {
namespace {

struct BuildOptions {
  std::string subject;
  std::vector<std::string> metrics;
  std::vector<std::string> noise;
  bool exact_evaluations = false;
  MetricDefinitionFlags own;
  std::vector<std::string> vary;
  std::vector<std::string> fix;
  std::string basis = "linear";
  int samples = 0;
  double tolerance = 0;
  double seconds = 0;
  int structures = 0;
  std::string shape;
  std::optional<double> shape_noise;
  std::vector<std::string> fields;
  std::vector<std::string> field_noise;
  std::vector<std::string> regions;
  int modes = 0;
  std::int64_t seed = 1;
  EvaluationFlags evaluation;
  TagOptions tags;
  bool detach = false;
};

// "NAME", "NAME=LOW:HIGH" (or LOW..HIGH), or of a choice "NAME=CHOICE,CHOICE".
absl::Status AddVariation(const std::string& text, v1::MapSpecification::Variation& variation) {
  if (text.find('=') == std::string::npos) {
    variation.set_parameter(text);
    return absl::OkStatus();
  }
  const std::string plain = absl::StrReplaceAll(text, {{"..", ":"}});
  if (plain.find(':') == std::string::npos) {
    MORTISE_ASSIGN_OR_RETURN(const auto assigned, SplitAssignment(text, "--vary"));
    variation.set_parameter(assigned.first);
    for (const absl::string_view name : absl::StrSplit(assigned.second, ',')) {
      variation.add_choices(std::string(name));
    }
    return absl::OkStatus();
  }
  MORTISE_ASSIGN_OR_RETURN(const NamedRange range, ParseRange(plain, "--vary", ParseQuantity));
  variation.set_parameter(range.name);
  if (range.low) variation.set_minimum(*range.low);
  if (range.high) variation.set_maximum(*range.high);
  return absl::OkStatus();
}

// Returns the number of a choice that is fixed by its name, as the contract wants it.
absl::StatusOr<double> NumberOfChoice(const v1::DesignSpace& space, const std::string& parameter,
                                      const std::string& choice) {
  const std::string source = absl::StrCat("--fix ", parameter);
  for (const auto& known : space.parameters()) {
    if (known.name() != parameter) continue;
    const auto found = std::ranges::find(known.choices(), choice);
    if (found != known.choices().end()) return static_cast<double>(found - known.choices().begin());
    const std::string values =
        known.choices().empty() ? "a number" : absl::StrJoin(known.choices(), ", ");
    return InvalidField(source, absl::StrCat("'", choice, "' is not ", values));
  }
  return InvalidField(source, absl::StrCat(space.subject(), " has no parameter '", parameter, "'"));
}

// Returns what can be varied and asked of the subject.
absl::StatusOr<v1::DesignSpace> Describe(const v1::MapSpecification& specification,
                                         const GatewayClient& client) {
  v1::DescribeDesignSpaceRequest describe;
  describe.set_subject(specification.subject());
  *describe.mutable_metric_definitions() = specification.metric_definitions();
  return DescribeDesignSpace(describe, client);
}

absl::Status AddFixed(const std::string& text, const GatewayClient& client,
                      v1::MapSpecification& specification) {
  MORTISE_ASSIGN_OR_RETURN(const auto assigned, SplitAssignment(text, "--fix"));
  v1::ParameterValue& value = *specification.add_fixed();
  value.set_name(assigned.first);
  const absl::StatusOr<double> number = ParseQuantity(assigned.second, "--fix");
  if (number.ok()) {
    value.set_value(*number);
    return absl::OkStatus();
  }
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignSpace space, Describe(specification, client));
  MORTISE_ASSIGN_OR_RETURN(const double choice,
                           NumberOfChoice(space, assigned.first, assigned.second));
  value.set_value(choice);
  return absl::OkStatus();
}

// Fails where a unit is said that is none of the metric. That there is no such metric is found out
// later.
absl::Status CheckNoiseUnit(const std::string& metric, const std::string& value,
                            const v1::MapSpecification& specification,
                            const GatewayClient& client) {
  if (!HasUnit(value)) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignSpace space, Describe(specification, client));
  for (const auto& known : space.metrics()) {
    if (known.name() == metric) return CheckUnit(value, known.unit(), "--noise " + metric);
  }
  return absl::OkStatus();
}

absl::Status AddNoise(const std::string& text, const GatewayClient& client,
                      v1::MapSpecification& specification) {
  MORTISE_ASSIGN_OR_RETURN(const auto assigned, SplitAssignment(text, "--noise"));
  for (auto& metric : *specification.mutable_metrics()) {
    if (metric.name() != assigned.first) continue;
    MORTISE_ASSIGN_OR_RETURN(const double floor,
                             ParseMetricValue(assigned.second, "--noise " + assigned.first));
    MORTISE_RETURN_IF_ERROR(CheckNoiseUnit(assigned.first, assigned.second, specification, client));
    metric.set_noise_floor(floor);
    return absl::OkStatus();
  }
  return InvalidField("--noise " + assigned.first, "is no metric of this map");
}

absl::Status AddMetrics(const BuildOptions& options, const GatewayClient& client,
                        v1::MapSpecification& specification) {
  MORTISE_ASSIGN_OR_RETURN(*specification.mutable_metric_definitions(),
                           ParseMetricDefinitions(options.own));
  for (const std::string& name : options.metrics) specification.add_metrics()->set_name(name);
  if (options.metrics.empty()) {
    for (const auto& metric : specification.metric_definitions().expressions()) {
      specification.add_metrics()->set_name(metric.name());
    }
  }
  for (const std::string& text : options.noise) {
    MORTISE_RETURN_IF_ERROR(AddNoise(text, client, specification));
  }
  return absl::OkStatus();
}

absl::Status AddFieldNoise(const std::string& text, v1::MapSpecification::ShapeChoice& shape) {
  MORTISE_ASSIGN_OR_RETURN(const auto assigned, SplitAssignment(text, "--field-noise"));
  const std::string source = "--field-noise " + assigned.first;
  for (auto& field : *shape.mutable_fields()) {
    if (field.name() != assigned.first) continue;
    double floor = 0;
    if (!absl::SimpleAtod(assigned.second, &floor)) {
      return InvalidField(source, "must be a share of its range, such as 0.05");
    }
    field.set_noise_floor(floor);
    return absl::OkStatus();
  }
  return InvalidField(source, "is no field of this map");
}

// Shapes, where any flag asks for them: fields lie on tetrahedra unless the surface is said.
absl::Status AddShape(const BuildOptions& options, v1::MapSpecification& specification) {
  const bool is_wanted = !options.shape.empty() || !options.fields.empty() ||
                         !options.field_noise.empty() || !options.regions.empty() ||
                         options.shape_noise.has_value() || options.modes != 0;
  if (!is_wanted) return absl::OkStatus();
  v1::MapSpecification::ShapeChoice& shape = *specification.mutable_shape();
  shape.set_geometry(options.shape == "surface" ? v1::SURFACE : v1::TETRAHEDRA);
  if (options.shape_noise) shape.set_noise_floor(*options.shape_noise);
  shape.set_modes(options.modes);
  *shape.mutable_regions() = {options.regions.begin(), options.regions.end()};
  for (const std::string& name : options.fields) shape.add_fields()->set_name(name);
  for (const std::string& text : options.field_noise) {
    MORTISE_RETURN_IF_ERROR(AddFieldNoise(text, shape));
  }
  return absl::OkStatus();
}

absl::StatusOr<v1::MapSpecification> Specification(const BuildOptions& options,
                                                   const GatewayClient& client) {
  v1::MapSpecification specification;
  specification.set_subject(ResourceName("templates", options.subject));
  MORTISE_RETURN_IF_ERROR(AddMetrics(options, client, specification));
  MORTISE_RETURN_IF_ERROR(AddShape(options, specification));
  for (const std::string& text : options.vary) {
    MORTISE_RETURN_IF_ERROR(AddVariation(text, *specification.add_variations()));
  }
  for (const std::string& text : options.fix) {
    MORTISE_RETURN_IF_ERROR(AddFixed(text, client, specification));
  }
  specification.set_basis(options.basis == "cubic" ? v1::MapSpecification::CUBIC
                                                   : v1::MapSpecification::LINEAR);
  specification.set_evaluations(options.samples);
  specification.set_tolerance(options.tolerance);
  specification.set_seconds(options.seconds);
  specification.set_most_structures(options.structures);
  specification.set_seed(options.seed);
  specification.set_exact_evaluations(options.exact_evaluations);
  MORTISE_ASSIGN_OR_RETURN(const v1::MeshSettings mesh, MeshOf(options.evaluation));
  if (mesh.ByteSizeLong() > 0) *specification.mutable_mesh() = mesh;
  MORTISE_ASSIGN_OR_RETURN(const auto airflow, AirflowOf(options.evaluation));
  if (airflow) *specification.mutable_airflow() = *airflow;
  return specification;
}

absl::Status Build(const BuildOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  v1::BuildMapRequest request;
  request.set_request_id(NewIdentifier());
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_specification(), Specification(options, *client));
  MORTISE_RETURN_IF_ERROR(AddTags(options.tags, &request));
  const auto stub = v1::InterpolatorService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(const std::optional<v1::DesignMap> map,
                           RunTo<v1::DesignMap>(
                               *client, session.Work(options.detach),
                               [&](grpc::ClientContext& context, v1::Operation* operation) {
                                 return rpc::FromGrpc(stub->BuildMap(&context, request, operation));
                               },
                               output));
  if (!map) return absl::OkStatus();
  PrintMap(*map, output);
  output.DocumentOf(*map);
  return absl::OkStatus();
}

// Declares what to vary and how long to sample.
void AddSamplingFlags(CommandFlags& flags, BuildOptions& options) {
  flags.Add("--vary", options.vary,
            "What to vary: NAME over its whole range, NAME=LOW:HIGH, or of a choice NAME=A,B; "
            "without, all that are no whole numbers and no choices",
            "specification.variations");
  flags.command().add_option("--fix,--at", options.fix,
                             "NAME=VALUE: what another parameter is fixed at, its default if not "
                             "said");
  flags.AlsoGives("--fix", "specification.fixed");
  flags.Add("--samples", options.samples, "Budget of evaluations; 1000 if not given",
            "specification.evaluations");
  flags.Add("--tolerance", options.tolerance,
            "Stop once every metric is off by at most this share of its range, such as 0.01",
            "specification.tolerance");
  flags.Add("--seconds", options.seconds, "Stop after so long", "specification.seconds");
  flags.Add("--basis", options.basis, "What is between samples: linear, or cubic, which is smooth")
      ->check(CLI::IsMember({"linear", "cubic"}))
      ->capture_default_str();
  flags.Add("--structures", options.structures,
            "Most combinations of whole numbers and choices; 10 if not given",
            "specification.most_structures");
  flags.Add("--seed", options.seed, "Same seed, same map", "specification.seed")
      ->capture_default_str();
}

// Declares what to know of shapes.
void AddShapeFlags(CommandFlags& flags, BuildOptions& options) {
  flags
      .Add("--shape", options.shape,
           "To have shapes, too: surface, or tetrahedra, which is also meant where only fields are "
           "named",
           "specification.shape.geometry")
      ->check(CLI::IsMember({"surface", "tetrahedra"}));
  flags.Add("--field", options.fields,
            "Field to have on the shapes, such as von_mises; again for more",
            "specification.shape.fields");
  flags.Add("--field-noise", options.field_noise,
            "NAME=SHARE: how much of a field is chance, over its range, such as 0.05; estimated "
            "without");
  flags.Add("--shape-noise", options.shape_noise,
            "How much of the shape is chance, as a share of its size; estimated without",
            "specification.shape.noise_floor");
  flags.Add("--region", options.regions,
            "Region to name on the shapes, such as a boundary condition; all without",
            "specification.shape.regions");
  flags.Add("--modes", options.modes, "How many natural modes mode_shape has; 1 if not given",
            "specification.shape.modes");
}

}  // namespace

void AddMapBuildCommand(CLI::App& map, Session& session) {
  auto options = std::make_shared<BuildOptions>();
  CommandFlags flags(*map.add_subcommand("build", "Sample a template's design space"));
  flags.Add("subject", options->subject, "Template, or evaluators/NAME", "specification.subject")
      ->required();
  flags.Add("--metric", options->metrics, "Metric to know; again for more",
            "specification.metrics");
  flags.Add("--noise", options->noise,
            "METRIC=VALUE: how much of it is chance, as of meshes; nothing is sampled for less. "
            "Without, it is estimated by one design on two meshes");
  flags.command().add_flag("--exact-evaluations", options->exact_evaluations,
                           "Take evaluations as exact: estimate no noise");
  AddMetricDefinitionFlags(flags, options->own);
  AddShapeFlags(flags, *options);
  AddSamplingFlags(flags, *options);
  AddEvaluationFlags(flags, options->evaluation, "specification.",
                     "Of metrics of airflow: how it blows, \"X, Y, Z\" (m/s)");
  AddTagOptions(flags, options->tags);
  AddDetach(flags.command(), options->detach);
  flags.command().footer(
      "Example: mortise map build table --metric mass --metric max_displacement --vary length "
      "--vary width=0.6:0.9 --samples 60 --element-size 100mm");
  flags.Run(session, [options](FieldSources& sources, Session& s, Output& o) {
    AddSources(options->own, "specification.metric_definitions", sources);
    return Build(*options, s, o);
  });
}

}  // namespace mortise::cli
