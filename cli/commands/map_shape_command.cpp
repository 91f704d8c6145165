// mortise map shape: one design of a map, with its fields, as a file.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
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
#include "cli/files/map_shape_file.h"
#include "cli/output/map_output.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/rpc/status_mapping.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ShapeOptions {
  std::string map;
  std::string at;
  std::filesystem::path output;
  std::vector<std::string> fields;
  bool surface = false;
};

// Adds a part of a mesh to those before.
void AddPart(v1::MapMesh part, v1::MapMesh& mesh) {
  part.mutable_triangles()->insert(0, mesh.triangles());
  part.mutable_tetrahedra()->insert(0, mesh.tetrahedra());
  part.mutable_parts()->insert(0, mesh.parts());
  mesh = std::move(part);
}

// Follows the map to one point: so that large meshes come in as many messages as they take.
absl::StatusOr<v1::MapShape> Follow(const v1::FollowMapShapeRequest& begin,
                                    const std::vector<double>& point, const GatewayClient& client) {
  const auto stub = v1::InterpolatorService::NewStub(client.channel());
  v1::MapShape shape;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    const auto stream = stub->FollowMapShape(&context);
    v1::FollowMapShapeRequest to;
    to.mutable_to()->set_sequence(1);
    *to.mutable_to()->mutable_point() = {point.begin(), point.end()};
    stream->Write(begin);
    stream->Write(to);
    stream->WritesDone();
    v1::MapMesh mesh;
    for (v1::MapShape next; stream->Read(&next);) {
      AddPart(std::move(*next.mutable_new_mesh()), mesh);
      shape = std::move(next);
    }
    *shape.mutable_new_mesh() = std::move(mesh);
    return rpc::FromGrpc(stream->Finish());
  }));
  return shape;
}

void PrintShape(const v1::DesignMap& map, const v1::MapShape& shape, const std::string& file,
                const Output& output) {
  output.Line(absl::StrFormat("%s: %d nodes, off by %s at most, about", file,
                              shape.positions().size() / 12,
                              MetricText(MetricOf("m", shape.error()))));
  for (int i = 0; i < shape.metrics_size(); ++i) {
    std::string unit;
    for (const v1::MapMetric& metric : map.metrics()) {
      if (metric.name() == shape.metrics(i)) unit = metric.unit();
    }
    output.Line(absl::StrCat("  ", shape.metrics(i), " ",
                             MetricText(MetricOf(unit, shape.values(i))), " ± ",
                             MetricText(MetricOf(unit, shape.metric_errors(i)))));
  }
  output.Line(absl::StrCat("  surface ", MetricText(MetricOf("m^2", shape.surface_area()))));
  if (shape.has_centroid()) {
    output.Line(absl::StrCat("  volume ", MetricText(MetricOf("m^3", shape.volume()))));
  }
}

Json DocumentOf(const v1::MapShape& shape, const std::string& file) {
  Json document{{"file", file}, {"error", shape.error()}};
  document["metrics"] = Json::object();
  document["errors"] = Json::object();
  for (int i = 0; i < shape.metrics_size(); ++i) {
    document["metrics"][shape.metrics(i)] = shape.values(i);
    document["errors"][shape.metrics(i)] = shape.metric_errors(i);
  }
  document["surface_area"] = shape.surface_area();
  if (shape.has_centroid()) document["volume"] = shape.volume();
  return document;
}

absl::Status Write(const ShapeOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(const ShapeFormat format, ShapeFormatOf(options.output.string()));
  if (format == ShapeFormat::kStl && !options.fields.empty()) {
    return InvalidField("--field", "a .stl has no fields: write a .vtu");
  }
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  MORTISE_ASSIGN_OR_RETURN(const v1::DesignMap map, GetMap(*client, options.map));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<double> point, ParseMapPoint(map, options.at, "--at"));
  const bool is_surface = options.surface || format == ShapeFormat::kStl;
  v1::FollowMapShapeRequest request;
  v1::FollowMapShapeRequest::Begin& begin = *request.mutable_begin();
  begin.set_name(map.name());
  begin.set_geometry(is_surface ? v1::SURFACE : map.shapes().geometry());
  *begin.mutable_fields() = {options.fields.begin(), options.fields.end()};
  begin.set_without_fields(format == ShapeFormat::kStl);
  MORTISE_ASSIGN_OR_RETURN(const v1::MapShape shape, Follow(request, point, *client));
  if (shape.uncovered()) {
    return InvalidField(
        "--at", absl::StrCat("lies where ", WhyNoValues(map), ": the map has no shape there"));
  }
  if (shape.shapeless()) {
    return InvalidField("--at", absl::StrCat("lies where ", kWhyNoShape,
                                             ": the map has metrics there, and no shape"));
  }
  MORTISE_ASSIGN_OR_RETURN(const std::string bytes, WriteShapeFile(map, shape, format));
  MORTISE_RETURN_IF_ERROR(WriteFile(options.output, bytes));
  PrintShape(map, shape, options.output.string(), output);
  PrintStale(map, output);
  output.Document(DocumentOf(shape, options.output.string()));
  return absl::OkStatus();
}

}  // namespace

void AddMapShapeCommand(CLI::App& map, Session& session) {
  auto options = std::make_shared<ShapeOptions>();
  CommandFlags flags(
      *map.add_subcommand("shape", "A design's shape and fields, from a map, as a file"));
  flags.Add("map", options->map, "Map, such as maps/0198c1", "name")->required();
  flags
      .Add("--at", options->at, "NAME=VALUE,NAME=VALUE: a value for all that the map varies",
           "to.point")
      ->required();
  flags.command()
      .add_option("--output", options->output,
                  "File to write: .vtu with fields, for ParaView, or .stl, the surface alone")
      ->required();
  flags.Add("--field", options->fields, "Only this; again for more", "begin.fields");
  flags.command().add_flag("--surface", options->surface,
                           "The outside alone, where the map has tetrahedra");
  flags.command().footer(
      "Example: mortise map shape maps/0198c1 --at length=1.4,width=75cm --output table.vtu");
  flags.Run(session, [options](Session& s, Output& o) { return Write(*options, s, o); });
}

}  // namespace mortise::cli
