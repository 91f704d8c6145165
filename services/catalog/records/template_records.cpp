// Templates in the store, each revision with the items and materials it was imported with.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/resources/resource_filter.h"
#include "common/templates/analysis_needs.h"
#include "services/catalog/records/assembly_records.h"
#include "services/catalog/records/bundle_records.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/list_filter.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/record_page.h"
#include "services/catalog/records/record_tags.h"
#include "services/catalog/records/record_users.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

constexpr std::size_t kMaxIdBytes = 63;
constexpr std::size_t kPlacedDigits = 12;  // of a digest of the ground, in names

constexpr BundleKind kKind = {.names = kTemplates, .name = "template"};

// Whether there is nothing of the name or revision that was asked for.
bool IsNone(const absl::Status& status) {
  return absl::IsNotFound(status) || absl::IsInvalidArgument(status);
}

// The assembly of an assembly template, and what it uses. One that is deleted cannot be exposed.
absl::Status FreezeAssembly(store::ReadTransaction& transaction, v1::TemplateBundle& bundle) {
  v1::AssemblyTemplate& message = *bundle.mutable_template_()->mutable_assembly();
  absl::StatusOr<v1::AssemblyBundle> used =
      OrNearName(transaction, kAssemblies, message.assembly(),
                 GetAssemblyBundle(transaction, message.assembly(), 0));
  if (IsNone(used.status())) {
    return InvalidField("assembly.assembly", std::string(used.status().message()));
  }
  MORTISE_RETURN_IF_ERROR(used.status());
  if (message.revision() != 0) {
    used = GetAssemblyBundle(transaction, message.assembly(), message.revision());
    if (IsNone(used.status())) {
      return InvalidField("assembly.revision", std::string(used.status().message()));
    }
    MORTISE_RETURN_IF_ERROR(used.status());
  }
  message.set_revision(used->assembly().revision());
  *bundle.mutable_items() = std::move(*used->mutable_items());
  *bundle.mutable_materials() = std::move(*used->mutable_materials());
  *bundle.mutable_assembly() = std::move(*used->mutable_assembly());
  return AddShapes(transaction, bundle.assembly(), bundle.items(), *bundle.mutable_shapes());
}

// The latest revision of a template; of none the revision is 0.
absl::StatusOr<v1::Template> GetPresent(store::ReadTransaction& transaction,
                                        const std::string& name) {
  MORTISE_ASSIGN_OR_RETURN(const store::Record record,
                           GetRecordOrNone(transaction, kTemplates, name, kKind.name));
  if (record.revision == 0) return v1::Template();
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, BundleOf<v1::TemplateBundle>(kKind, record));
  return std::move(*bundle.mutable_template_());
}

bool IsOfKind(const v1::Template& message, v1::ListTemplatesRequest::Kind kind) {
  switch (kind) {
    case v1::ListTemplatesRequest::PARTS:
      return message.kind_case() == v1::Template::KIND_NOT_SET;
    case v1::ListTemplatesRequest::ASSEMBLY:
      return message.has_assembly();
    case v1::ListTemplatesRequest::CAD:
      return message.has_cad();
    case v1::ListTemplatesRequest::CAGE:
      return message.has_cage();
    default:
      return true;
  }
}

}  // namespace

absl::StatusOr<v1::TemplateBundle> GetBundle(store::ReadTransaction& transaction,
                                             const std::string& name, int64_t revision) {
  return GetBundleOf<v1::TemplateBundle>(transaction, kKind, name, revision);
}

