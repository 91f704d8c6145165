// Reads, checks and stores the shipped collection.
#include "services/catalog/service/collection_loader.h"

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "common/base/digest.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "common/files/collection.h"
#include "common/messages/message_digest.h"
#include "common/resources/author.h"
#include "common/resources/resource_tags.h"
#include "services/catalog/records/assembly_records.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/shape_records.h"
#include "services/catalog/records/shipped_revisions.h"

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

// How long others that load at the same time are waited for.
constexpr absl::Duration kLoadingPatience = absl::Minutes(5);

// A collection without a number has no order.
bool IsOlder(const parametric::Collection& collection, int64_t newest) {
  return collection.number != 0 && collection.number < newest;
}

std::string DigestOf(const google::protobuf::Message& message) {
  return parametric::MessageDigest(message);
}

// Whom what ships is by.
resources::Author Shipper() { return {.user = "services/catalog", .trace_id = ""}; }

// What is there keeps its external ids and labels, whatever a collection says of them: they are its
// users'.
template <typename Message>
absl::Status KeepTagsOf(const absl::StatusOr<Message>& present, Message* message) {
  if (absl::IsNotFound(present.status())) return absl::OkStatus();
  MORTISE_RETURN_IF_ERROR(present.status());
  resources::CopyTags(*present, message);
  return absl::OkStatus();
}

// The template that exposes what can be changed of an assembly.
v1::Template TemplateOf(const v1::Assembly& assembly) {
  v1::Template message;
  message.set_name("templates" + assembly.name().substr(assembly.name().find('/')));
  message.mutable_assembly()->set_assembly(assembly.name());
  *message.mutable_labels() = assembly.labels();
  return message;
}

absl::StatusOr<int64_t> PutMaterial(store::Transaction& transaction, v1::Material material) {
  MORTISE_RETURN_IF_ERROR(CheckMaterial(material));
  MORTISE_RETURN_IF_ERROR(KeepTagsOf(GetMaterial(transaction, material.name()), &material));
  MORTISE_ASSIGN_OR_RETURN(const Replacement replaced,
                           ReplaceMaterial(transaction, material, Shipper()));
  return replaced.revision;
}

// The shapes that a collection brings, by name.
using ShapesOfCollection = std::map<std::string, const v1::Shape*>;

ShapesOfCollection ShapesOf(const parametric::Collection& collection) {
  ShapesOfCollection shapes;
  for (const v1::Shape& shape : collection.shapes) shapes[shape.name()] = &shape;
  return shapes;
}

// Writes the shape that something is about to name, if the collection brings it. So it comes with
// what names it, in one transaction, and the sweep finds it either with that or not at all.
absl::Status PutShapeNamed(store::Transaction& transaction, const ShapesOfCollection& shapes,
                           const std::string& name) {
  const auto shape = shapes.find(name);
  if (shape == shapes.end()) return absl::OkStatus();
  return PutShape(transaction, *shape->second).status();
}

absl::StatusOr<int64_t> PutItem(store::Transaction& transaction, v1::Item item,
                                const ShapesOfCollection& shapes) {
  MORTISE_RETURN_IF_ERROR(PutShapeNamed(transaction, shapes, item.shape()));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<FieldViolation> findings,
                           CheckItem(transaction, item));
  MORTISE_RETURN_IF_ERROR(parametric::ToStatus(findings));
  MORTISE_RETURN_IF_ERROR(KeepTagsOf(GetItem(transaction, item.name()), &item));
  MORTISE_ASSIGN_OR_RETURN(const Replacement replaced, ReplaceItem(transaction, item, Shipper()));
  return replaced.revision;
}

bool IsNeverGivenUp() { return false; }

absl::StatusOr<int64_t> PutAssembly(store::Transaction& transaction, const v1::Assembly& message,
                                    const ShapesOfCollection& shapes,
                                    ParametrizationCache& parametrized, int64_t present) {
  for (const v1::AssemblyPart& part : message.parts()) {
    MORTISE_RETURN_IF_ERROR(PutShapeNamed(transaction, shapes, part.shape()));
  }
  MORTISE_RETURN_IF_ERROR(resources::ValidateTags(message));
  MORTISE_ASSIGN_OR_RETURN(v1::AssemblyBundle bundle, Freeze(transaction, message));
  if (present > 0) {
    MORTISE_ASSIGN_OR_RETURN(const v1::AssemblyBundle before,
                             GetAssemblyBundle(transaction, message.name(), 0));
    resources::CopyTags(before.assembly(), bundle.mutable_assembly());
  }
  MORTISE_RETURN_IF_ERROR(parametrized.Get(bundle, IsNeverGivenUp).status());
  MORTISE_ASSIGN_OR_RETURN(const v1::Assembly stored,
                           ImportBundle(transaction, std::move(bundle), present, Shipper()));
  return stored.revision();
}

