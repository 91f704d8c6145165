// mortise map optimize: the best design on a map, checked by its evaluator.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/map_calls.h"
#include "cli/files/map_points.h"
#include "cli/files/metric_evaluation.h"
#include "cli/output/map_output.h"
#include "common/base/errors.h"
#include "common/expressions/expression.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;

struct OptimizeOptions {
  std::string map;
  std::string minimize;
  std::string maximize;
  std::vector<std::string> limit;
  std::vector<std::string> fix;
  int starts = 0;
  std::int64_t seed = 1;
  bool unverified = false;
};

absl::StatusOr<v1::OptimizeMapRequest> RequestOf(const OptimizeOptions& options,
                                                 const v1::DesignMap& map) {
  if (options.minimize.empty() == options.maximize.empty()) {
    return InvalidField("--minimize", "say either what is to be least or, with --maximize, most");
  }
  v1::OptimizeMapRequest request;
  request.set_name(map.name());
  request.set_maximize(options.minimize.empty());
  request.set_objective(request.maximize() ? options.maximize : options.minimize);
  for (const std::string& text : options.limit) {
    MORTISE_ASSIGN_OR_RETURN(const NamedRange range, ParseRange(text, "--limit"));
    for (const v1::MapMetric& metric : map.metrics()) {
      if (metric.name() != range.name) continue;
      MORTISE_RETURN_IF_ERROR(
          CheckUnit(text.substr(text.find('=') + 1), metric.unit(), "--limit " + range.name));
    }
    v1::OptimizeMapRequest::Limit& limit = *request.add_limits();
    limit.set_metric(range.name);
    if (range.low) limit.set_minimum(*range.low);
    if (range.high) limit.set_maximum(*range.high);
  }
  for (const std::string& text : options.fix) {
    MORTISE_ASSIGN_OR_RETURN(*request.add_fixed(), ParseMapValue(map, text, "--fix"));
  }
  request.set_starts(options.starts);
  request.set_seed(options.seed);
  return request;
}

// The design as its evaluator sees it.
struct Verification {
  v1::EvaluationResult result;
  double objective = 0;
  // Which metrics miss their limits, and by how much, SI units.
  std::vector<std::pair<std::string, v1::Metric>> misses;
};

// Has the map's evaluator evaluate the design, by the settings that the map was made with.
absl::StatusOr<v1::EvaluationResult> Evaluated(const v1::DesignMap& map,
                                               const v1::OptimizeMapResponse& optimum,
                                               const GatewayClient& client) {
  const v1::MapSpecification& specification = map.specification();
  v1::EvaluateBatchRequest request;
  request.set_revision(specification.revision());
  *request.mutable_metrics() = optimum.metrics();
  if (specification.has_metric_definitions()) {
    *request.mutable_metric_definitions() = specification.metric_definitions();
  }
  if (specification.has_mesh()) *request.mutable_mesh() = specification.mesh();
  if (specification.has_airflow()) *request.mutable_airflow() = specification.airflow();
  MORTISE_ASSIGN_OR_RETURN(
      EvaluatedMetrics evaluated,
      EvaluateMetrics(specification.subject(), {optimum.design().begin(), optimum.design().end()},
                      request, client));
  return std::move(evaluated.result);
}

// The objective with the metrics as they were evaluated.
absl::StatusOr<double> ObjectiveOf(const v1::OptimizeMapRequest& request,
                                   const v1::OptimizeMapResponse& optimum,
                                   const v1::EvaluationResult& evaluated) {
  std::vector<std::string> names;
  Eigen::VectorXd values(optimum.design_size() + optimum.metrics_size());
  Eigen::Index last = 0;
  for (const v1::ParameterValue& parameter : optimum.design()) {
    names.push_back(parameter.name());
    values[last++] = parameter.value();
  }
  for (int k = 0; k < optimum.metrics_size(); ++k) {
    names.push_back(optimum.metrics(k));
    values[last++] = evaluated.metrics(k).value();
  }
  MORTISE_ASSIGN_OR_RETURN(const auto objective,
                           parametric::Expression::Parse(request.objective(), names));
  return objective.Value(values);
}

std::vector<std::pair<std::string, v1::Metric>> Misses(const v1::OptimizeMapRequest& request,
                                                       const v1::OptimizeMapResponse& optimum,
                                                       const v1::EvaluationResult& evaluated) {
  std::vector<std::pair<std::string, v1::Metric>> misses;
  for (const v1::OptimizeMapRequest::Limit& limit : request.limits()) {
    for (int k = 0; k < optimum.metrics_size(); ++k) {
      if (optimum.metrics(k) != limit.metric()) continue;
      const double value = evaluated.metrics(k).value();
      double missed = limit.has_minimum() ? limit.minimum() - value : 0;
      if (limit.has_maximum()) missed = std::max(missed, value - limit.maximum());
      if (missed > 0) misses.emplace_back(limit.metric(), MetricOf(optimum.units(k), missed));
    }
  }
  return misses;
}

absl::StatusOr<Verification> Verify(const v1::DesignMap& map, const v1::OptimizeMapRequest& request,
                                    const v1::OptimizeMapResponse& optimum,
                                    const GatewayClient& client) {
  Verification verification;
  MORTISE_ASSIGN_OR_RETURN(verification.result, Evaluated(map, optimum, client));
  if (verification.result.metrics_size() != optimum.metrics_size()) {
    return absl::DataLossError("the evaluator told other metrics than those that it was asked for");
  }
  MORTISE_ASSIGN_OR_RETURN(verification.objective,
                           ObjectiveOf(request, optimum, verification.result));
  verification.misses = Misses(request, optimum, verification.result);
  return verification;
}

