// mortise search, mortise index: templates by shape.
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/design_filter_options.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "common/base/identifiers.h"
#include "common/rpc/chunk_calls.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/retrieval.grpc.pb.h"

namespace mortise::cli {
namespace {

constexpr std::size_t kMaxInFile = std::size_t{64} << 20;  // bytes, as the service takes them
constexpr double kUploadSeconds = 600;
constexpr double kSeconds = 60;  // that a search may take
constexpr double kSecondsWithFits = 300;

struct SearchOptions {
  std::string mesh;
  std::string design;
  std::vector<std::string> parameters;
  std::vector<std::string> parts;
  std::string descriptor = "d2";
  std::string unit, up;
  int top = 10;
  std::vector<std::string> templates;
  DesignFilterOptions filter;
  std::filesystem::path sheet;
  bool fit = false;
};

struct IndexOptions {
  std::string name;  // "d2", of what is shown or deleted
  bool only_faults = false;
  std::vector<std::string> templates;
  std::vector<std::string> descriptors;
  std::string delta;
  bool anew = false;
  bool detach = false;
};

absl::StatusOr<v1::ShapeDescriptor> DescriptorOf(const std::string& name) {
  if (name == "d2") return v1::D2;
  if (name == "voxel") return v1::VOXEL;
  if (name == "light-field") return v1::LIGHT_FIELD;
  return InvalidField("--descriptor",
                      absl::StrCat("'", name, "' is none of d2, voxel, light-field"));
}

absl::StatusOr<v1::SearchShapesRequest> RequestOf(SearchOptions& options) {
  if (options.mesh.empty() == options.design.empty()) {
    return InvalidField("MESH", "give a file with a mesh, or a template with --design");
  }
  v1::SearchShapesRequest request;
  MORTISE_ASSIGN_OR_RETURN(const v1::ShapeDescriptor descriptor, DescriptorOf(options.descriptor));
  request.set_shape_descriptor(descriptor);
  request.set_limit(options.top);
  request.set_with_sheet(!options.sheet.empty());
  request.set_fit(options.fit);
  for (const std::string& name : options.templates) {
    request.add_templates(ResourceName("templates", name));
  }
  MORTISE_RETURN_IF_ERROR(options.filter.Fill(&request));
  if (options.design.empty()) {
    v1::QueryMesh& mesh = *request.mutable_mesh();
    MORTISE_ASSIGN_OR_RETURN(*mesh.mutable_file(), ReadFile(options.mesh, kMaxInFile));
    if (mesh.file().empty()) return InvalidField(options.mesh, "is empty");
    mesh.set_file_name(std::filesystem::path(options.mesh).filename().string());
    mesh.set_length_unit(options.unit);
    MORTISE_ASSIGN_OR_RETURN(const v1::Axis up, ParseAxis(options.up, "--up"));
    mesh.set_up(up);
    return request;
  }
  v1::QueryDesign& design = *request.mutable_design();
  design.set_template_(ResourceName("templates", options.design));
  MORTISE_ASSIGN_OR_RETURN(const auto parameters, ParseParameters(options.parameters));
  design.mutable_parameters()->Assign(parameters.begin(), parameters.end());
  design.mutable_parts()->Assign(options.parts.begin(), options.parts.end());
  return request;
}

std::string TextOf(const google::protobuf::RepeatedPtrField<v1::ParameterValue>& parameters) {
  std::string text;
  for (const v1::ParameterValue& parameter : parameters) {
    absl::StrAppend(&text, text.empty() ? "" : " ", parameter.name(), "=",
                    parameter.choice().empty() ? absl::StrFormat("%.4g", parameter.value())
                                               : parameter.choice());
  }
  return text;
}

// How far a fitted design is off, and what of it the query lacks.
std::string RemainderOf(const v1::ShapeFit& fit) {
  if (!fit.fault().empty()) return absl::StrCat("no fit: ", fit.fault());
  std::string text =
      absl::StrFormat("%.3g mm, beyond %.3g mm", 1000 * fit.remaining(), 1000 * fit.beyond());
  if (!fit.converged()) absl::StrAppend(&text, ", not converged");
  if (fit.scale_is_free()) absl::StrAppendFormat(&text, ", scale %.4g", fit.scale());
  return text;
}

// Brings a file that is too large for a message to the service, and names it instead.
absl::Status Upload(v1::QueryMesh& mesh, v1::RetrievalService::Stub& stub,
                    const GatewayClient& client) {
  v1::UploadMeshResponse response;
  MORTISE_RETURN_IF_ERROR(client.Call(
      [&](grpc::ClientContext& context) {
        const auto writer = stub.UploadMesh(&context, &response);
        rpc::SendChunks(mesh.file(), *writer);
        return rpc::FromGrpc(writer->Finish());
      },
      kUploadSeconds));
  mesh.clear_file();
  mesh.set_upload(response.sha256());
  return absl::OkStatus();
}

absl::Status TookTooLong(double seconds) {
  return absl::DeadlineExceededError(
      absl::StrFormat("there was no answer within %.0f s: look for fewer matches with --top, or "
                      "among fewer templates with --template",
                      seconds));
}

absl::Status Search(SearchOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(v1::SearchShapesRequest request, RequestOf(options));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::RetrievalService::NewStub(client->channel());
  if (request.mesh().file().size() > kMaxInMessage) {
    MORTISE_RETURN_IF_ERROR(Upload(*request.mutable_mesh(), *stub, *client));
  }
  v1::SearchShapesResponse found;
  const double seconds = options.fit ? kSecondsWithFits : kSeconds;
  const absl::Status searched = client->Call(
      [&](grpc::ClientContext& context) {
        return rpc::FromGrpc(stub->SearchShapes(&context, request, &found));
      },
      seconds);
  if (absl::IsDeadlineExceeded(searched)) return TookTooLong(seconds);
  MORTISE_RETURN_IF_ERROR(searched);
  if (!options.sheet.empty()) {
    MORTISE_RETURN_IF_ERROR(WriteFile(options.sheet, found.sheet()));
    found.clear_sheet();
  }
  std::vector<std::vector<std::string>> rows;
  for (const v1::ShapeMatch& match : found.matches()) {
    const std::string part = match.group().empty() ? "" : absl::StrCat(", ", match.group());
    rows.push_back(
        {absl::StrCat(match.template_(), part), absl::StrFormat("%.4g", match.distance()),
         match.turn() == 0 ? "" : absl::StrCat(match.turn(), "°"), TextOf(match.parameters())});
    if (!options.fit) continue;
    const v1::ShapeFit& fit = match.fit();
    rows.push_back({"  fitted", RemainderOf(fit),
                    fit.fault().empty() ? absl::StrFormat("%.3g°", fit.turn()) : "",
                    TextOf(fit.parameters())});
  }
  output.Table({"template", "distance", "turned", "parameters"}, rows);
  for (const std::string& note : found.notes()) output.Line(note);
  if (!options.sheet.empty()) output.Line(absl::StrCat("  ", options.sheet.string()));
  output.DocumentOf(found);
  return absl::OkStatus();
}

std::vector<std::string> RowOf(const v1::ShapeIndex& index) {
  return {index.name(), absl::StrCat(index.family_count()), absl::StrFormat("%.3g", index.delta()),
          index.current() ? "yes" : "no", index.fault().empty() ? "yes" : "no"};
}

void PrintIndexes(const google::protobuf::RepeatedPtrField<v1::ShapeIndex>& indexes,
                  Output& output) {
  std::vector<std::vector<std::string>> rows;
  for (const v1::ShapeIndex& index : indexes) rows.push_back(RowOf(index));
  output.Table({"index", "families", "delta", "current", "usable"}, rows);
  for (const v1::ShapeIndex& index : indexes) {
    if (!index.fault().empty()) output.Line(absl::StrCat(index.name(), ": ", index.fault()));
  }
}

absl::Status Build(const IndexOptions& options, Session& session, Output& output) {
  v1::BuildIndexRequest request;
  request.set_request_id(NewIdentifier());
  request.set_anew(options.anew);
  for (const std::string& name : options.descriptors) {
    MORTISE_ASSIGN_OR_RETURN(const v1::ShapeDescriptor descriptor, DescriptorOf(name));
    request.add_shape_descriptors(descriptor);
  }
  for (const std::string& name : options.templates) {
    request.add_templates(ResourceName("templates", name));
  }
  if (!options.delta.empty()) {
    MORTISE_ASSIGN_OR_RETURN(const double delta, ParseQuantity(options.delta, "--delta"));
    request.set_delta(delta);
  }
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::RetrievalService::NewStub(client->channel());
  LongWork work = session.Work(options.detach);
  work.what_stays = "what it covered is kept, and the next build goes on from there";
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<v1::BuildIndexResponse> built,
      RunTo<v1::BuildIndexResponse>(
          *client, work,
          [&](grpc::ClientContext& context, v1::Operation* operation) {
            return rpc::FromGrpc(stub->BuildIndex(&context, request, operation));
          },
          output));
  if (!built) return absl::OkStatus();
  PrintIndexes(built->indexes(), output);
  for (const std::string& note : built->notes()) output.Line(note);
  output.DocumentOf(*built);
  return absl::OkStatus();
}

absl::Status ShowStatus(Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::RetrievalService::NewStub(client->channel());
  v1::ListIndexesResponse listed;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->ListIndexes(&context, {}, &listed));
  }));
  PrintIndexes(listed.indexes(), output);
  if (listed.indexes().empty()) output.Line("no index yet: mortise index build");
  output.DocumentOf(listed);
  return absl::OkStatus();
}

