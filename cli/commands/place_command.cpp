// mortise catalog place.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/tag_options.h"
#include "cli/commands/commands.h"
#include "cli/files/assignment.h"
#include "cli/files/ground_file.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/mesh/length_unit.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {
namespace {

struct PlaceOptions {
  std::string subject;
  std::int64_t revision = 0;  // 0: the latest
  std::vector<std::string> height_fields;
  std::string datum;
  std::string title;
  std::string unit = "m";
  std::string origin;
  TagOptions tags;
};

// "451230.5,5411872", in metres or with a unit each.
absl::StatusOr<Eigen::Vector2d> ParseOrigin(const std::string& text) {
  const std::vector<std::string> halves = absl::StrSplit(text, ',');
  if (halves.size() != 2) return InvalidField("--origin", "is not of the form X,Y");
  MORTISE_ASSIGN_OR_RETURN(const double x, ParseLength(halves[0], "--origin"));
  MORTISE_ASSIGN_OR_RETURN(const double y, ParseLength(halves[1], "--origin"));
  return Eigen::Vector2d(x, y);
}

absl::StatusOr<GroundUnits> UnitsOf(const PlaceOptions& options) {
  GroundUnits units;
  MORTISE_ASSIGN_OR_RETURN(units.unit, mesh::MetresOf(options.unit, "--unit"));
  if (!options.origin.empty()) {
    MORTISE_ASSIGN_OR_RETURN(units.origin, ParseOrigin(options.origin));
  }
  return units;
}

absl::StatusOr<v1::PlaceTemplateRequest> RequestOf(const PlaceOptions& options) {
  v1::PlaceTemplateRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(ResourceName("templates", options.subject));
  request.set_revision(options.revision);
  MORTISE_ASSIGN_OR_RETURN(const GroundUnits units, UnitsOf(options));
  for (const std::string& text : options.height_fields) {
    MORTISE_ASSIGN_OR_RETURN(const auto assigned, SplitAssignment(text, "--height-field"));
    MORTISE_ASSIGN_OR_RETURN(v1::HeightField field, ReadGround(assigned.second, units));
    field.set_name(assigned.first);
    if (!options.title.empty()) field.set_title(options.title);
    if (field.title().empty()) field.set_title(std::filesystem::path(assigned.second).stem());
    if (!options.datum.empty()) {
      MORTISE_ASSIGN_OR_RETURN(const double datum, ParseLength(options.datum, "--datum"));
      field.set_datum(datum);
    }
    *request.add_height_fields() = std::move(field);
  }
  MORTISE_RETURN_IF_ERROR(AddTags(options.tags, &request));
  return request;
}

absl::Status Place(const PlaceOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(const v1::PlaceTemplateRequest request, RequestOf(options));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::CatalogService::NewStub(client->channel());
  v1::Template placed;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->PlaceTemplate(&context, request, &placed));
  }));
  output.Line(placed.name());
  output.Line(absl::StrCat("  ", placed.title(), ", revision ", placed.revision(), ", of ",
                           placed.placed_template(), " revision ",
                           placed.placed_template_revision()));
  output.DocumentOf(placed);
  return absl::OkStatus();
}

}  // namespace

void AddCatalogPlaceCommand(CLI::App& catalog, Session& session) {
  const auto options = std::make_shared<PlaceOptions>();
  CommandFlags flags(*catalog.add_subcommand("place", "Put a template on ground of your own"));
  flags.Add("template", options->subject, "Template, such as deck", "name")->required();
  flags
      .Add(
          "--height-field", options->height_fields,
          "NAME=FILE: points on a grid (.csv), an ESRI ASCII grid (.asc), a mesh (.obj, .stl) or a "
          "HeightField (.textproto)",
          "height_fields")
      ->required();
  flags.Add("--datum", options->datum, "Height that becomes 0, such as 312.4m");
  flags.Add("--origin", options->origin, "X,Y of the files that become the design's origin");
  flags.Add("--unit", options->unit, "Unit of the files: m, cm, mm, um, in or ft");
  flags.Add("--title", options->title, "What the ground is called; else as its file");
  flags.Add("--revision", options->revision, "A revision of the template; else the latest",
            "revision");
  AddTagOptions(flags, options->tags);
  flags.command().footer(
      "Example: mortise catalog place deck --height-field ground=bank.csv --datum 312.4m");
  flags.Run(session, [options](Session& s, Output& o) { return Place(*options, s, o); });
}

}  // namespace mortise::cli
