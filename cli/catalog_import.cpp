#include "cli/catalog_import.h"

#include <google/protobuf/util/message_differencer.h>
#include <grpcpp/grpcpp.h>

#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "absl/strings/str_cat.h"
#include "cli/requests.h"
#include "cli/shape_files.h"
#include "common/base/errors.h"
#include "common/base/field_violations.h"
#include "common/base/identifiers.h"
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

// A failure to convert a message, as a finding.
template <typename Message>
Finding ToFinding(const Read<Message>& read, const absl::Status& status) {
  return {read.Place(DetailOf(status).field), std::string(status.message())};
}

// Findings of a message, under its name.
template <typename Message>
void Add(const Read<Message>& read, const Findings& more, Findings& findings) {
  for (const Finding& finding : more) {
    findings.push_back(
        {absl::StrCat(read.Place(finding.field), ".", finding.field), finding.message});
  }
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

// Whether two materials or items say the same, but for what the service sets.
template <typename Message>
bool SameContent(Message a, Message b) {
  for (Message* message : {&a, &b}) {
    message->clear_revision();
    if constexpr (std::is_same_v<Message, v1::Item>) message->clear_update_time();
  }
  return google::protobuf::util::MessageDifferencer::Equals(a, b);
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
    if (!material.ok()) return findings_.push_back(ToFinding(read, material.status()));
    Add(read, parametric::ValidateMaterial(*material), findings_);
    materials_.push_back(*std::move(material));
  }

  void CheckItem(const Read<v1::Item>& read) {
    CheckName(read);
    absl::StatusOr<parametric::Item> item = parametric::FromProto(read.message());
    if (!item.ok()) return findings_.push_back(ToFinding(read, item.status()));
    Add(read, parametric::ValidateItem(*item, materials_), findings_);
    items_.push_back(*std::move(item));
  }

  void CheckTemplate(const Read<v1::Template>& read) {
    CheckName(read);
    // What needs the CAD kernel or the catalog's assemblies, the catalog checks.
    if (read.message().kind_case() != v1::Template::KIND_NOT_SET) return;
    absl::StatusOr<parametric::TemplateDefinition> definition =
        parametric::FromProto(read.message());
    if (!definition.ok()) return findings_.push_back(ToFinding(read, definition.status()));
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

// A failure to store what a file has, with the file in front.
absl::Status InFile(const std::string& file, const absl::Status& status) {
  if (status.ok()) return status;
  std::vector<FieldViolation> violations = ViolationsOf(status);
  for (FieldViolation& violation : violations) {
    violation.field = absl::StrCat(file, ": ", violation.field);
  }
  if (!violations.empty()) return InvalidFields(violations);
  ErrorDetail detail = DetailOf(status);
  detail.field = absl::StrCat(file, detail.field.empty() ? "" : ": ", detail.field);
  return WithDetail(absl::Status(status.code(), absl::StrCat(file, ": ", status.message())),
                    detail);
}

// Stores designs that have been checked, and tells of each.
class Storing {
 public:
  Storing(v1::CatalogService::Stub& stub, const GatewayClient& client, const Present& present,
          const Output& output)
      : stub_(stub), client_(client), present_(present), output_(output) {}

  absl::Status Run(const Designs& designs) {
    for (const auto& read : designs.materials) {
      MORTISE_RETURN_IF_ERROR(InFile(read.file, StoreMaterial(read.message())));
    }
    for (const auto& read : designs.items) {
      MORTISE_RETURN_IF_ERROR(InFile(read.file, StoreItem(read.message())));
    }
    for (const auto& read : designs.templates) {
      MORTISE_RETURN_IF_ERROR(InFile(read.file, StoreTemplate(read.message())));
    }
    return absl::OkStatus();
  }

  const nlohmann::ordered_json& document() const { return document_; }

 private:
  template <typename Message>
  void Note(const Message& message, std::int64_t revision_before) {
    const bool changed = message.revision() != revision_before;
    output_.Line(absl::StrCat(message.name(), changed ? " imported as" : " is there already as",
                              " revision ", message.revision()));
    document_.push_back({{"name", message.name()},
                         {"revision", message.revision()},
                         {"change", !changed               ? "none"
                                    : revision_before == 0 ? "created"
                                                           : "updated"}});
  }

  absl::Status StoreMaterial(const v1::Material& material) {
    const auto found = present_.materials.find(material.name());
    if (found == present_.materials.end()) {
      v1::CreateMaterialRequest request;
      *request.mutable_material() = material;
      return Send(
          request, [this](auto... a) { return stub_.CreateMaterial(a...); }, v1::Material(), 0);
    }
    const std::int64_t revision = found->second.revision();
    if (SameContent(found->second, material)) {
      Note(found->second, revision);
      return absl::OkStatus();
    }
    v1::UpdateMaterialRequest request;
    *request.mutable_material() = material;
    request.mutable_material()->set_revision(revision);
    return Send(
        request, [this](auto... a) { return stub_.UpdateMaterial(a...); }, v1::Material(),
        revision);
  }

  absl::Status StoreItem(const v1::Item& item) {
    const auto found = present_.items.find(item.name());
    if (found == present_.items.end()) {
      v1::CreateItemRequest request;
      *request.mutable_item() = item;
      return Send(
          request, [this](auto... a) { return stub_.CreateItem(a...); }, v1::Item(), 0);
    }
    const std::int64_t revision = found->second.revision();
    if (SameContent(found->second, item)) {
      Note(found->second, revision);
      return absl::OkStatus();
    }
    v1::UpdateItemRequest request;
    *request.mutable_item() = item;
    request.mutable_item()->set_revision(revision);
    return Send(
        request, [this](auto... a) { return stub_.UpdateItem(a...); }, v1::Item(), revision);
  }

  absl::Status StoreTemplate(const v1::Template& design) {
    v1::GetTemplateRequest get;
    get.set_name(design.name());
    v1::Template present;
    const absl::Status status = client_.Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(stub_.GetTemplate(&context, get, &present));
    });
    if (!status.ok() && !absl::IsNotFound(status)) return status;
    v1::ImportTemplateRequest request;
    *request.mutable_template_() = design;
    request.set_expected_revision(present.revision());
    return Send(
        request, [this](auto... a) { return stub_.ImportTemplate(a...); }, v1::Template(),
        present.revision());
  }

  template <typename Request, typename Method, typename Message>
  absl::Status Send(Request& request, Method method, Message stored, std::int64_t before) {
    request.set_request_id(NewIdentifier());
    MORTISE_RETURN_IF_ERROR(client_.Call([&](grpc::ClientContext& context) {
      return rpc::FromGrpc(method(&context, request, &stored));
    }));
    Note(stored, before);
    return absl::OkStatus();
  }

  v1::CatalogService::Stub& stub_;
  const GatewayClient& client_;
  const Present& present_;
  const Output& output_;
  nlohmann::ordered_json document_ = nlohmann::ordered_json::array();
};

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
  for (Read<v1::Item>& read : designs.items) {
    MORTISE_RETURN_IF_ERROR(
        ResolveShape(read.file, *read.placed.message.mutable_shape(), *stub, *client));
  }
  Storing storing(*stub, *client, present, output);
  MORTISE_RETURN_IF_ERROR(storing.Run(designs));
  output.Document(storing.document());
  return absl::OkStatus();
}

}  // namespace mortise::cli