// What an index has of a template, or why not.
std::vector<std::string> RowOf(const v1::ShapeIndex::Family& family) {
  const std::string part = family.group().empty() ? "" : absl::StrCat(", ", family.group());
  return {absl::StrCat(family.template_(), part), absl::StrCat(family.template_revision()),
          absl::StrCat(family.points() + family.tangents()), absl::StrCat(family.evaluations()),
          family.fault().empty() ? (family.truncated() ? "covered in part" : "") : family.fault()};
}

absl::Status ShowIndex(const IndexOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::RetrievalService::NewStub(client->channel());
  v1::ListIndexFamiliesRequest request;
  request.set_name(ResourceName("indexes", options.name));
  request.set_page_size(1000);
  request.set_only_faults(options.only_faults);
  v1::ListIndexFamiliesResponse all;
  do {
    v1::ListIndexFamiliesResponse page;
    MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(stub->ListIndexFamilies(&context, request, &page));
    }));
    request.set_page_token(page.next_page_token());
    all.mutable_families()->MergeFrom(page.families());
  } while (!request.page_token().empty());
  std::vector<std::vector<std::string>> rows;
  for (const v1::ShapeIndex::Family& family : all.families()) rows.push_back(RowOf(family));
  output.Table({"template", "revision", "primitives", "designs made", "fault"}, rows);
  output.DocumentOf(all);
  return absl::OkStatus();
}