void Print(const v1::DesignMap& map, const v1::OptimizeMapResponse& optimum,
           const std::optional<Verification>& verified, const Output& output) {
  std::vector<std::vector<std::string>> parameters;
  for (int k = 0; k < optimum.parameters_size(); ++k) {
    const v1::MapParameter& parameter = map.parameters(k);
    parameters.push_back({parameter.name(), ParameterText(parameter, optimum.parameters(k))});
  }
  output.Table({"parameter", "value"}, parameters);
  std::vector<std::string> titles = {"metric", "by the map", "may be off"};
  if (verified) titles.emplace_back("evaluated");
  std::vector<std::vector<std::string>> metrics;
  for (int k = 0; k < optimum.metrics_size(); ++k) {
    const std::string& unit = optimum.units(k);
    metrics.push_back({optimum.metrics(k), MetricText(MetricOf(unit, optimum.values(k))),
                       MetricText(MetricOf(unit, optimum.errors(k)))});
    if (verified) metrics.back().push_back(MetricText(verified->result.metrics(k)));
  }
  output.Table(titles, metrics);
  output.Line(absl::StrCat(absl::StrFormat("  objective %.6g by the map", optimum.objective()),
                           verified ? absl::StrFormat(", %.6g evaluated", verified->objective) : "",
                           absl::StrFormat("; %d of %d searches ended here",
                                           optimum.starts_that_agree(), optimum.starts())));
  PrintStale(map, output);
  if (optimum.violation() > 0) {
    output.Line(absl::StrFormat(
        "  no design of the map keeps to all limits: this one misses one by %.3g of its range",
        optimum.violation()));
  }
  if (!verified) return;
  for (const auto& [metric, missed] : verified->misses) {
    output.Line(absl::StrCat("  evaluated, the design misses the limit of ", metric, " by ",
                             MetricText(missed), ": the map is off there"));
  }
}

Json DocumentOf(const v1::DesignMap& map, const v1::OptimizeMapResponse& optimum,
                const std::optional<Verification>& verified) {
  Json document;
  for (int k = 0; k < optimum.parameters_size(); ++k) {
    document["parameters"][map.parameters(k).name()] = optimum.parameters(k);
  }
  for (int k = 0; k < optimum.metrics_size(); ++k) {
    document["metrics"][optimum.metrics(k)] = optimum.values(k);
    document["errors"][optimum.metrics(k)] = optimum.errors(k);
    if (verified) document["evaluated"][optimum.metrics(k)] = verified->result.metrics(k).value();
  }
  document["objective"] = optimum.objective();
  if (verified) document["evaluated_objective"] = verified->objective;
  document["violation"] = optimum.violation();
  document["stale"] = map.stale();
  if (!verified) return document;
  document["missed"] = Json::object();
  for (const auto& [metric, missed] : verified->misses) {
    document["missed"][metric] = missed.value();
  }
  return document;
}

absl::Status Optimize(const OptimizeOptions& options, FieldSources& sources, Session& session,
                      Output& output) {
  sources.Add("objective", options.minimize.empty() ? "--maximize" : "--minimize");
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap map, GetMap(*client, options.map));
  MORTISE_ASSIGN_OR_RETURN(const v1::OptimizeMapRequest request, RequestOf(options, map));
  const auto stub = v1::InterpolatorService::NewStub(client->channel());
  v1::OptimizeMapResponse optimum;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->OptimizeMap(&context, request, &optimum));
  }));
  std::optional<Verification> verified;
  if (!options.unverified) {
    absl::StatusOr<Verification> verification = Verify(map, request, optimum, *client);
    if (!verification.ok()) {
      // People see what the map found all the same; a document is of a success only.
      Print(map, optimum, std::nullopt, output);
      return verification.status();
    }
    verified = *std::move(verification);
  }
  Print(map, optimum, verified, output);
  output.Document(DocumentOf(map, optimum, verified));
  return absl::OkStatus();
}

}  // namespace

void AddMapOptimizeCommand(CLI::App& map, Session& session) {
  auto options = std::make_shared<OptimizeOptions>();
  CommandFlags flags(*map.add_subcommand(
      "optimize", "The best design on a map, within limits, checked by one evaluation"));
  flags.Add("map", options->map, "Map, such as maps/0198c1", "name")->required();
  CLI::Option* const minimize =
      flags.Add("--minimize", options->minimize,
                "What is to be least: an expression of metrics and parameters, in SI units");
  flags.Add("--maximize", options->maximize, "What is to be most, in its place")
      ->excludes(minimize);
  flags
      .Add("--limit", options->limit,
           "NAME=LOW:HIGH, NAME=LOW: or NAME=:HIGH: what a metric must keep to; again for more",
           "limits")
      ->allow_extra_args(false);
  flags
      .Add("--fix", options->fix, "NAME=VALUE: a parameter that keeps a value; again for more",
           "fixed")
      ->allow_extra_args(false);
  flags.Add("--starts", options->starts, "Places to search from; 16 if not given", "starts");
  flags.Add("--seed", options->seed, "Same seed, same design", "seed")->capture_default_str();
  flags.command().add_flag("--unverified", options->unverified,
                           "Do not have the design that was found evaluated");
  flags.command().footer(
      "Example: mortise map optimize maps/0198c1 --minimize mass --limit max_von_mises=:20MPa");
  flags.Run(session, [options](FieldSources& sources, Session& s, Output& o) {
    return Optimize(*options, sources, s, o);
  });
}

}  // namespace mortise::cli
