// mortise pareto run|show: trade-offs.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "cli/client/command_flags.h"
#include "cli/client/json_input.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/client/tag_options.h"
#include "cli/commands/commands.h"
#include "cli/files/assignment.h"
#include "cli/files/metric_definitions.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/pareto.grpc.pb.h"

namespace mortise::cli {
namespace {

struct RunOptions {
  std::string subject;  // a template, or a file with a DiscoverySpecification as JSON
  std::vector<std::string> minimize;
  std::vector<std::string> maximize;
  MetricDefinitionFlags own;
  std::vector<std::string> fix;
  std::vector<std::string> allow;
  std::vector<std::string> range;
  std::vector<std::string> constrain;
  std::vector<std::string> start_from;
  std::vector<std::string> tolerance;
  double deviations = 0;
  int evaluations = 0;
  std::int64_t seed = 1;
  std::string surrogate;
  TagOptions tags;
  std::filesystem::path out;
  bool detach = false;
};

bool IsFile(const RunOptions& options) { return LowerCaseExtension(options.subject) == ".json"; }

using Bound = v1::DiscoverySpecification::Bound;

// A number, or the name of a choice.
absl::Status AddFixed(const std::string& text, Bound& bound) {
  MORTISE_ASSIGN_OR_RETURN(const auto assigned, SplitAssignment(text, "--fix"));
  bound.set_parameter(assigned.first);
  const absl::StatusOr<double> number = ParseQuantity(assigned.second, "--fix");
  if (!number.ok()) {
    bound.add_choices(assigned.second);
    return absl::OkStatus();
  }
  bound.set_minimum(*number);
  bound.set_maximum(*number);
  return absl::OkStatus();
}

absl::Status AddAllowed(const std::string& text, Bound& bound) {
  MORTISE_ASSIGN_OR_RETURN(const auto assigned, SplitAssignment(text, "--allow"));
  bound.set_parameter(assigned.first);
  for (const absl::string_view name : absl::StrSplit(assigned.second, ',')) {
    bound.add_choices(std::string(name));
  }
  return absl::OkStatus();
}

absl::Status AddRange(const std::string& text, Bound& bound) {
  MORTISE_ASSIGN_OR_RETURN(const NamedRange range, ParseRange(text, "--range", ParseQuantity));
  if (!range.low || !range.high) {
    return InvalidField("--range", absl::StrCat("'", text, "' is not of the form NAME=LOW:HIGH"));
  }
  bound.set_parameter(range.name);
  bound.set_minimum(*range.low);
  bound.set_maximum(*range.high);
  return absl::OkStatus();
}

absl::Status AddBounds(const RunOptions& options, v1::DiscoverySpecification& specification,
                       FieldSources& sources) {
  const auto add_each = [&](const std::string& option, const std::vector<std::string>& texts,
                            absl::Status (*add)(const std::string&, Bound&)) {
    if (!texts.empty()) {
      sources.AddEach("specification.bounds", option, texts, specification.bounds_size());
    }
    for (const std::string& text : texts) {
      MORTISE_RETURN_IF_ERROR(add(text, *specification.add_bounds()));
    }
    return absl::OkStatus();
  };
  MORTISE_RETURN_IF_ERROR(add_each("--fix", options.fix, AddFixed));
  MORTISE_RETURN_IF_ERROR(add_each("--allow", options.allow, AddAllowed));
  return add_each("--range", options.range, AddRange);
}

absl::Status AddConstraints(const RunOptions& options, v1::DiscoverySpecification& specification,
                            FieldSources& sources) {
  if (options.constrain.empty()) return absl::OkStatus();
  sources.AddEach("specification.constraints", "--constrain", options.constrain,
                  specification.constraints_size());
  for (const std::string& text : options.constrain) {
    MORTISE_ASSIGN_OR_RETURN(const NamedRange range, ParseRange(text, "--constrain"));
    auto& constraint = *specification.add_constraints();
    constraint.set_metric(range.name);
    if (range.low) constraint.set_minimum(*range.low);
    if (range.high) constraint.set_maximum(*range.high);
  }
  return absl::OkStatus();
}

// "NAME=LIMIT", or "NAME=DEVIATION:normal".
absl::Status AddTolerances(const RunOptions& options, v1::DiscoverySpecification& specification,
                           FieldSources& sources) {
  if (options.tolerance.empty()) return absl::OkStatus();
  sources.AddEach("specification.tolerances", "--tolerance", options.tolerance,
                  specification.tolerances_size());
  for (const std::string& text : options.tolerance) {
    const std::size_t equals = text.find('='), colon = text.find(':');
    const std::string kind = colon == std::string::npos ? "" : text.substr(colon + 1);
    if (equals == std::string::npos || equals == 0 ||
        (colon != std::string::npos && kind != "normal")) {
      return InvalidField("--tolerance", absl::StrCat("'", text,
                                                      "' is not of the form NAME=VALUE or "
                                                      "NAME=VALUE:normal"));
    }
    auto& tolerance = *specification.add_tolerances();
    tolerance.set_parameter(text.substr(0, equals));
    MORTISE_ASSIGN_OR_RETURN(
        const double deviation,
        ParseQuantity(text.substr(equals + 1, std::min(colon, text.size()) - equals - 1),
                      "--tolerance"));
    tolerance.set_deviation(deviation);
    using Tolerance = v1::DiscoverySpecification::Tolerance;
    tolerance.set_distribution(kind.empty() ? Tolerance::UNIFORM : Tolerance::NORMAL);
  }
  return absl::OkStatus();
}

void AddObjectives(const RunOptions& options, v1::DiscoverySpecification& specification,
                   FieldSources& sources) {
  if (!options.minimize.empty() || !IsFile(options)) {
    sources.AddEach("specification.objectives", "--minimize", options.minimize,
                    specification.objectives_size());
  }
  for (const std::string& metric : options.minimize) {
    specification.add_objectives()->set_metric(metric);
  }
  if (!options.maximize.empty()) {
    sources.AddEach("specification.objectives", "--maximize", options.maximize,
                    specification.objectives_size());
  }
  for (const std::string& metric : options.maximize) {
    v1::DiscoverySpecification::Objective* const objective = specification.add_objectives();
    objective->set_metric(metric);
    objective->set_maximize(true);
  }
}

// `sources` learns what gave which field.
absl::StatusOr<v1::DiscoverySpecification> Specification(const RunOptions& options,
                                                         FieldSources& sources) {
  v1::DiscoverySpecification specification;
  if (IsFile(options)) {
    MORTISE_ASSIGN_OR_RETURN(const std::string text, ReadFile(options.subject, 4 << 20));
    MORTISE_RETURN_IF_ERROR(ReadJson(text, options.subject, specification));
    sources.AddFile("specification", options.subject);
  } else {
    sources.Add("specification.subject", "subject");
    sources.Add("specification.seed", "--seed");
    sources.Add("specification.evaluations", "--evaluations");
    specification.set_subject(ResourceName("templates", options.subject));
    specification.set_seed(options.seed);
    specification.set_evaluations(200);
  }
  AddObjectives(options, specification, sources);
  if (!options.own.define.empty() || !options.own.point.empty()) {
    MORTISE_ASSIGN_OR_RETURN(*specification.mutable_metric_definitions(),
                             ParseMetricDefinitions(options.own));
    AddSources(options.own, "specification.metric_definitions", sources);
  }
  if (options.evaluations > 0) {
    specification.set_evaluations(options.evaluations);
    sources.Add("specification.evaluations", "--evaluations");
  }
  if (!options.surrogate.empty()) {
    specification.set_surrogate(
        options.surrogate == "always"  ? v1::DiscoverySpecification::SURROGATE_ALWAYS
        : options.surrogate == "never" ? v1::DiscoverySpecification::SURROGATE_NEVER
                                       : v1::DiscoverySpecification::SURROGATE_AUTOMATIC);
  }
  MORTISE_RETURN_IF_ERROR(AddBounds(options, specification, sources));
  MORTISE_RETURN_IF_ERROR(AddConstraints(options, specification, sources));
  MORTISE_RETURN_IF_ERROR(AddTolerances(options, specification, sources));
  if (options.deviations != 0) {
    specification.set_deviations(options.deviations);
    sources.Add("specification.deviations", "--deviations");
  }
  if (!options.start_from.empty()) {
    sources.AddEach("specification.start_from", "--start-from", options.start_from,
                    specification.start_from_size());
  }
  for (const std::string& front : options.start_from) {
    specification.add_start_from(ResourceName("fronts", front));
  }
  return specification;
}

absl::Status Export(v1::ParetoService::Stub& stub, const GatewayClient& client,
                    const std::string& front, v1::ExportFrontRequest::Format format,
                    const std::filesystem::path& path, const Output& output) {
  v1::ExportFrontRequest request;
  request.set_name(front);
  request.set_format(format);
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return Receive(*stub.ExportFront(&context, request), path).status();
  }));
  output.Line(absl::StrCat("  ", path.string()));
  return absl::OkStatus();
}

