#include "services/catalog/records/assembly_records.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_join.h"
#include "common/assembly/codec/assembly_codec.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/files/template_codec.h"
#include "common/resources/resource_filter.h"
#include "services/catalog/records/bundle_records.h"
#include "services/catalog/records/list_filter.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/record_page.h"
#include "services/catalog/records/record_users.h"
#include "services/catalog/records/shape_records.h"

namespace mortise::catalog {
namespace {

constexpr BundleKind kKind = {.names = kAssemblies, .name = "assembly"};

// Whether the latest revision of a template exposes the assembly.
bool Exposes(const store::Record& record, const std::string& assembly) {
  v1::TemplateBundle bundle;
  return bundle.ParseFromString(record.payload) &&
         bundle.template_().assembly().assembly() == assembly;
}

}  // namespace

absl::StatusOr<v1::AssemblyBundle> GetAssemblyBundle(store::ReadTransaction& transaction,
                                                     const std::string& name, int64_t revision) {
  return GetBundleOf<v1::AssemblyBundle>(transaction, kKind, name, revision);
}

absl::StatusOr<Page<v1::Assembly>> ListAssemblies(store::ReadTransaction& transaction,
                                                  const v1::ListAssembliesRequest& request) {
  const absl::StatusOr<WordFilter> words = WordFilter::Create(request.text());
  const auto filter = resources::ResourceFilter::Of(request);
  MORTISE_RETURN_IF_ERROR(CombineViolations(
      CombineViolations(CheckFilterName(transaction, kItems, request.item(), "item"),
                        words.status()),
      CombineViolations(filter.status(), resources::ReadPageQuery(request).status())));
  return ReadPage<v1::Assembly>(
      transaction, kAssemblies, request,
      [&](const store::Record& record) -> absl::StatusOr<std::optional<v1::Assembly>> {
        MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle,
                                 BundleOf<v1::AssemblyBundle>(kKind, record));
        v1::Assembly& summary = *bundle.mutable_assembly();
        if (!filter->Matches(summary)) return std::nullopt;
        if (!request.item().empty() && !UsesItem(bundle, request.item())) return std::nullopt;
        if (!words->Matches(summary.name(), {summary.title(), summary.description()})) {
          return std::nullopt;
        }
        summary.clear_parts();
        summary.clear_groups();
        summary.clear_joints();
        return std::move(summary);
      });
}

absl::StatusOr<v1::AssemblyBundle> Freeze(store::ReadTransaction& transaction,
                                          const v1::Assembly& message) {
  v1::AssemblyBundle bundle;
  *bundle.mutable_assembly() = message;
  std::set<std::string> items;
  for (const v1::AssemblyPart& part : message.parts()) items.insert(part.item());
  MORTISE_RETURN_IF_ERROR(
      AddItems(transaction, items, *bundle.mutable_items(), *bundle.mutable_materials()));
  MORTISE_RETURN_IF_ERROR(
      AddShapes(transaction, message, bundle.items(), *bundle.mutable_shapes()));
  ClearWhatTheServiceSays(bundle.mutable_assembly());
  bundle.mutable_assembly()->set_digest(parametric::BundleDigest(bundle));
  return bundle;
}

absl::StatusOr<v1::Assembly> ImportBundle(store::Transaction& transaction,
                                          v1::AssemblyBundle bundle, int64_t expected_revision,
                                          const resources::Author& author) {
  for (const v1::Shape& shape : bundle.shapes()) {
    MORTISE_RETURN_IF_ERROR(PutShape(transaction, shape).status());
  }
  return ImportRevision(transaction, kKind, std::move(bundle), expected_revision, author);
}

absl::Status DeleteAssembly(store::Transaction& transaction,
                            const v1::DeleteAssemblyRequest& request,
                            const resources::Author& author) {
  MORTISE_ASSIGN_OR_RETURN(const store::Record present,
                           GetRecord(transaction, kAssemblies, request.name()));
  if (present.revision != request.revision()) {
    return StaleRevision(request.name(), request.revision(), present.revision);
  }
  std::vector<std::string> users;
  MORTISE_RETURN_IF_ERROR(AddUsers(
      transaction, kTemplates,
      [&](const store::Record& record) { return Exposes(record, request.name()); }, users));
  if (!users.empty()) {
    return PreconditionFailed(
        "ASSEMBLY_IN_USE", "'" + request.name() + "' is exposed by " + absl::StrJoin(users, ", "),
        "name");
  }
  MORTISE_RETURN_IF_ERROR(
      MarkDeleted(transaction, kAssemblies, request.name(), request.revision()));
  return AppendEvent(transaction, "assembly.deleted", request.name(),
                     {{"revision", request.revision()}}, author);
}

}  // namespace mortise::catalog
