// mortise catalog import|list|show|evaluate|shape|place|delete: materials, items and templates.
#include <google/protobuf/text_format.h>
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "cli/client/catalog_list.h"
#include "cli/client/command_flags.h"
#include "cli/client/requests.h"
#include "cli/client/session.h"
#include "cli/commands/commands.h"
#include "cli/commands/delete_commands.h"
#include "cli/files/catalog_import.h"
#include "cli/files/shape_files.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {
namespace {

using Stub = v1::CatalogService::Stub;

struct EvaluateOptions {
  std::string subject;
  std::vector<std::string> parameters;
  std::filesystem::path step;
  std::filesystem::path glb;
  bool without_triangles = false;
  bool strict = false;
};

// Numbers as a person reads them; --json has all their digits.
class ShortNumbers : public google::protobuf::TextFormat::FastFieldValuePrinter {
 public:
  void PrintDouble(double value,
                   google::protobuf::TextFormat::BaseTextGenerator* generator) const override {
    generator->PrintString(absl::StrFormat("%.6g", value));
  }
};

std::string TextOf(const google::protobuf::Message& message) {
  google::protobuf::TextFormat::Printer printer;
  printer.SetDefaultFieldValuePrinter(new ShortNumbers);  // which it takes over
  std::string text;
  printer.PrintToString(message, &text);
  return text;
}

template <typename Message, typename Request, typename Method>
absl::Status ShowOne(const GatewayClient& client, const Request& request, Method method,
                     Output& output) {
  Message message;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(method(&context, request, &message));
  }));
  output.Line(TextOf(message));
  output.DocumentOf(message);
  return absl::OkStatus();
}

// A request for the resource, and for a revision of it where it is not the latest (0).
template <typename Request>
Request GetRequest(const std::string& name, std::int64_t revision) {
  Request request;
  request.set_name(name);
  request.set_revision(revision);
  return request;
}

absl::Status Show(const std::string& name, std::int64_t revision, Session& session,
                  Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::CatalogService::NewStub(client->channel());
  if (absl::StartsWith(name, "items/")) {
    return ShowOne<v1::Item>(
        *client, GetRequest<v1::GetItemRequest>(name, revision),
        [&](auto... a) { return stub->GetItem(a...); }, output);
  }
  if (absl::StartsWith(name, "materials/")) {
    return ShowOne<v1::Material>(
        *client, GetRequest<v1::GetMaterialRequest>(name, revision),
        [&](auto... a) { return stub->GetMaterial(a...); }, output);
  }
  return ShowOne<v1::Template>(
      *client, GetRequest<v1::GetTemplateRequest>(ResourceName("templates", name), revision),
      [&](auto... a) { return stub->GetTemplate(a...); }, output);
}

absl::Status ExportTo(const EvaluateOptions& options, v1::ExportDesignRequest::Format format,
                      const std::filesystem::path& path, Stub& stub, const GatewayClient& client,
                      const Output& output) {
  if (path.empty()) return absl::OkStatus();
  v1::ExportDesignRequest request;
  request.set_name(ResourceName("templates", options.subject));
  request.set_format(format);
  MORTISE_ASSIGN_OR_RETURN(const auto parameters, ParseParameters(options.parameters));
  request.mutable_parameters()->Assign(parameters.begin(), parameters.end());
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return Receive(*stub.ExportDesign(&context, request), path).status();
  }));
  output.Line(absl::StrCat("  ", path.string()));
  return absl::OkStatus();
}

// "18.620 kg", with how many parts it is not known of.
std::string MassText(const v1::EvaluatedDesign& design, int unweighed) {
  if (unweighed == 0) return absl::StrFormat("%.3f kg", design.mass());
  if (unweighed == design.parts_size()) return "mass not known, as parts have no material";
  return absl::StrFormat("%.3f kg without %d parts that have no material", design.mass(),
                         unweighed);
}

// Whether there is anything to say of it.
bool HasStructure(const v1::Structure& structure) {
  return structure.counts_size() + structure.choices_size() + structure.items_size() +
             structure.absent_parts_size() + structure.absent_conditions_size() +
             structure.absent_features_size() >
         0;
}