// The name of a choice's value, or a number.
std::string ParameterText(const v1::Front& front, int parameter, double value) {
  const int known = parameter < front.parameter_choices_size()
                        ? front.parameter_choices(parameter).names_size()
                        : 0;
  if (value >= 0 && value < known) {
    return front.parameter_choices(parameter).names(static_cast<int>(value));
  }
  return absl::StrFormat("%.4g", value);
}

// "width 0.4, height 0.72".
std::string DesignText(const v1::Front& front, const v1::EvaluationFailure& failure) {
  std::string text;
  const int known = std::min(front.parameter_names_size(), failure.parameters_size());
  for (int i = 0; i < known; ++i) {
    absl::StrAppend(&text, i == 0 ? "" : ", ", front.parameter_names(i), " ",
                    ParameterText(front, i, failure.parameters(i)));
  }
  return text;
}

void PrintFront(const v1::Front& front, const Output& output) {
  std::string beyond;
  if (front.violating_evaluations() > 0) {
    beyond = absl::StrCat(", ", front.violating_evaluations(), " beyond constraints");
  }
  output.Line(absl::StrFormat("%s: %d points in %d pieces, %d evaluations (%d failed%s), %s",
                              front.name(), front.point_count(), front.pieces(),
                              front.evaluations(), front.failed_evaluations(), beyond,
                              front.stop_reason()));
  const v1::FrontCombinations& combinations = front.combinations();
  if (combinations.possible() > 1) {
    output.Line(
        absl::StrFormat("  %d of %d combinations of choices and whole numbers tried, %d given up",
                        combinations.tried(), combinations.possible(), combinations.given_up()));
  }
  if (front.subject_evaluations() > front.evaluations()) {
    output.Line(absl::StrFormat(
        "  %d designs, %d evaluations: metrics are means over the "
        "tolerances, worse by %g deviations",
        front.evaluations(), front.subject_evaluations(), front.specification().deviations()));
  }
  for (const std::string& remark : front.remarks()) output.Line(absl::StrCat("  ", remark));
  for (const v1::EvaluationFailure& failure : front.failures()) {
    output.Line(absl::StrFormat("  %d failed with %s, such as at %s: %s", failure.count(),
                                failure.reason(), DesignText(front, failure), failure.message()));
  }
  if (front.surrogate_quality().predictions() > 0) {
    const v1::SurrogateQuality& quality = front.surrogate_quality();
    output.Line(absl::StrFormat(
        "  %d designs proposed by a surrogate: off by %.2g of the front's range in the median, "
        "%.0f %% within two of its deviations",
        quality.proposals(), quality.median_error(), 100 * quality.within_two_deviations()));
  }
  std::vector<std::string> titles(front.metric_names().begin(), front.metric_names().end());
  const bool robust = front.specification().tolerances_size() > 0;
  for (int i = 0; robust && i < front.metric_names_size(); ++i) {
    titles.push_back(absl::StrCat("deviation of ", front.metric_names(i)));
  }
  for (const auto& constraint : front.specification().constraints()) {
    titles.push_back(constraint.metric());
  }
  titles.insert(titles.end(), front.parameter_names().begin(), front.parameter_names().end());
  std::vector<std::vector<std::string>> rows;
  for (const v1::FrontPoint& point : front.points()) {
    std::vector<std::string>& row = rows.emplace_back();
    for (int i = 0; i < point.metrics_size(); ++i) {
      row.push_back(MetricText(MetricOf(front.metric_units(i), point.metrics(i))));
    }
    for (int i = 0; i < point.metric_deviations_size(); ++i) {
      row.push_back(MetricText(MetricOf(front.metric_units(i), point.metric_deviations(i))));
    }
    for (int i = 0; i < point.constraint_metrics_size(); ++i) {
      row.push_back(MetricText(MetricOf(front.constraint_units(i), point.constraint_metrics(i))));
    }
    for (int i = 0; i < point.parameters_size(); ++i) {
      row.push_back(ParameterText(front, i, point.parameters(i)));
    }
  }
  output.Table(titles, rows);
}

