// mortise map explore: a map as a page that anybody can open.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/command_flags.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/map_calls.h"
#include "cli/explore/map_page.h"
#include "cli/output/map_output.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

struct ExploreOptions {
  std::string map;
  std::filesystem::path output = "map.html";
  int structure = -1;  // all of them
  std::vector<std::string> fields;
  bool without_shapes = false;
};

// Takes all that it takes to interpolate a structure.
absl::StatusOr<ExportedStructure> Export(const v1::ExportMapRequest& request,
                                         const GatewayClient& client) {
  const auto stub = v1::InterpolatorService::NewStub(client.channel());
  ExportedStructure structure;
  MORTISE_RETURN_IF_ERROR(client.Call(
      [&](grpc::ClientContext& context) {
        structure = {};
        structure.structure = request.structure();
        const auto reader = stub->ExportMap(&context, request);
        v1::MapExportPart part;
        while (reader->Read(&part)) AddPart(std::move(part), structure);
        return rpc::FromGrpc(reader->Finish());
      },
      /*seconds=*/600));
  return structure;
}

absl::StatusOr<std::vector<ExportedStructure>> ExportAll(const v1::DesignMap& map,
                                                         const ExploreOptions& options,
                                                         const GatewayClient& client,
                                                         Output& output) {
  v1::ExportMapRequest request;
  request.set_name(map.name());
  if (map.has_shapes() && !options.without_shapes) {
    request.set_geometry(v1::SURFACE);
    *request.mutable_fields() = {options.fields.begin(), options.fields.end()};
  }
  std::vector<ExportedStructure> structures;
  for (int s = 0; s < map.structures_size(); ++s) {
    if (options.structure >= 0 && s != options.structure) continue;
    output.Progress(s, map.structures_size(), "fetching");
    request.set_structure(s);
    MORTISE_ASSIGN_OR_RETURN(ExportedStructure structure, Export(request, client));
    structures.push_back(std::move(structure));
  }
  output.EndProgress();
  return structures;
}

// Fails where the map lacks what the flags ask for.
absl::Status CheckOptions(const v1::DesignMap& map, const ExploreOptions& options) {
  if (options.structure < -1 || options.structure >= map.structures_size()) {
    return InvalidField("--structure", absl::StrCat("is ", options.structure, "; ", map.name(),
                                                    " has ", map.structures_size(), ", from 0"));
  }
  if (options.fields.empty()) return absl::OkStatus();
  if (!map.has_shapes()) {
    return InvalidField("--field", absl::StrCat(map.name(), " has metrics alone"));
  }
  if (options.without_shapes) return InvalidField("--field", "lies on shapes, which are left out");
  for (const std::string& name : options.fields) {
    std::vector<std::string> known;
    bool found = false;
    for (const v1::MapShapes::Field& field : map.shapes().fields()) {
      if (field.of_elements()) continue;
      known.push_back(field.name());
      found = found || field.name() == name;
    }
    if (!found) {
      return InvalidField("--field",
                          absl::StrCat("'", name, "' is no field of nodes of the map, which has ",
                                       known.empty() ? "none" : absl::StrJoin(known, ", ")));
    }
  }
  return absl::OkStatus();
}

std::string Megabytes(std::size_t bytes) {
  return absl::StrFormat("%.1f MB", static_cast<double>(bytes) / 1e6);
}

absl::Status Explore(const ExploreOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap map, GetMap(*client, options.map));
  MORTISE_RETURN_IF_ERROR(CheckOptions(map, options));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<ExportedStructure> structures,
                           ExportAll(map, options, *client, output));
  MORTISE_ASSIGN_OR_RETURN(const std::string page, MapPage(map, structures));
  MORTISE_RETURN_IF_ERROR(WriteFile(options.output, page));
  std::size_t shapes = 0;
  for (const ExportedStructure& structure : structures) shapes += structure.samples.size();
  output.Line(absl::StrCat(options.output.string(), ": ", Megabytes(page.size()), ", ",
                           structures.size(), structures.size() == 1 ? " structure" : " structures",
                           shapes > 0 ? absl::StrCat(", ", shapes, " shapes") : "",
                           "; open it in a browser"));
  PrintStale(map, output);
  output.Document(nlohmann::ordered_json{{"file", options.output.string()},
                                         {"bytes", page.size()},
                                         {"structures", structures.size()},
                                         {"shapes", shapes}});
  return absl::OkStatus();
}

}  // namespace

void AddMapExploreCommand(CLI::App& map, Session& session) {
  auto options = std::make_shared<ExploreOptions>();
  CommandFlags flags(*map.add_subcommand(
      "explore", "Write a page with sliders that shows any design of a map at once, on its own"));
  flags.Add("map", options->map, "Map, such as maps/0198c1", "name")->required();
  flags.command().add_option("--output", options->output, "The page (HTML)")->capture_default_str();
  flags.Add("--structure", options->structure,
            "Only this combination of whole numbers and choices, by its place in `map show`, from "
            "0; all if not given",
            "structure");
  flags.Add("--field", options->fields,
            "Only this field on the shapes; again for more; all that the map has at nodes if not "
            "given",
            "fields");
  flags.command().add_flag("--metrics-only", options->without_shapes,
                           "Leave shapes out, for a small page");
  flags.command().footer("Example: mortise map explore maps/0198c1 --output table.html");
  flags.Run(session, [options](Session& s, Output& o) { return Explore(*options, s, o); });
}

}  // namespace mortise::cli
