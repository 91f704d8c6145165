// Reads, checks and stores the shipped collection.
#include "services/catalog/collection_loader.h"

#include <functional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/parametric/collection.h"
#include "services/catalog/assembly_records.h"
#include "services/catalog/catalog_records.h"
#include "services/catalog/record_access.h"
#include "services/catalog/shipped_marks.h"

namespace mortise::catalog {
namespace {

// Writes a thing as the revision after the given one, 0 for a new one; the revision that it then
// has.
using Put = std::function<absl::StatusOr<int64_t>(int64_t present)>;

// One thing of a collection.
struct Thing {
  const char* kind;
  std::string name;
  std::string digest;
  Put put;
  std::string assembly = {};  // that a template exposes
};

std::string DigestOf(const google::protobuf::Message& message) {
  return Sha256Hex(message.SerializeAsString());
}

// The template that exposes what can be changed of an assembly.
v1::Template TemplateOf(const v1::Assembly& assembly) {
  v1::Template message;
  message.set_name("templates" + assembly.name().substr(assembly.name().find('/')));
  message.mutable_assembly()->set_assembly(assembly.name());
  return message;
}

absl::StatusOr<int64_t> PutMaterial(store::Transaction& transaction, v1::Material material,
                                    int64_t present) {
  if (present == 0) {
    MORTISE_ASSIGN_OR_RETURN(const v1::Material made, CreateMaterial(transaction, material, ""));
    return made.revision();
  }
  material.set_revision(present);
  MORTISE_ASSIGN_OR_RETURN(const v1::Material now, GetMaterial(transaction, material.name()));
  if (now.SerializeAsString() == material.SerializeAsString()) return present;
  v1::UpdateMaterialRequest update;
  *update.mutable_material() = std::move(material);
  MORTISE_ASSIGN_OR_RETURN(const v1::Material made, UpdateMaterial(transaction, update, ""));
  return made.revision();
}

absl::StatusOr<int64_t> PutItem(store::Transaction& transaction, v1::Item item, int64_t present) {
  if (present == 0) {
    MORTISE_ASSIGN_OR_RETURN(const v1::Item made, CreateItem(transaction, item, ""));
    return made.revision();
  }
  item.set_revision(present);
  MORTISE_ASSIGN_OR_RETURN(v1::Item now, GetItem(transaction, item.name()));
  now.clear_update_time();
  if (now.SerializeAsString() == item.SerializeAsString()) return present;
  v1::UpdateItemRequest update;
  *update.mutable_item() = std::move(item);
  MORTISE_ASSIGN_OR_RETURN(const v1::Item made, UpdateItem(transaction, update, ""));
  return made.revision();
}

absl::StatusOr<int64_t> PutAssembly(store::Transaction& transaction, const v1::Assembly& message,
                                    int64_t present) {
  MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, Freeze(transaction, message));
  MORTISE_RETURN_IF_ERROR(Parametrize(bundle).status());
  MORTISE_ASSIGN_OR_RETURN(const v1::Assembly stored,
                           ImportBundle(transaction, std::move(bundle), present, ""));
  return stored.revision();
}

// What ships has been tried all over its design space (shipped_things_test).
absl::StatusOr<int64_t> PutTemplate(store::Transaction& transaction, const v1::Template& message,
                                    int64_t present) {
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, Freeze(transaction, message));
  MORTISE_RETURN_IF_ERROR(CompleteBundle(bundle, templates::Trial::kDefaults));
  MORTISE_ASSIGN_OR_RETURN(const v1::Template stored,
                           ImportBundle(transaction, std::move(bundle), present, ""));
  return stored.revision();
}

// All things of a collection, in an order in which each comes after what it uses. `transaction` may
// be null for those who only ask what there is.
std::vector<Thing> ThingsOf(const parametric::Collection& collection,
                            store::Transaction* transaction) {
  std::vector<Thing> things;
  for (const v1::Material& message : collection.materials) {
    things.push_back({kMaterials, message.name(), DigestOf(message), [=](int64_t present) {
                        return PutMaterial(*transaction, message, present);
                      }});
  }
  for (const v1::Item& message : collection.items) {
    things.push_back({kItems, message.name(), DigestOf(message),
                      [=](int64_t present) { return PutItem(*transaction, message, present); }});
  }
  std::set<std::string> own_templates;
  for (const v1::Template& message : collection.templates) own_templates.insert(message.name());
  const auto add_template = [&](const v1::Template& message, const std::string& digest) {
    things.push_back({kTemplates, message.name(), digest,
                      [=](int64_t present) { return PutTemplate(*transaction, message, present); },
                      message.assembly().assembly()});
  };
  for (const v1::Assembly& message : collection.assemblies) {
    things.push_back({kAssemblies, message.name(), DigestOf(message), [=](int64_t present) {
                        return PutAssembly(*transaction, message, present);
                      }});
    // Somebody's own template of that name is kept instead.
    const v1::Template exposed = TemplateOf(message);
    if (own_templates.count(exposed.name()) == 0) {
      add_template(exposed, Sha256Hex(DigestOf(exposed) + DigestOf(message)));
    }
  }
  for (const v1::Template& message : collection.templates) add_template(message, DigestOf(message));
  return things;
}

// Whether a thing's content is at fault, and not the store.
bool IsFaultOfThing(const absl::Status& status) {
  return absl::IsInvalidArgument(status) || absl::IsFailedPrecondition(status) ||
         absl::IsNotFound(status) || absl::IsOutOfRange(status) ||
         absl::IsResourceExhausted(status) || absl::IsAlreadyExists(status);
}