absl::StatusOr<v1::Front> GetFront(v1::ParetoService::Stub& stub, const GatewayClient& client,
                                   const std::string& name) {
  v1::GetFrontRequest request;
  request.set_name(name);
  v1::Front front;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub.GetFront(&context, request, &front));
  }));
  return front;
}

absl::Status Show(const std::string& name, const std::filesystem::path& out, Session& session,
                  Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::ParetoService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(const v1::Front front,
                           GetFront(*stub, *client, ResourceName("fronts", name)));
  PrintFront(front, output);
  if (!out.empty()) {
    using Request = v1::ExportFrontRequest;
    MORTISE_RETURN_IF_ERROR(
        Export(*stub, *client, front.name(), Request::CSV, out / "front.csv", output));
    MORTISE_RETURN_IF_ERROR(
        Export(*stub, *client, front.name(), Request::SVG, out / "front.svg", output));
    MORTISE_RETURN_IF_ERROR(
        Export(*stub, *client, front.name(), Request::PNG, out / "front.png", output));
  }
  output.DocumentOf(front);
  return absl::OkStatus();
}

absl::Status Run(const RunOptions& options, FieldSources& sources, Session& session,
                 Output& output) {
  v1::DiscoverFrontRequest request;
  request.set_request_id(NewIdentifier());
  MORTISE_ASSIGN_OR_RETURN(*request.mutable_specification(), Specification(options, sources));
  MORTISE_RETURN_IF_ERROR(AddTags(options.tags, &request));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::ParetoService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<v1::Front> front,
      RunTo<v1::Front>(
          *client, session.Work(options.detach),
          [&](grpc::ClientContext& context, v1::Operation* operation) {
            return rpc::FromGrpc(stub->DiscoverFront(&context, request, operation));
          },
          output));
  if (!front) return absl::OkStatus();
  return Show(front->name(), options.out, session, output);
}

}  // namespace

