// Reads, checks and stores the shipped collection.
#include "services/catalog/collection_loader.h"

#include <set>
#include <string>
#include <utility>

#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/parametric/collection.h"
#include "services/catalog/assembly_records.h"
#include "services/catalog/catalog_records.h"
#include "services/catalog/record_access.h"

namespace mortise::catalog {
namespace {

absl::StatusOr<bool> IsEmpty(store::ReadTransaction& transaction) {
  store::ListOptions one;
  one.limit = 1;
  for (const char* kind : {kMaterials, kItems, kTemplates, kAssemblies}) {
    MORTISE_ASSIGN_OR_RETURN(const std::vector<store::Record> records, transaction.List(kind, one));
    if (!records.empty()) return false;
  }
  return true;
}

// Stores a template. What ships has been tried all over its design space (shipped_things_test).
absl::Status LoadTemplate(store::Transaction& transaction, const v1::Template& message) {
  absl::StatusOr<v1::TemplateBundle> bundle = Freeze(transaction, message);
  if (!bundle.ok()) return UnderField(message.name(), bundle.status());
  const absl::Status checked = CompleteBundle(*bundle, templates::Trial::kDefaults);
  if (!checked.ok()) return UnderField(message.name(), checked);
  return UnderField(message.name(), ImportBundle(transaction, *std::move(bundle), 0, "").status());
}

// The template that exposes what can be changed of an assembly.
v1::Template TemplateOf(const v1::Assembly& assembly) {
  v1::Template message;
  message.set_name("templates" + assembly.name().substr(assembly.name().find('/')));
  message.mutable_assembly()->set_assembly(assembly.name());
  return message;
}

absl::Status LoadAll(store::Transaction& transaction, const parametric::Collection& collection) {
  for (const v1::Material& material : collection.materials) {
    const auto created = CreateMaterial(transaction, material, "");
    if (!created.ok()) return UnderField(material.name(), created.status());
  }
  for (const v1::Item& item : collection.items) {
    const auto created = CreateItem(transaction, item, "");
    if (!created.ok()) return UnderField(item.name(), created.status());
  }
  std::set<std::string> own_templates;
  for (const v1::Template& message : collection.templates) own_templates.insert(message.name());
  for (const v1::Assembly& message : collection.assemblies) {
    MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, Freeze(transaction, message));
    const absl::Status checked = Parametrize(bundle).status();
    if (!checked.ok()) return UnderField(message.name(), checked);
    MORTISE_RETURN_IF_ERROR(ImportBundle(transaction, std::move(bundle), 0, "").status());
    // Somebody's own template of that name is kept instead.
    const v1::Template exposed = TemplateOf(message);
    if (own_templates.count(exposed.name()) == 0) {
      MORTISE_RETURN_IF_ERROR(LoadTemplate(transaction, exposed));
    }
  }
  for (const v1::Template& message : collection.templates) {
    MORTISE_RETURN_IF_ERROR(LoadTemplate(transaction, message));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status LoadCollectionIfEmpty(store::Store& store, const std::filesystem::path& folder) {
  bool empty = false;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(empty, IsEmpty(transaction));
    return absl::OkStatus();
  }));
  if (!empty) return absl::OkStatus();
  MORTISE_ASSIGN_OR_RETURN(const parametric::Collection collection,
                           parametric::ReadCollection(folder));
  bool loaded = false;
  MORTISE_RETURN_IF_ERROR(store.Transact([&](store::Transaction& transaction) -> absl::Status {
    // Another replica may have been first.
    MORTISE_ASSIGN_OR_RETURN(loaded, IsEmpty(transaction));
    return loaded ? LoadAll(transaction, collection) : absl::OkStatus();
  }));
  if (loaded) {
    Log(LogLevel::kInfo, "loaded the collection",
        {{"folder", folder.string()},
         {"materials", collection.materials.size()},
         {"items", collection.items.size()},
         {"templates", collection.templates.size()},
         {"assemblies", collection.assemblies.size()}});
  }
  return absl::OkStatus();
}

}  // namespace mortise::catalog