absl::Status DeleteIndex(const IndexOptions& options, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::RetrievalService::NewStub(client->channel());
  v1::DeleteIndexRequest request;
  request.set_request_id(NewIdentifier());
  request.set_name(ResourceName("indexes", options.name));
  v1::DeleteIndexResponse response;
  MORTISE_RETURN_IF_ERROR(client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->DeleteIndex(&context, request, &response));
  }));
  output.Line(absl::StrCat(request.name(), " deleted; 'mortise index build' makes it again"));
  output.Document(nlohmann::ordered_json{{"name", request.name()}});
  return absl::OkStatus();
}

void AddSearch(CLI::App& app, Session& session) {
  auto options = std::make_shared<SearchOptions>();
  CommandFlags flags(*app.add_subcommand("search", "Find the templates that can become a shape"));
  flags.Add("mesh", options->mesh, "File with a mesh: OBJ, OFF, PLY, STL, GLB or glTF");
  CLI::Option* const design =
      flags.Add("--design", options->design, "A template whose design is looked for instead",
                "design.template");
  flags
      .Add("--set", options->parameters,
           "NAME=VALUE of that design, such as length=1500mm or armrests=both", "design.parameters")
      ->needs(design)
      ->allow_extra_args(false);
  flags.Add("--part", options->parts, "Only this part of the design; may be repeated")
      ->needs(design)
      ->allow_extra_args(false);
  flags.AlsoGives("--part", "design.parts");
  flags.Add("--descriptor", options->descriptor, "d2, voxel or light-field", "shape_descriptor")
      ->capture_default_str();
  flags
      .Add("--unit", options->unit, "Unit of the mesh: m, cm, mm, um, in or ft", "mesh.length_unit")
      ->excludes(design);
  flags.Add("--up", options->up, "Axis of the mesh that points upwards: x, y or z", "mesh.up")
      ->excludes(design);
  flags.Add("--top", options->top, "How many matches", "limit")->capture_default_str();
  flags.Add("--template", options->templates, "Only this template; may be repeated", "templates")
      ->allow_extra_args(false);
  flags.command().add_flag(
      "--fit", options->fit,
      "Fit the parameters of each match to the mesh: about a second each, up to "
      "minutes where designs are solids");
  options->filter.AddTo(flags);
  flags.Add("--sheet", options->sheet, "PNG file for a picture of the matches");
  flags.command().footer("Example: mortise search chair.obj --top 5 --sheet out.png");
  flags.Run(session, [options](FieldSources& sources, Session& s, Output& output) {
    sources.Add("mesh", options->mesh);
    const absl::Status status = Search(*options, s, output);
    options->filter.AddItemSources(sources);
    return status;
  });
}

