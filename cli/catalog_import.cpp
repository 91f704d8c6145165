#include "cli/catalog_import.h"

#include <grpcpp/grpcpp.h>

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "cli/requests.h"
#include "cli/shape_files.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/parametric/collection.h"
#include "common/parametric/design_file.h"
#include "common/parametric/template_codec.h"
#include "common/parametric/template_validation.h"
#include "common/rpc/status_mapping.h"
#include "mortise/v1/catalog.grpc.pb.h"

namespace mortise::cli {
namespace {

using parametric::Finding;
using Findings = std::vector<Finding>;

constexpr std::size_t kMaxFindings = 100;

// A message of a file, and where it comes from.
template <typename Message>
struct Read {
  std::string file;
  parametric::Placed<Message> placed;

  const Message& message() const { return placed.message; }

  // "bolts.csv: line 3, column 5 (price): items/bolt-m8x40", as far as it is known.
  std::string Place(const std::string& field = "") const {
    const std::string place = parametric::PlaceOf(placed.place, placed.fields, field);
    return absl::StrCat(file, ": ", place, place.empty() ? "" : ": ", placed.message.name());
  }
};

struct Designs {
  std::vector<Read<v1::Material>> materials;
  std::vector<Read<v1::Item>> items;
  std::vector<Read<v1::Template>> templates;
};

// What the catalog has, by name.
struct Present {
  std::map<std::string, v1::Material> materials;
  std::map<std::string, v1::Item> items;
};

// Findings of a message, under its name.
template <typename Message>
void Add(const Read<Message>& read, const Findings& more, Findings& findings) {
  for (const Finding& finding : more) {
    findings.push_back(
        {absl::StrCat(read.Place(finding.field), ".", finding.field), finding.message});
  }
}

// What keeps a message from being converted.
template <typename Message>
void Add(const Read<Message>& read, const absl::Status& status, Findings& findings) {
  Findings more;
  for (const FieldViolation& violation : AllViolationsOf(status)) {
    more.push_back({violation.field, violation.message});
  }
  Add(read, more, findings);
}

template <typename Message>
void Take(const std::string& file, std::vector<parametric::Placed<Message>>& messages,
          std::vector<Read<Message>>& taken) {
  for (auto& placed : messages) taken.push_back({file, std::move(placed)});
}

void ReadDesigns(const std::filesystem::path& path, Designs& designs, Findings& findings) {
  const std::string name = path.string();
  parametric::DesignFile file = parametric::ReadDesignFile(path);
  for (const Finding& finding : file.findings) {
    findings.push_back(
        {absl::StrCat(name, finding.field.empty() ? "" : ": ", finding.field), finding.message});
  }
  Take(name, file.materials, designs.materials);
  Take(name, file.items, designs.items);
  Take(name, file.templates, designs.templates);
}

// All findings as one failure; of very many, the first and how many more there are.
absl::Status Refusal(Findings findings) {
  if (findings.size() > kMaxFindings) {
    const std::size_t more = findings.size() - kMaxFindings;
    findings.resize(kMaxFindings);
    findings.push_back({"files", absl::StrCat("have ", more, " more faults")});
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

// Checks designs against each other and what is present.
class Check {
 public:
  Check(const Designs& designs, const Present& present) : designs_(designs), present_(present) {
    for (const auto& read : designs.materials) materials_in_files_.insert(read.message().name());
    for (const auto& read : designs.items) items_in_files_.insert(read.message().name());
  }

  Findings Run() {
    for (const auto& [name, material] : present_.materials) {
      if (materials_in_files_.count(name) == 0) TakeKnown(material, materials_);
    }
    for (const auto& read : designs_.materials) CheckMaterial(read);
    for (const auto& [name, item] : present_.items) {
      if (items_in_files_.count(name) == 0) TakeKnown(item, items_);
    }
    for (const auto& read : designs_.items) CheckItem(read);
    // A template is not judged by items that are at fault themselves.
    if (findings_.empty()) {
      for (const auto& read : designs_.templates) CheckTemplate(read);
    }
    return std::move(findings_);
  }

 private:
  template <typename Message>
  void CheckName(const Read<Message>& read) {
    if (!names_.insert(read.message().name()).second) {
      findings_.push_back({read.Place("name"), "is there twice"});
    }
  }

  template <typename Message, typename Struct>
  void TakeKnown(const Message& message, std::vector<Struct>& known) {
    absl::StatusOr<Struct> converted = parametric::FromProto(message);
    if (converted.ok()) known.push_back(*std::move(converted));
  }

  void CheckMaterial(const Read<v1::Material>& read) {
    CheckName(read);
    absl::StatusOr<parametric::Material> material = parametric::FromProto(read.message());
    if (!material.ok()) return Add(read, material.status(), findings_);
    Add(read, parametric::ValidateMaterial(*material), findings_);
    materials_.push_back(*std::move(material));
  }

  void CheckItem(const Read<v1::Item>& read) {
    CheckName(read);
    absl::StatusOr<parametric::Item> item = parametric::FromProto(read.message());
    if (!item.ok()) return Add(read, item.status(), findings_);
    Add(read, parametric::ValidateItem(*item, materials_), findings_);
    items_.push_back(*std::move(item));
  }

  void CheckTemplate(const Read<v1::Template>& read) {
    CheckName(read);
    // What needs the CAD kernel or the catalog's assemblies, the catalog checks.
    if (read.message().kind_case() != v1::Template::KIND_NOT_SET) return;
    absl::StatusOr<parametric::TemplateDefinition> definition =
        parametric::FromProto(read.message());
    if (!definition.ok()) return Add(read, definition.status(), findings_);
    Add(read,
        parametric::ValidateTemplate(
            parametric::MakeBundle(*std::move(definition), items_, materials_)),
        findings_);
  }

  const Designs& designs_;
  const Present& present_;
  std::vector<parametric::Material> materials_;  // of the files and the catalog
  std::vector<parametric::Item> items_;          // the same; the files' where both have one
  std::set<std::string> materials_in_files_;
  std::set<std::string> items_in_files_;
  std::set<std::string> names_;  // of the files, as far as they have been checked
  Findings findings_;
};

// The designs as one request.
absl::StatusOr<v1::ImportCatalogRequest> RequestOf(const Designs& designs) {
  v1::ImportCatalogRequest request;
  request.set_request_id(NewIdentifier());
  for (const auto& read : designs.materials) *request.add_materials() = read.message();
  for (const auto& read : designs.items) *request.add_items() = read.message();
  for (const auto& read : designs.templates) *request.add_templates() = read.message();
  if (request.ByteSizeLong() > kMostInMessage) {
    return TooLarge("what the files have together",
                    absl::StrCat(kMostInMessage, " bytes: import them one after the other"));
  }
  return request;
}

// Takes "items[" and "]" off "items[3].price", which leaves the 3 and ".price"; nothing where it
// does not begin so.
std::optional<std::pair<std::size_t, std::string>> SplitField(const std::string& field,
                                                              const std::string& list) {
  if (!field.starts_with(list + "[")) return std::nullopt;
  const std::size_t end = field.find(']');
  std::size_t index = 0;
  if (end == std::string::npos ||
      !absl::SimpleAtoi(field.substr(list.size() + 1, end - list.size() - 1), &index)) {
    return std::nullopt;
  }
  const std::string rest = field.substr(end + 1);
  return std::pair(index, rest.starts_with(".") ? rest.substr(1) : rest);
}

// Where what the catalog says of a field of the request is in the files, if it is of that list.
template <typename Message>
std::optional<std::string> PlaceIn(const std::vector<Read<Message>>& list, const std::string& name,
                                   const std::string& field) {
  const auto split = SplitField(field, name);
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
  for (const std::filesystem::path& file : files) ReadDesigns(file, designs, findings);
  MORTISE_RETURN_IF_ERROR(Refusal(std::move(findings)));
  MORTISE_ASSIGN_OR_RETURN(GatewayClient* const client, session.Client());
  const auto stub = v1::CatalogService::NewStub(client->channel());
  MORTISE_ASSIGN_OR_RETURN(const Present present, ReadCatalog(*stub, *client));
  MORTISE_RETURN_IF_ERROR(Refusal(Check(designs, present).Run()));
  std::vector<std::string> notes;
  for (Read<v1::Item>& read : designs.items) {
    MORTISE_RETURN_IF_ERROR(
        ResolveShape(read.file, *read.placed.message.mutable_shape(), *stub, *client, notes));
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