absl::Status Evaluate(const EvaluateOptions& options, Session& session, Output& output) {
  v1::EvaluateTemplateRequest request;
  request.set_name(ResourceName("templates", options.subject));
  MORTISE_ASSIGN_OR_RETURN(const auto parameters, ParseParameters(options.parameters));
  request.mutable_parameters()->Assign(parameters.begin(), parameters.end());
  // The table does not show them.
  request.set_without_triangles(options.without_triangles || !output.json());
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::CatalogService::NewStub(client->channel());
  v1::EvaluatedDesign design;
  const absl::Status evaluated = client->Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(stub->EvaluateTemplate(&context, request, &design));
  });
  if (absl::IsResourceExhausted(evaluated) && !request.without_triangles()) {
    return TooLarge(request.name(),
                    "4 MiB with all its triangles: use --without-triangles, or --step or --glb to "
                    "have them in a file");
  }
  MORTISE_RETURN_IF_ERROR(evaluated);
  std::vector<std::vector<std::string>> rows;
  int unweighed = 0;  // parts of nothing that has a density
  for (const v1::EvaluatedPart& part : design.parts()) {
    const std::string& made_of = part.item().empty() ? part.material() : part.item();
    rows.push_back({part.name(), made_of, Millimetres(part.size().x()),
                    Millimetres(part.size().y()), Millimetres(part.size().z()),
                    part.mass() > 0 ? absl::StrFormat("%.3f kg", part.mass()) : ""});
    if (part.mass() == 0) ++unweighed;
  }
  output.Table({"part", "item", "length", "width", "thickness", "mass"}, rows);
  for (const std::string& fault : design.faults()) output.Line(absl::StrCat("fault: ", fault));
  output.Line(absl::StrFormat("%d parts, %d pegs, %s", design.parts_size(),
                              design.connectors_size(), MassText(design, unweighed)));
  if (HasStructure(design.structure())) {
    output.Line(absl::StrCat("structure: ", design.structure().description()));
  }
  using Request = v1::ExportDesignRequest;
  MORTISE_RETURN_IF_ERROR(ExportTo(options, Request::STEP, options.step, *stub, *client, output));
  MORTISE_RETURN_IF_ERROR(ExportTo(options, Request::GLB, options.glb, *stub, *client, output));
  output.DocumentOf(design);
  return options.strict ? FaultsToStatus(design.template_(), design.faults()) : absl::OkStatus();
}

absl::Status AddShape(const std::filesystem::path& file, Session& session, Output& output) {
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::CatalogService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(const v1::Shape shape, ImportShapeFile(file, *stub, *client));
  output.Line(shape.name());
  output.Line(absl::StrCat(
      "  ", Millimetres(shape.size().x()), " x ", Millimetres(shape.size().y()), " x ",
      Millimetres(shape.size().z()), ", ", absl::StrFormat("%.4g", 1e6 * shape.volume()), " cm3, ",
      shape.triangle_count(), " triangles", shape.exact() ? ", exact surfaces" : ""));
  for (const std::string& note : shape.notes()) output.Line(absl::StrCat("  note: ", note));
  output.DocumentOf(shape);
  return absl::OkStatus();
}

}  // namespace

void AddCatalogCommands(CLI::App& app, Session& session) {
  CLI::App* catalog = app.add_subcommand("catalog", "Materials, items and templates");
  catalog->require_subcommand(1);

  auto files = std::make_shared<std::vector<std::filesystem::path>>();
  CLI::App* add = catalog->add_subcommand("import", "Add design files to the catalog, or none");
  add->add_option("files", *files, "Design files (.textproto, .json; items also .csv)")->required();
  add->footer("Example: mortise catalog import collection/items/bolts.csv");
  add->callback([&session, files] {
    session.command = [files](Session& s, Output& o) { return ImportFiles(*files, s, o); };
  });

  AddCatalogList(*catalog, session);

  auto name = std::make_shared<std::string>();
  auto revision = std::make_shared<std::int64_t>(0);
  CommandFlags show(*catalog->add_subcommand("show", "Print a template, item or material"));
  show.Add("name", *name, "Such as templates/table or items/dowel-8x35")->required();
  show.Add("--revision", *revision, "A revision of an item or template; else the latest",
           "revision");
  show.command().footer("Example: mortise catalog show items/hex-nut-m8 --revision 1");
  show.Run(session,
           [name, revision](Session& s, Output& o) { return Show(*name, *revision, s, o); });

  auto options = std::make_shared<EvaluateOptions>();
  CommandFlags evaluate(
      *catalog->add_subcommand("evaluate", "The parts of a template at parameters"));
  evaluate.Add("template", options->subject, "Template, such as table", "name")->required();
  evaluate.Add("--set", options->parameters, "NAME=VALUE, such as length=1500mm or armrests=both",
               "parameters");
  evaluate.Add("--step", options->step, "Also write a STEP file");
  evaluate.Add("--glb", options->glb, "Also write a GLB file");
  evaluate.command().add_flag("--without-triangles", options->without_triangles,
                              "With --json: leave out triangles, which may not fit into a message");
  evaluate.command().add_flag(
      "--strict", options->strict,
      "Fail if the design of an assembly has faults: contacts lost, parts in each other");
  evaluate.command().footer(
      "Example: mortise catalog evaluate table --set length=1500mm --glb table.glb");
  evaluate.Run(session, [options](Session& s, Output& o) { return Evaluate(*options, s, o); });
  auto shape = std::make_shared<std::filesystem::path>();
  CLI::App* add_shape = catalog->add_subcommand("shape", "Add the shape in a file to the catalog");
  add_shape->add_option("file", *shape, "STEP with one solid, or STL in millimetres")->required();
  add_shape->footer("Example: mortise catalog shape bracket.step");
  add_shape->callback([&session, shape] {
    session.command = [shape](Session& s, Output& o) { return AddShape(*shape, s, o); };
  });

  AddCatalogPlaceCommand(*catalog, session);
  AddCatalogDelete(*catalog, session);

  // Last: commands would inherit it.
  catalog->footer("Example: mortise catalog list items");
}

}  // namespace mortise::cli
