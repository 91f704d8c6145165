// mortise catalog import|list|show|evaluate|shape: materials, items and templates.
#include <google/protobuf/text_format.h>
#include <grpcpp/grpcpp.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_replace.h"
#include "cli/catalog_import.h"
#include "cli/delete_commands.h"
#include "cli/field_sources.h"
#include "cli/requests.h"
#include "cli/session.h"
#include "cli/shape_files.h"
#include "common/base/errors.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {
namespace {

using Stub = v1::CatalogService::Stub;

struct ListOptions {
  std::string what;
  std::string kind;
  std::string material;
  std::string text;
};

struct EvaluateOptions {
  std::string subject;
  std::vector<std::string> parameters;
  std::filesystem::path step;
  std::filesystem::path glb;
  bool without_triangles = false;
};

std::string KindNames() {
  std::string names;
  const google::protobuf::EnumDescriptor& kinds = *v1::ItemKind_descriptor();
  for (int i = 1; i < kinds.value_count(); ++i) {
    absl::StrAppend(&names, i == 1 ? "" : ", ", kinds.value(i)->name());
  }
  return names;
}

// "drawer-slide" or "DRAWER_SLIDE".
absl::StatusOr<v1::ItemKind> ParseKind(const std::string& text) {
  v1::ItemKind kind = v1::ITEM_KIND_UNSPECIFIED;
  if (text.empty()) return kind;
  const std::string name = absl::StrReplaceAll(absl::AsciiStrToUpper(text), {{"-", "_"}});
  if (!v1::ItemKind_Parse(name, &kind) || kind == v1::ITEM_KIND_UNSPECIFIED) {
    return InvalidField("kind", absl::StrCat("'", text, "' is none of ", KindNames()));
  }
  return kind;
}

FieldSources SourcesOf(const ListOptions&) {
  FieldSources sources;
  sources.Add("kind", "--kind");
  sources.Add("material", "--material");
  sources.Add("text", "--text");
  return sources;
}

FieldSources SourcesOf(const EvaluateOptions& options) {
  FieldSources sources;
  sources.Add("name", "template");
  sources.AddEach("parameters", "--set", options.parameters);
  return sources;
}

absl::StatusOr<v1::ListItemsRequest> ItemsRequest(const ListOptions& options) {
  v1::ListItemsRequest request;
  MORTISE_ASSIGN_OR_RETURN(const v1::ItemKind kind, ParseKind(options.kind));
  request.set_kind(kind);
  if (!options.material.empty()) {
    request.set_material(ResourceName("materials", options.material));
  }
  request.set_text(options.text);
  return request;
}

// "BOLT, 0.31 EUR", or "0.31 EUR (example)" where the price is one.
std::string DetailsOf(const v1::Item& item) {
  return absl::StrFormat("%s, %.2f %s%s%s", v1::ItemKind_Name(item.kind()), item.price().amount(),
                         item.price().currency(),
                         item.price_basis() == v1::PER_VOLUME ? " per m³" : "",
                         item.price_is_example() ? " (example)" : "");
}

// What a template is made of.
std::string KindOf(const v1::Template& message) {
  switch (message.kind_case()) {
    case v1::Template::kAssembly:
      return "assembly";
    case v1::Template::kCad:
      return "features";
    case v1::Template::kCage:
      return "cage";
    case v1::Template::KIND_NOT_SET:
      break;
  }
  return "parts";
}

absl::Status List(const ListOptions& options, Session& session, Output& output) {
  const bool filtered = !options.kind.empty() || !options.material.empty() || !options.text.empty();
  const std::string what = !options.what.empty() ? options.what : filtered ? "items" : "templates";
  if (filtered && what != "items") {
    return InvalidField("what", "only items are told apart by kind, material and text");
  }
  MORTISE_ASSIGN_OR_RETURN(const v1::ListItemsRequest items_request, ItemsRequest(options));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::CatalogService::NewStub(client->channel());
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const auto& message, std::string details) {
    rows.push_back({message.name(), message.title(), std::move(details)});
    if (!output.text()) document.push_back(ToJson(message));
  };
  absl::Status status;
  if (what == "materials") {
    status = ListAll<v1::ListMaterialsRequest, v1::ListMaterialsResponse>(
        *client, [&](auto... a) { return stub->ListMaterials(a...); },
        [&](const v1::ListMaterialsResponse& page) {
          for (const auto& m : page.materials()) add(m, absl::StrFormat("%g kg/m³", m.density()));
        });
  } else if (what == "items") {
    const auto list_items = [&](grpc::ClientContext* context, const v1::ListItemsRequest& page,
                                v1::ListItemsResponse* response) {
      v1::ListItemsRequest request = items_request;
      request.MergeFrom(page);
      return stub->ListItems(context, request, response);
    };
    status = ListAll<v1::ListItemsRequest, v1::ListItemsResponse>(
        *client, list_items, [&](const v1::ListItemsResponse& page) {
          for (const auto& item : page.items()) add(item, DetailsOf(item));
        });
  } else {
    status = ListAll<v1::ListTemplatesRequest, v1::ListTemplatesResponse>(
        *client, [&](auto... a) { return stub->ListTemplates(a...); },
        [&](const v1::ListTemplatesResponse& page) {
          for (const auto& t : page.templates()) {
            add(t, absl::StrCat(KindOf(t), ", revision ", t.revision()));
          }
        });
  }
  MORTISE_RETURN_IF_ERROR(status);
  output.Table({"name", "title", "details"}, rows);
  output.Document(document);
  return absl::OkStatus();
}

