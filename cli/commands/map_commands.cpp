// mortise map show|list|verify|delete, and what adds the others.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "absl/strings/str_cat.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/list_command.h"
#include "cli/commands/map_calls.h"
#include "cli/files/map_points.h"
#include "cli/output/map_output.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

struct VerifyOptions {
  std::string map;
  std::vector<std::string> at;
  int random = 0;
  std::int64_t seed = 1;
  bool detach = false;
};

absl::Status Show(const std::string& name, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap map, GetMap(*client, name));
  PrintMap(map, output);
  output.DocumentOf(map);
  return absl::OkStatus();
}

absl::Status Verify(const VerifyOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  v1::VerifyMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(ResourceName("maps", options.map));
  if (!options.at.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap map, GetMap(*client, options.map));
    MORTISE_ASSIGN_OR_RETURN(const std::vector<double> points, PointsAt(map, options.at));
    *request.mutable_points() = {points.begin(), points.end()};
  }
  request.set_random_points(options.random);
  request.set_seed(options.seed);
  const auto stub = v1::InterpolatorService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<v1::DesignMap> verified,
      RunTo<v1::DesignMap>(
          *client, session.Work(options.detach),
          [&](grpc::ClientContext& context, v1::Operation* operation) {
            return rpc::FromGrpc(stub->VerifyMap(&context, request, operation));
          },
          output));
  if (!verified) return absl::OkStatus();
  PrintVerification(*verified, output);
  PrintStale(*verified, output);
  output.DocumentOf(*verified);
  return absl::OkStatus();
}

absl::Status Delete(const std::string& name, Session& session, Output& output) {
  v1::DeleteMapRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(ResourceName("maps", name));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::InterpolatorService::NewStub(client->channel());
  v1::DeleteMapResponse response;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->DeleteMap(&context, request, &response));
  }));
  output.Line(absl::StrCat(request.name(), " deleted"));
  output.Document(nlohmann::ordered_json{{"name", request.name()}});
  return absl::OkStatus();
}

// Adds a command whose only argument is a map.
void AddOnMap(CLI::App& map, const std::string& name, const std::string& help,
              absl::Status (*run)(const std::string&, Session&, Output&), Session& session) {
  auto of = std::make_shared<std::string>();
  CommandFlags flags(*map.add_subcommand(name, help));
  flags.Add("map", *of, "Map, such as maps/0198c1", "name")->required();
  flags.command().footer(absl::StrCat("Example: mortise map ", name, " maps/0198c1"));
  flags.Run(session, [of, run](Session& s, Output& o) { return run(*of, s, o); });
}

void AddVerify(CLI::App& map, Session& session) {
  auto options = std::make_shared<VerifyOptions>();
  CommandFlags flags(*map.add_subcommand(
      "verify", "Have designs evaluated, to know how far a map is off, and keep that with it"));
  flags.Add("map", options->map, "Map, such as maps/0198c1", "name")->required();
  CLI::Option* const at =
      flags
          .Add("--at", options->at,
               "NAME=VALUE,NAME=VALUE: a value for all that the map varies; again for more designs",
               "points")
          ->allow_extra_args(false);
  flags
      .Add("--random", options->random, "How many random designs; 10 if not given", "random_points")
      ->excludes(at);
  flags.Add("--seed", options->seed, "Same seed, same designs", "seed")->capture_default_str();
  AddDetach(flags.command(), options->detach);
  flags.command().footer("Example: mortise map verify maps/0198c1 --random 20");
  flags.Run(session, [options](Session& s, Output& o) { return Verify(*options, s, o); });
}

}  // namespace

absl::StatusOr<v1::DesignMap> GetMap(const GatewayClient& client, const std::string& name) {
  const auto stub = v1::InterpolatorService::NewStub(client.channel());
  v1::GetMapRequest request;
  request.set_name(ResourceName("maps", name));
  v1::DesignMap map;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->GetMap(&context, request, &map));
  }));
  return map;
}

absl::StatusOr<std::vector<double>> PointsAt(const v1::DesignMap& map,
                                             const std::vector<std::string>& at) {
  std::vector<double> points;
  for (const std::string& text : at) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<double> point, ParseMapPoint(map, text, "--at"));
    points.insert(points.end(), point.begin(), point.end());
  }
  return points;
}

void AddMapCommands(CLI::App& app, Session& session) {
  CLI::App* const map =
      app.add_subcommand("map", "Design spaces sampled ahead, which answer at once");
  map->require_subcommand(1);
  AddMapBuildCommand(*map, session);
  AddMapEvaluateCommand(*map, session);
  AddMapExploreCommand(*map, session);
  AddMapShapeCommand(*map, session);
  AddMapOptimizeCommand(*map, session);
  AddListOf(*map->add_subcommand("list", "Maps, newest first"), "maps", session);
  AddOnMap(*map, "show", "What a map is of, and how good it is", Show, session);
  AddVerify(*map, session);
  AddOnMap(*map, "delete", "Remove a map", Delete, session);
  // Last: commands would inherit it.
  map->footer("Example: mortise map build table --metric mass --samples 60");
}

}  // namespace mortise::cli