void AddParetoCommands(CLI::App& app, Session& session) {
  CLI::App* pareto = app.add_subcommand("pareto", "Trade-offs between metrics");
  pareto->require_subcommand(1);
  auto run_options = std::make_shared<RunOptions>();
  CommandFlags flags(*pareto->add_subcommand("run", "Discover the front of a template"));
  CLI::App* const run = &flags.command();
  run->add_option("subject", run_options->subject, "Template, or SPECIFICATION.json")->required();
  run->add_option("--minimize", run_options->minimize,
                  "Metric to make small; two to six, with those to make large");
  run->add_option("--maximize", run_options->maximize, "Metric to make large");
  AddMetricDefinitionFlags(flags, run_options->own);
  run->add_option("--fix", run_options->fix, "NAME=VALUE: keep a parameter; of a choice its name");
  run->add_option("--allow", run_options->allow, "NAME=CHOICE,CHOICE: leave a choice only some");
  run->add_option("--range", run_options->range, "NAME=LOW:HIGH: narrow a parameter");
  run->add_option("--constrain", run_options->constrain,
                  "METRIC=LOW:HIGH, METRIC=LOW: or METRIC=:HIGH: what designs must keep to");
  run->add_option("--start-from", run_options->start_from,
                  "Earlier front, whose designs are evaluated first");
  run->add_option(
      "--tolerance", run_options->tolerance,
      "NAME=VALUE: what is built may be off by so much either way; NAME=VALUE:normal: by "
      "such a standard deviation");
  run->add_option("--deviations", run_options->deviations,
                  "How many standard deviations over the tolerances make each metric worse");
  run->add_option("--evaluations", run_options->evaluations, "Budget of evaluations")
      ->check(CLI::PositiveNumber);
  run->add_option("--seed", run_options->seed, "Same seed, same front")->capture_default_str();
  run->add_option("--surrogate", run_options->surrogate,
                  "Whether a surrogate proposes designs: auto (as much as it earns), "
                  "always or never")
      ->check(CLI::IsMember({"auto", "always", "never"}));
  run->add_option("--out", run_options->out, "Folder for front.csv, front.svg and front.png");
  AddTagOptions(flags, run_options->tags);
  AddDetach(*run, run_options->detach)->excludes("--out");
  run->footer(
      "Example: mortise pareto run table --minimize mass --minimize max_displacement "
      "--fix length=1.4 --evaluations 150");
  flags.Run(session, [run_options](FieldSources& sources, Session& s, Output& o) {
    return Run(*run_options, sources, s, o);
  });

  auto name = std::make_shared<std::string>();
  auto out = std::make_shared<std::filesystem::path>();
  CLI::App* show = pareto->add_subcommand("show", "Print a front");
  show->add_option("front", *name, "Front, such as fronts/0198c1")->required();
  show->add_option("--out", *out, "Folder for front.csv, front.svg and front.png");
  show->footer("Example: mortise pareto show fronts/0198c1");
  show->callback([&session, name, out] {
    session.command = [name, out](Session& s, Output& o) { return Show(*name, *out, s, o); };
  });

  AddParetoDescribeCommand(*pareto, session);
  AddParetoExploreCommands(*pareto, session);
  AddParetoBenchmarkCommand(*pareto, session);
  // Last: commands would inherit it.
  pareto->footer("Example: mortise pareto run table --minimize mass --minimize max_displacement");
}

}  // namespace mortise::cli
