#include "cli/files/catalog_import.h"

#include <grpcpp/grpcpp.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "cli/client/requests.h"
#include "cli/files/design_check.h"
#include "cli/files/shape_files.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/design/template_validation.h"
#include "common/files/design_file.h"
#include "common/files/message_checks.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {
namespace {

using Findings = std::vector<FieldViolation>;

constexpr std::size_t kMaxFindings = 100;

template <typename Message>
void Take(const std::string& file, std::vector<parametric::Placed<Message>>& messages,
          std::vector<ReadDesign<Message>>& taken) {
  for (auto& placed : messages) taken.push_back({file, std::move(placed)});
}

void ReadDesigns(const std::filesystem::path& path, Designs& designs, Findings& findings,
                 std::size_t& unlisted) {
  const std::string name = path.string();
  parametric::DesignFile file = parametric::ReadDesignFile(path);
  for (const FieldViolation& finding : file.findings) {
    findings.push_back(
        {absl::StrCat(name, finding.field.empty() ? "" : ": ", finding.field), finding.message});
  }
  unlisted += file.unlisted;
  Take(name, file.materials, designs.materials);
  Take(name, file.items, designs.items);
  Take(name, file.templates, designs.templates);
  designs.unread_names.merge(file.unread_names);
}

// All findings as one failure; of very many, the first and how many more there are. `unlisted`
// ones are in the files besides.
absl::Status Refusal(Findings findings, std::size_t unlisted) {
  std::size_t more = unlisted;
  if (findings.size() > kMaxFindings) {
    more += findings.size() - kMaxFindings;
    findings.resize(kMaxFindings);
  }
  if (more > 0) {
    findings.push_back({"files", absl::StrCat("have ", more, " more fault", more == 1 ? "" : "s")});
  }
  return parametric::ToStatus(findings);
}

absl::StatusOr<Present> ReadCatalog(v1::CatalogService::Stub& stub, const GatewayClient& client) {
  Present present;
  const absl::Status materials = ListAll<v1::ListMaterialsRequest, v1::ListMaterialsResponse>(
      client, [&](auto... a) { return stub.ListMaterials(a...); },
      [&](const v1::ListMaterialsResponse& page) {
        for (const auto& material : page.materials()) present.materials[material.name()] = material;
      });
  MORTISE_RETURN_IF_ERROR(materials);
  const absl::Status items = ListAll<v1::ListItemsRequest, v1::ListItemsResponse>(
      client, [&](auto... a) { return stub.ListItems(a...); },
      [&](const v1::ListItemsResponse& page) {
        for (const auto& item : page.items()) present.items[item.name()] = item;
      });
  MORTISE_RETURN_IF_ERROR(items);
  return present;
}

// Adds shapes in files beside those of items to the catalog, and names them in the items. A file
// that is not there or no shape is a finding; gives failures to reach the catalog.
absl::Status ResolveShapes(Designs& designs, v1::CatalogService::Stub& stub,
                           const GatewayClient& client, std::vector<std::string>& notes,
                           Findings& findings) {
  for (ReadDesign<v1::Item>& read : designs.items) {
    const absl::Status resolved =
        ResolveShape(read.file, *read.placed.message.mutable_shape(), stub, client, notes);
    MORTISE_RETURN_IF_ERROR(AddShapeFaults(resolved, read.Place("shape") + ".shape", findings));
  }
  return absl::OkStatus();
}

// What is wrong with the shapes that items name, given those that the catalog has, which tells of
// them where nothing else is wrong. Shapes that do not fit into a message are not looked at.
absl::Status CheckShapes(const Designs& designs, v1::CatalogService::Stub& stub,
                         const GatewayClient& client, Findings& findings) {
  std::map<std::string, absl::StatusOr<v1::Shape>> shapes;
  for (const ReadDesign<v1::Item>& read : designs.items) {
    const std::string& name = read.message().shape();
    if (!name.starts_with("shapes/")) continue;
    if (shapes.count(name) == 0) {
      v1::GetShapeRequest request;
      request.set_name(name);
      v1::Shape shape;
      const absl::Status found = client.Call([&](grpc::ClientContext& context) {
        return rpc::FromGrpc(stub.GetShape(&context, request, &shape));
      });
      shape.clear_vertices();
      shape.clear_triangles();
      shape.clear_triangle_faces();
      shapes.emplace(name, found.ok() ? absl::StatusOr<v1::Shape>(std::move(shape)) : found);
    }
    const absl::StatusOr<v1::Shape>& shape = shapes.at(name);
    if (shape.ok()) {
      AddFindings(read, parametric::CheckShapeOfItem(read.message(), *shape, read.placed.unread),
                  findings);
    } else if (absl::IsNotFound(shape.status()) || absl::IsInvalidArgument(shape.status())) {
      AddFindings(read, {parametric::MissingShape(read.message())}, findings);
    } else if (!absl::IsResourceExhausted(shape.status())) {
      return shape.status();
    }
  }
  return absl::OkStatus();
}

// The designs as one request.
absl::StatusOr<v1::ImportCatalogRequest> RequestOf(const Designs& designs) {
  v1::ImportCatalogRequest request;
  request.set_request_id(NewIdentifier());
  for (const auto& read : designs.materials) *request.add_materials() = read.message();
  for (const auto& read : designs.items) *request.add_items() = read.message();
  for (const auto& read : designs.templates) *request.add_templates() = read.message();
  if (request.ByteSizeLong() > kMaxInMessage) {
    return TooLarge("what the files have together",
                    absl::StrCat(kMaxInMessage, " bytes: import them one after the other"));
  }
  return request;
}

// Where what the catalog says of a field of the request is in the files, if it is of that list.
template <typename Message>
std::optional<std::string> PlaceIn(const std::vector<ReadDesign<Message>>& list,
                                   const std::string& name, const std::string& field) {
  const auto split = parametric::ElementOf(field, name);
  if (!split || split->first >= list.size()) return std::nullopt;
  const auto& [index, rest] = *split;
  return absl::StrCat(list[index].Place(rest), rest.empty() ? "" : ".", rest);
}

// A refusal by the catalog, with places in the files.
absl::Status InFiles(const Designs& designs, const absl::Status& status) {
  std::vector<FieldViolation> violations = AllViolationsOf(status);
  if (violations.empty()) return status;
  for (FieldViolation& violation : violations) {
    std::optional<std::string> place = PlaceIn(designs.materials, "materials", violation.field);
    if (!place) place = PlaceIn(designs.items, "items", violation.field);
    if (!place) place = PlaceIn(designs.templates, "templates", violation.field);
    if (place) violation.field = *place;
  }
  return InvalidFields(violations);
}

// What became of a thing: for the document, and for people.
struct Words {
  const char* change;
  const char* sentence;
};

Words WordsOf(v1::ImportCatalogResponse::Change::Kind kind) {
  using Change = v1::ImportCatalogResponse::Change;
  if (kind == Change::UNCHANGED) return {"none", " is there already as revision "};
  return {kind == Change::CREATED ? "created" : "updated", " imported as revision "};
}

void Tell(const v1::ImportCatalogResponse& imported, Output& output) {
  nlohmann::ordered_json document = nlohmann::ordered_json::array();
  for (const auto& change : imported.changes()) {
    const Words words = WordsOf(change.kind());
    output.Line(absl::StrCat(change.name(), words.sentence, change.revision()));
    document.push_back(
        {{"name", change.name()}, {"revision", change.revision()}, {"change", words.change}});
  }
  output.Document(document);
}

}  // namespace