// What ships has been tried all over its design space (shipped_things_test).
absl::StatusOr<int64_t> PutTemplate(store::Transaction& transaction, const v1::Template& message,
                                    ParametrizationCache& parametrized, int64_t present) {
  MORTISE_RETURN_IF_ERROR(resources::ValidateTags(message));
  MORTISE_ASSIGN_OR_RETURN(v1::TemplateBundle bundle, Freeze(transaction, message));
  if (present > 0) {
    MORTISE_ASSIGN_OR_RETURN(const v1::TemplateBundle before,
                             GetBundle(transaction, message.name(), 0));
    resources::CopyTags(before.template_(), bundle.mutable_template_());
  }
  MORTISE_RETURN_IF_ERROR(templates::FillAndCheck(bundle, templates::Trial::kDefaults,
                                                  IsNeverGivenUp, parametrized.ForTemplates()));
  MORTISE_ASSIGN_OR_RETURN(const v1::Template stored,
                           ImportBundle(transaction, std::move(bundle), present, Shipper()));
  return stored.revision();
}

// All things of a collection, in an order in which each comes after what it uses. The others may be
// null for those who only ask what there is.
std::vector<Thing> ThingsOf(const parametric::Collection& collection,
                            store::Transaction* transaction, ParametrizationCache* parametrized) {
  std::vector<Thing> things;
  const auto shapes = std::make_shared<const ShapesOfCollection>(ShapesOf(collection));
  for (const v1::Material& message : collection.materials) {
    things.push_back({kMaterials, message.name(), DigestOf(message),
                      [=](int64_t) { return PutMaterial(*transaction, message); }});
  }
  for (const v1::Item& message : collection.items) {
    things.push_back({kItems, message.name(), DigestOf(message),
                      [=](int64_t) { return PutItem(*transaction, message, *shapes); }});
  }
  std::set<std::string> own_templates;
  for (const v1::Template& message : collection.templates) own_templates.insert(message.name());
  const auto add_template = [&](const v1::Template& message, const std::string& digest) {
    things.push_back({kTemplates, message.name(), digest,
                      [=](int64_t present) {
                        return PutTemplate(*transaction, message, *parametrized, present);
                      },
                      message.assembly().assembly()});
  };
  for (const v1::Assembly& message : collection.assemblies) {
    things.push_back({kAssemblies, message.name(), DigestOf(message), [=](int64_t present) {
                        return PutAssembly(*transaction, message, *shapes, *parametrized, present);
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

// What the store says about a thing, as it bears on what becomes of it.
absl::StatusOr<DeliveryQuestion> QuestionOf(store::ReadTransaction& transaction, const Thing& thing,
                                            bool is_newer) {
  DeliveryQuestion question;
  question.digest = thing.digest;
  question.is_newer = is_newer;
  MORTISE_ASSIGN_OR_RETURN(question.shipped, GetShippedRevision(transaction, thing.name));
  MORTISE_ASSIGN_OR_RETURN(question.present, FindPresent(transaction, thing.kind, thing.name));
  return question;
}

class Loader {
 public:
  Loader(store::Transaction& transaction, ParametrizationCache& parametrized)
      : transaction_(transaction), parametrized_(parametrized) {}

  absl::StatusOr<CollectionReport> Load(const parametric::Collection& collection) {
    MORTISE_ASSIGN_OR_RETURN(const int64_t newest, GetCollectionNumber(transaction_));
    if (IsOlder(collection, newest)) return std::move(report_);
    is_newer_ = collection.number > newest;
    MORTISE_ASSIGN_OR_RETURN(origin_, OriginOf(transaction_));
    for (const Thing& thing : ThingsOf(collection, &transaction_, &parametrized_)) {
      MORTISE_RETURN_IF_ERROR(Take(thing));
    }
    if (is_newer_) {
      MORTISE_RETURN_IF_ERROR(PutCollectionNumber(transaction_, collection.number));
    }
    return std::move(report_);
  }

 private:
  absl::Status Take(const Thing& thing) {
    MORTISE_ASSIGN_OR_RETURN(DeliveryQuestion question, QuestionOf(transaction_, thing, is_newer_));
    question.filled_at = [this] { return origin_.filled_at; };
    MORTISE_ASSIGN_OR_RETURN(Delivery delivery, DecideDelivery(question));
    if (delivery != Delivery::kNone && !thing.assembly.empty()) {
      // It would expose what a user has drawn instead.
      MORTISE_ASSIGN_OR_RETURN(const bool as_shipped, IsShippedNow(kAssemblies, thing.assembly));
      if (!as_shipped) delivery = Delivery::kKeepOwn;
    }
    // What is there stays known as what it was.
    ShippedRevision as_before = question.shipped.value_or(ShippedRevision());
    as_before.digest = thing.digest;
    as_before.failed = false;
    switch (delivery) {
      case Delivery::kNone:
        return absl::OkStatus();
      case Delivery::kKeepOwn:
        report_.kept.push_back(thing.name);
        return PutShippedRevision(transaction_, thing.name, as_before);
      case Delivery::kCreate:
      case Delivery::kUpdate:
        return Bring(thing, question.present ? question.present->revision : 0, as_before);
    }
    return absl::OkStatus();
  }

  absl::Status Bring(const Thing& thing, int64_t present, ShippedRevision as_before) {
    const absl::StatusOr<int64_t> revision = thing.put(present);
    if (!revision.ok()) {
      // Of an empty catalog the collection itself is at fault.
      if (origin_.is_empty || !IsFaultOfThing(revision.status())) {
        return UnderField(thing.name, revision.status());
      }
      report_.failed.push_back(absl::StrCat(thing.name, ": ", revision.status().message()));
      as_before.failed = true;
      return PutShippedRevision(transaction_, thing.name, as_before);
    }
    if (*revision != present) {
      (present == 0 ? report_.created : report_.updated).push_back(thing.name);
    }
    MORTISE_ASSIGN_OR_RETURN(const auto brought, FindPresent(transaction_, thing.kind, thing.name));
    return PutShippedRevision(transaction_, thing.name,
                              {.digest = thing.digest,
                               .revision = *revision,
                               .created_at = brought ? brought->created_at : absl::InfinitePast()});
  }

  absl::StatusOr<bool> IsShippedNow(const char* kind, const std::string& name) {
    MORTISE_ASSIGN_OR_RETURN(const auto shipped, GetShippedRevision(transaction_, name));
    MORTISE_ASSIGN_OR_RETURN(const auto present, FindPresent(transaction_, kind, name));
    return IsAsShipped(shipped, present);
  }

  store::Transaction& transaction_;
  ParametrizationCache& parametrized_;
  StoreOrigin origin_;
  bool is_newer_ = false;  // than all collections before
  CollectionReport report_;
};

// What there is to do with a collection.
enum class Standing {
  kOlder,  // a newer one was brought before: nothing
  kThere,  // the store has what it has: nothing
  kLacks,  // the store lacks something of it
};

// As it looks without keeping others from writing.
absl::StatusOr<Standing> StandingOf(store::Store& store, const parametric::Collection& collection) {
  Standing standing = Standing::kThere;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    MORTISE_ASSIGN_OR_RETURN(const int64_t newest, GetCollectionNumber(transaction));
    standing = IsOlder(collection, newest) ? Standing::kOlder : Standing::kThere;
    if (standing == Standing::kOlder) return absl::OkStatus();
    const bool is_newer = collection.number > newest;
    if (is_newer) standing = Standing::kLacks;
    std::optional<StoreOrigin> origin;  // looked for where the store does not say what was shipped
    const auto filled_at = [&]() -> absl::StatusOr<absl::Time> {
      if (!origin) {
        MORTISE_ASSIGN_OR_RETURN(origin, OriginOf(transaction));
      }
      return origin->filled_at;
    };
    for (const Thing& thing : ThingsOf(collection, nullptr, nullptr)) {
      if (standing == Standing::kLacks) break;
      MORTISE_ASSIGN_OR_RETURN(DeliveryQuestion question, QuestionOf(transaction, thing, is_newer));
      question.filled_at = filled_at;
      MORTISE_ASSIGN_OR_RETURN(const Delivery delivery, DecideDelivery(question));
      if (delivery != Delivery::kNone) standing = Standing::kLacks;
    }
    return absl::OkStatus();
  }));
  return standing;
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
                                                const std::filesystem::path& folder,
                                                ParametrizationCache& parametrized) {
  const absl::StatusOr<parametric::Collection> collection = parametric::ReadCollection(folder);
  CollectionReport report;
  if (!collection.ok()) {
    MORTISE_ASSIGN_OR_RETURN(const bool is_empty, IsEmpty(store));
    if (is_empty) return collection.status();
    report.failed.emplace_back(collection.status().message());
    Tell(report, folder);
    return report;
  }
  const absl::Time deadline = absl::Now() + kLoadingPatience;
  while (true) {
    MORTISE_ASSIGN_OR_RETURN(const Standing standing, StandingOf(store, *collection));
    report = CollectionReport();
    if (standing == Standing::kOlder) {
      Log(LogLevel::kInfo, "left the collection alone, as the store has a newer one",
          {{"folder", folder.string()}, {"number", collection->number}});
    }
    if (standing != Standing::kLacks) return report;
    const absl::Status loaded =
        store.Transact([&](store::Transaction& transaction) -> absl::Status {
          MORTISE_ASSIGN_OR_RETURN(report, Loader(transaction, parametrized).Load(*collection));
          return absl::OkStatus();
        });
    if (loaded.ok()) break;
    // Others got in the way, as another catalog does that starts at the same time: one of the two
    // has loaded it then.
    if (!absl::IsUnavailable(loaded) || absl::Now() >= deadline) return loaded;
  }
  Tell(report, folder);
  return report;
}

}  // namespace mortise::catalog
