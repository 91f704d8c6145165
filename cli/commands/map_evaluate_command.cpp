// mortise map evaluate: metrics of designs from a map, at once.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/map_calls.h"
#include "cli/files/map_points.h"
#include "cli/output/map_output.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostBytes = std::size_t{64} << 20;
constexpr std::size_t kMostPoints = 100'000;   // of one call
constexpr std::size_t kMostNumbers = 500'000;  // of one call, either way

struct EvaluateOptions {
  std::string map;
  std::vector<std::string> at;
  std::filesystem::path file;
  std::vector<std::string> metrics;
  bool gradients = false;
  bool errors = false;
};

// Adds the answer to a part of the points, of which `before` were asked before.
void Append(const v1::EvaluateMapResponse& part, int before, v1::EvaluateMapResponse& whole) {
  *whole.mutable_metrics() = part.metrics();
  *whole.mutable_units() = part.units();
  whole.mutable_values()->MergeFrom(part.values());
  whole.mutable_errors()->MergeFrom(part.errors());
  whole.mutable_gradients()->MergeFrom(part.gradients());
  for (const int point : part.uncovered()) whole.add_uncovered(before + point);
}

// Evaluates all points, in as many calls as they take.
absl::StatusOr<v1::EvaluateMapResponse> EvaluateAll(const v1::DesignMap& map,
                                                    const EvaluateOptions& options,
                                                    const std::vector<double>& points,
                                                    const GatewayClient& client) {
  const auto stub = v1::InterpolatorService::NewStub(client.channel());
  const auto parameters = static_cast<std::size_t>(map.parameters_size());
  const auto metrics = static_cast<std::size_t>(map.metrics_size());
  // Values, errors and gradients.
  const std::size_t numbers =
      std::max(parameters, metrics * (2 + (options.gradients ? parameters : 0)));
  const std::size_t most = std::clamp<std::size_t>(kMostNumbers / numbers, 1, kMostPoints);
  v1::EvaluateMapResponse whole;
  for (std::size_t first = 0; first < points.size(); first += most * parameters) {
    v1::EvaluateMapRequest request;
    request.set_name(map.name());
    const std::size_t end = std::min(points.size(), first + most * parameters);
    request.mutable_points()->Add(points.begin() + static_cast<std::ptrdiff_t>(first),
                                  points.begin() + static_cast<std::ptrdiff_t>(end));
    *request.mutable_metrics() = {options.metrics.begin(), options.metrics.end()};
    request.set_gradients(options.gradients);
    v1::EvaluateMapResponse part;
    MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(stub->EvaluateMap(&context, request, &part));
    }));
    Append(part, static_cast<int>(first / parameters), whole);
  }
  return whole;
}

// An object for each point, of its metrics by their names; null where there are no values.
template <typename ValueOf>
Json ObjectsOf(const v1::EvaluateMapResponse& answer, std::size_t points, ValueOf value_of) {
  const std::set<int> uncovered(answer.uncovered().begin(), answer.uncovered().end());
  Json objects = Json::array();
  for (int point = 0; point < static_cast<int>(points); ++point) {
    Json object = Json::object();
    for (int k = 0; k < answer.metrics_size(); ++k) {
      object[answer.metrics(k)] =
          uncovered.count(point) > 0 ? Json(nullptr) : value_of(point * answer.metrics_size() + k);
    }
    objects.push_back(std::move(object));
  }
  return objects;
}

Json DocumentOf(const v1::DesignMap& map, const EvaluateOptions& options,
                const v1::EvaluateMapResponse& answer, std::size_t points) {
  Json document;
  document["points"] = ObjectsOf(answer, points, [&](int at) { return Json(answer.values(at)); });
  if (options.errors) {
    document["errors"] = ObjectsOf(answer, points, [&](int at) { return Json(answer.errors(at)); });
  }
  if (options.gradients) {
    document["gradients"] = ObjectsOf(answer, points, [&](int at) {
      Json gradient = Json::object();
      for (int k = 0; k < map.parameters_size(); ++k) {
        gradient[map.parameters(k).name()] = answer.gradients(at * map.parameters_size() + k);
      }
      return gradient;
    });
  }
  return document;
}

absl::Status Evaluate(const EvaluateOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap map, GetMap(*client, options.map));
  MORTISE_ASSIGN_OR_RETURN(std::vector<double> points, PointsAt(map, options.at));
  if (!options.file.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const std::string table, ReadFile(options.file, kMostBytes));
    MORTISE_ASSIGN_OR_RETURN(const std::vector<double> more,
                             ParseMapPoints(map, table, options.file.string()));
    points.insert(points.end(), more.begin(), more.end());
  }
  if (points.empty()) return InvalidField("--at", "say where, or give a table with --file");
  MORTISE_ASSIGN_OR_RETURN(const v1::EvaluateMapResponse answer,
                           EvaluateAll(map, options, points, *client));
  PrintPoints(map, points, answer, output);
  PrintStale(map, output);
  const std::size_t count = points.size() / static_cast<std::size_t>(map.parameters_size());
  output.Document(DocumentOf(map, options, answer, count));
  return absl::OkStatus();
}

}  // namespace

void AddMapEvaluateCommand(CLI::App& map, Session& session) {
  auto options = std::make_shared<EvaluateOptions>();
  CommandFlags flags(*map.add_subcommand("evaluate", "Metrics of designs, from a map, at once"));
  flags.Add("map", options->map, "Map, such as maps/0198c1", "name")->required();
  flags
      .Add("--at", options->at,
           "NAME=VALUE,NAME=VALUE: a value for all that the map varies; again for more designs",
           "points")
      ->allow_extra_args(false);
  flags.AlsoGives("--file", "points");
  flags.command().add_option("--file", options->file,
                             "Designs as a table (CSV) under the names of the parameters");
  flags.Add("--metric", options->metrics, "Only this; again for more", "metrics");
  flags.command().add_flag("--gradients", options->gradients,
                           "How the metrics change with each parameter");
  flags.command().add_flag("--errors", options->errors,
                           "With --json: also how far each value may be off, which is always in "
                           "the text");
  flags.command().footer(
      "Example: mortise map evaluate maps/0198c1 --at length=1.4,width=75cm --at "
      "length=1.2,width=0.8");
  flags.Run(session, [options](Session& s, Output& o) { return Evaluate(*options, s, o); });
}

}  // namespace mortise::cli