absl::Status ImportFiles(const std::vector<std::filesystem::path>& files, Session& session,
                         Output& output) {
  Designs designs;
  Findings findings;
  std::size_t unlisted = 0;
  for (const std::filesystem::path& file : files) ReadDesigns(file, designs, findings, unlisted);
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::CatalogService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(const Present present, ReadCatalog(*stub, *client));
  for (FieldViolation& finding : CheckDesigns(designs, present)) {
    findings.push_back(std::move(finding));
  }
  std::vector<std::string> notes;
  MORTISE_RETURN_IF_ERROR(ResolveShapes(designs, *stub, *client, notes, findings));
  if (!findings.empty()) {
    MORTISE_RETURN_IF_ERROR(CheckShapes(designs, *stub, *client, findings));
    return Refusal(std::move(findings), unlisted);
  }
  for (const std::string& note : notes) output.Line(absl::StrCat("note: ", note));
  MORTISE_ASSIGN_OR_RETURN(const v1::ImportCatalogRequest request, RequestOf(designs));
  v1::ImportCatalogResponse imported;
  // Templates are tried at many designs.
  const double patience = 60.0 * (1 + request.templates_size());
  MORTISE_RETURN_IF_ERROR(InFiles(designs, client->Call(
                                               [&](grpc::ClientContext& context) {
                                                 return rpc::FromGrpc(stub->ImportCatalog(
                                                     &context, request, &imported));
                                               },
                                               patience)));
  Tell(imported, output);
  return absl::OkStatus();
}

}  // namespace mortise::cli