class Loader {
 public:
  explicit Loader(store::Transaction& transaction) : transaction_(transaction) {}

  absl::StatusOr<CollectionReport> Load(const parametric::Collection& collection) {
    MORTISE_ASSIGN_OR_RETURN(origin_, OriginOf(transaction_));
    for (const Thing& thing : ThingsOf(collection, &transaction_)) {
      MORTISE_RETURN_IF_ERROR(Take(thing));
    }
    return std::move(report_);
  }

 private:
  absl::Status Take(const Thing& thing) {
    MORTISE_ASSIGN_OR_RETURN(const auto mark, GetMark(transaction_, thing.name));
    MORTISE_ASSIGN_OR_RETURN(const auto present, FindPresent(transaction_, thing.kind, thing.name));
    Delivery delivery = DecideDelivery(mark, present, thing.digest, origin_.filled_at);
    if (delivery != Delivery::kNone && !thing.assembly.empty()) {
      // It would expose what a user has drawn instead.
      MORTISE_ASSIGN_OR_RETURN(const bool as_shipped, IsShippedNow(kAssemblies, thing.assembly));
      if (!as_shipped) delivery = Delivery::kKeepOwn;
    }
    switch (delivery) {
      case Delivery::kNone:
        return absl::OkStatus();
      case Delivery::kKeepOwn:
        report_.kept.push_back(thing.name);
        return PutMark(transaction_, thing.name,
                       {thing.digest, mark ? mark->revision : 0,
                        mark ? mark->created_at : absl::InfinitePast()});
      case Delivery::kCreate:
      case Delivery::kUpdate:
        return Bring(thing, present ? present->revision : 0);
    }
    return absl::OkStatus();
  }

  absl::Status Bring(const Thing& thing, int64_t present) {
    const absl::StatusOr<int64_t> revision = thing.put(present);
    if (!revision.ok()) {
      // Of an empty catalog the collection itself is at fault.
      if (origin_.is_empty || !IsFaultOfThing(revision.status())) {
        return UnderField(thing.name, revision.status());
      }
      report_.failed.push_back(absl::StrCat(thing.name, ": ", revision.status().message()));
      return absl::OkStatus();
    }
    if (*revision != present) {
      (present == 0 ? report_.created : report_.updated).push_back(thing.name);
    }
    MORTISE_ASSIGN_OR_RETURN(const auto brought, FindPresent(transaction_, thing.kind, thing.name));
    return PutMark(transaction_, thing.name,
                   {thing.digest, *revision, brought ? brought->created_at : absl::InfinitePast()});
  }

  absl::StatusOr<bool> IsShippedNow(const char* kind, const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(const auto mark, GetMark(transaction_, name));
    MORTISE_ASSIGN_OR_RETURN(const auto present, FindPresent(transaction_, kind, name));
    return IsAsShipped(mark, present);
  }

  store::Transaction& transaction_;
  StoreOrigin origin_;
  CollectionReport report_;
};

// Whether the store lacks anything of the collection, as it looks without keeping others from
// writing.
absl::StatusOr<bool> LacksAny(store::Store& store, const parametric::Collection& collection) {
  bool lacks = false;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    lacks = false;
    MORTISE_ASSIGN_OR_RETURN(const StoreOrigin origin, OriginOf(transaction));
    for (const Thing& thing : ThingsOf(collection, nullptr)) {
      MORTISE_ASSIGN_OR_RETURN(const auto mark, GetMark(transaction, thing.name));
      MORTISE_ASSIGN_OR_RETURN(const auto present,
                               FindPresent(transaction, thing.kind, thing.name));
      lacks =
          lacks || DecideDelivery(mark, present, thing.digest, origin.filled_at) != Delivery::kNone;
    }
    return absl::OkStatus();
  }));
  return lacks;
}

absl::StatusOr<bool> IsEmpty(store::Store& store) {
  bool is_empty = true;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const StoreOrigin origin, OriginOf(transaction));
    is_empty = origin.is_empty;
    return absl::OkStatus();
  }));
  return is_empty;
}

void Tell(const CollectionReport& report, const std::filesystem::path& folder) {
  if (!report.created.empty() || !report.updated.empty()) {
    Log(LogLevel::kInfo, "loaded the collection",
        {{"folder", folder.string()},
         {"created", report.created.size()},
         {"updated", report.updated.size()}});
  }
  for (const std::string& name : report.kept) {
    Log(LogLevel::kInfo, "kept a user's own instead of what the collection has", {{"name", name}});
  }
  for (const std::string& fault : report.failed) {
    Log(LogLevel::kWarning, "the collection has something that cannot be brought in",
        {{"fault", fault}});
  }
}

}  // namespace

absl::StatusOr<CollectionReport> LoadCollection(store::Store& store,
                                                const std::filesystem::path& folder) {
  const absl::StatusOr<parametric::Collection> collection = parametric::ReadCollection(folder);
  CollectionReport report;
  if (!collection.ok()) {
    MORTISE_ASSIGN_OR_RETURN(const bool is_empty, IsEmpty(store));
    if (is_empty) return collection.status();
    report.failed.emplace_back(collection.status().message());
    Tell(report, folder);
    return report;
  }
  MORTISE_ASSIGN_OR_RETURN(const bool lacks, LacksAny(store, *collection));
  if (!lacks) return report;
  MORTISE_RETURN_IF_ERROR(store.Transact([&](store::Transaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(report, Loader(transaction).Load(*collection));
    return absl::OkStatus();
  }));
  Tell(report, folder);
  return report;
}

}  // namespace mortise::catalog