template <typename Message, typename Request, typename Method>
absl::Status ShowOne(const GatewayClient& client, const Request& request, Method method,
                     Output& output) {
  Message message;
  MORTISE_RETURN_IF_ERROR(client.Call([&](grpc::ClientContext& context) {
    return rpc::FromGrpc(method(&context, request, &message));
  }));
  std::string text;
  google::protobuf::TextFormat::PrintToString(message, &text);
  output.Line(text);
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
  for (const v1::EvaluatedPart& part : design.parts()) {
    const std::string& made_of = part.item().empty() ? part.material() : part.item();
    rows.push_back({part.name(), made_of, Millimetres(part.size().x()),
                    Millimetres(part.size().y()), Millimetres(part.size().z()),
                    absl::StrFormat("%.3f kg", part.mass())});
  }
  output.Table({"part", "item", "length", "width", "thickness", "mass"}, rows);
  output.Line(absl::StrFormat("%d parts, %d pegs, %.3f kg", design.parts_size(),
                              design.connectors_size(), design.mass()));
  using Request = v1::ExportDesignRequest;
  MORTISE_RETURN_IF_ERROR(ExportTo(options, Request::STEP, options.step, *stub, *client, output));
  MORTISE_RETURN_IF_ERROR(ExportTo(options, Request::GLB, options.glb, *stub, *client, output));
  output.DocumentOf(design);
  return absl::OkStatus();
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

  auto filter = std::make_shared<ListOptions>();
  CLI::App* list = catalog->add_subcommand("list", "List templates, items or materials");
  list->add_option("what", filter->what,
                   "templates (also if nothing is said), items (also with a filter) or materials")
      ->check(CLI::IsMember({"templates", "items", "materials"}));
  list->add_option("--kind", filter->kind, "Only items of this kind, such as bolt");
  list->add_option("--material", filter->material, "Only items of this material, such as steel");
  list->add_option("--text", filter->text,
                   "Only items with these words in id, title, standard or designation");
  list->footer("Example: mortise catalog list --kind nut --text \"ISO 4032\"");
  list->callback([&session, filter] {
    session.command = [filter](Session& s, Output& o) {
      return SourcesOf(*filter).Name(List(*filter, s, o));
    };
  });

  auto name = std::make_shared<std::string>();
  auto revision = std::make_shared<std::int64_t>(0);
  CLI::App* show = catalog->add_subcommand("show", "Print a template, item or material");
  show->add_option("name", *name, "Such as templates/table or items/dowel-8x35")->required();
  show->add_option("--revision", *revision, "A revision of an item or template; else the latest");
  show->footer("Example: mortise catalog show items/hex-nut-m8 --revision 1");
  show->callback([&session, name, revision] {
    session.command = [name, revision](Session& s, Output& o) {
      FieldSources sources;
      sources.Add("revision", "--revision");
      return sources.Name(Show(*name, *revision, s, o));
    };
  });

  auto options = std::make_shared<EvaluateOptions>();
  CLI::App* evaluate = catalog->add_subcommand("evaluate", "The parts of a template at parameters");
  evaluate->add_option("template", options->subject, "Template, such as table")->required();
  evaluate->add_option("--set", options->parameters, "NAME=VALUE, such as length=1500mm");
  evaluate->add_option("--step", options->step, "Also write a STEP file");
  evaluate->add_option("--glb", options->glb, "Also write a GLB file");
  evaluate->add_flag("--without-triangles", options->without_triangles,
                     "With --json: leave out triangles, which may not fit into a message");
  evaluate->footer("Example: mortise catalog evaluate table --set length=1500mm --glb table.glb");
  evaluate->callback([&session, options] {
    session.command = [options](Session& s, Output& o) {
      return SourcesOf(*options).Name(Evaluate(*options, s, o));
    };
  });
  auto shape = std::make_shared<std::filesystem::path>();
  CLI::App* add_shape = catalog->add_subcommand("shape", "Add the shape in a file to the catalog");
  add_shape->add_option("file", *shape, "STEP with one solid, or STL in millimetres")->required();
  add_shape->footer("Example: mortise catalog shape bracket.step");
  add_shape->callback([&session, shape] {
    session.command = [shape](Session& s, Output& o) { return AddShape(*shape, s, o); };
  });

  AddCatalogDelete(*catalog, session);

  // Last: commands would inherit it.
  catalog->footer("Example: mortise catalog list items");
}

}  // namespace mortise::cli