absl::StatusOr<Page<v1::Template>> ListTemplates(store::ReadTransaction& transaction,
                                                 const v1::ListTemplatesRequest& request) {
  const absl::StatusOr<WordFilter> words = WordFilter::Create(request.text());
  const auto filter = resources::ResourceFilter::Of(request);
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      CombineViolations(CheckFilterName(transaction, kItems, request.item(), "item"),
                        words.status()),
      CombineViolations(filter.status(), resources::ReadPageQuery(request).status())));
  return ReadPage<v1::Template>(
      transaction, kTemplates, request,
      [&](const store::Record& record) -> absl::StatusOr<std::optional<v1::Template>> {
        MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle,
                                 BundleOf<v1::TemplateBundle>(kKind, record));
        const v1::Template& message = bundle.template_();
        if (!IsOfKind(message, request.kind()) || !filter->Matches(message)) return std::nullopt;
        if (!request.item().empty() && !UsesItem(bundle, request.item())) return std::nullopt;
        if (!words->Matches(message.name(), {message.title(), message.description()})) {
          return std::nullopt;
        }
        const std::vector<std::string> lacks = templates::AnalysisLacks(bundle);
        v1::Template summary = templates::SummaryOf(std::move(*bundle.mutable_template_()));
        *summary.mutable_analysis_lacks() = {lacks.begin(), lacks.end()};
        return summary;
      });
}

absl::StatusOr<v1::TemplateBundle> Freeze(store::ReadTransaction& transaction,
                                          const v1::Template& message) {
  v1::TemplateBundle bundle;
  *bundle.mutable_template_() = message;
  ClearWhatTheServiceSays(bundle.mutable_template_());
  bundle.mutable_template_()->clear_placed_template();
  bundle.mutable_template_()->clear_placed_template_revision();
  bundle.mutable_template_()->clear_analysis_lacks();
  if (message.has_assembly()) {
    MORTISE_RETURN_IF_ERROR(FreezeAssembly(transaction, bundle));
    return bundle;
  }
  MORTISE_RETURN_IF_ERROR(AddItems(transaction, templates::ItemsOf(message),
                                   *bundle.mutable_items(), *bundle.mutable_materials()));
  for (const std::string& name : templates::MaterialsOf(message)) {
    absl::StatusOr<v1::Material> material = GetMaterial(transaction, name);
    // What is not there is told with everything else that is wrong.
    if (material.ok()) *bundle.add_materials() = *std::move(material);
  }
  return bundle;
}

absl::StatusOr<v1::Template> ImportBundle(store::Transaction& transaction,
                                          v1::TemplateBundle bundle, int64_t expected_revision,
                                          const resources::Author& author) {
  v1::Template& message = *bundle.mutable_template_();
  if (message.placed_template().empty()) {
    MORTISE_ASSIGN_OR_RETURN(const v1::Template present, GetPresent(transaction, message.name()));
    if (present.digest() == message.digest()) {
      message.set_placed_template(present.placed_template());
      message.set_placed_template_revision(present.placed_template_revision());
    }
  }
  // The shapes are those of the assembly, which are stored.
  return ImportRevision(transaction, kKind, std::move(bundle), expected_revision, author);
}

std::string PlacedName(const std::string& name,
                       const google::protobuf::RepeatedPtrField<v1::HeightField>& height_fields) {
  std::string heights;
  for (const v1::HeightField& field : height_fields) {
    absl::StrAppend(&heights, field.name(), "=", field.digest(), "\n");
  }
  const std::string suffix = absl::StrCat("-", Sha256Hex(heights).substr(0, kPlacedDigits));
  std::string id = name.substr(name.find('/') + 1);
  id.resize(std::min(id.size(), kMaxIdBytes - suffix.size()));
  return absl::StrCat(kTemplates, "/", id, suffix);
}

absl::StatusOr<v1::Template> PutPlaced(store::Transaction& transaction, v1::TemplateBundle bundle,
                                       const resources::Author& author) {
  v1::Template& message = *bundle.mutable_template_();
  MORTISE_ASSIGN_OR_RETURN(const v1::Template present, GetPresent(transaction, message.name()));
  if (present.revision() > 0 && present.placed_template() != message.placed_template()) {
    return ResourceExists(message.name());
  }
  KeepTags(present, &message);
  return ImportBundle(transaction, std::move(bundle), present.revision(), author);
}

absl::Status DeleteTemplate(store::Transaction& transaction,
                            const v1::DeleteTemplateRequest& request,
                            const resources::Author& author) {
  MORTISE_RETURN_IF_ERROR(MarkDeleted(transaction, kTemplates, request.name(), request.revision()));
  return AppendEvent(transaction, "template.deleted", request.name(),
                     {{"revision", request.revision()}}, author);
}

}  // namespace mortise::catalog