void AddIndex(CLI::App& app, Session& session) {
  CLI::App* index = app.add_subcommand("index", "What searches by shape stand on");
  index->require_subcommand(1);
  auto options = std::make_shared<IndexOptions>();
  CommandFlags build(
      *index->add_subcommand("build", "Bring indexes up to the templates there are"));
  build.Add("template", options->templates, "Only these templates; all if none is named",
            "templates");
  build.Add("--descriptor", options->descriptors,
            "Only this one: d2, voxel or light-field; may be repeated");
  build.AlsoGives("--descriptor", "shape_descriptors");
  build.Add("--delta", options->delta,
            "How far a design may be from its cover, in the descriptor's distance", "delta");
  build.command().add_flag("--anew", options->anew, "Cover again what is covered");
  AddDetach(build.command(), options->detach);
  build.command().footer("Example: mortise index build --descriptor d2");
  build.Run(session, [options](Session& s, Output& output) { return Build(*options, s, output); });
  CLI::App* status = index->add_subcommand("status", "The indexes there are");
  status->footer("Example: mortise index status");
  status->callback([&session] { session.command = ShowStatus; });
  CommandFlags show(*index->add_subcommand("show", "The templates that an index has"));
  show.Add("index", options->name, "d2, voxel or light-field", "name")->required();
  show.command().add_flag("--faults", options->only_faults,
                          "Only those that could not be covered, and why");
  show.command().footer("Example: mortise index show d2 --faults");
  show.Run(session, [options](Session& s, Output& o) { return ShowIndex(*options, s, o); });
  CommandFlags remove(*index->add_subcommand("delete", "Remove an index, and stop keeping it up"));
  remove.Add("index", options->name, "d2, voxel or light-field", "name")->required();
  remove.command().footer("Example: mortise index delete voxel");
  remove.Run(session, [options](Session& s, Output& o) { return DeleteIndex(*options, s, o); });
  index->footer("Example: mortise index build");
}

}  // namespace

void AddRetrievalCommands(CLI::App& app, Session& session) {
  AddSearch(app, session);
  AddIndex(app, session);
}

}  // namespace mortise::cli
