// Checks everything of an import, then writes it.
#include "services/catalog/service/catalog_import.h"

#include <algorithm>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/identifiers.h"
#include "common/base/violation_lists.h"
#include "common/design/template_validation.h"
#include "common/resources/resource_tags.h"
#include "services/catalog/records/catalog_records.h"
#include "services/catalog/records/near_names.h"
#include "services/catalog/records/pending_records.h"
#include "services/catalog/records/record_access.h"
#include "services/catalog/records/record_tags.h"

namespace mortise::catalog {
namespace {

constexpr int kMaxRows = 10'000;  // materials and items
constexpr int kMaxTemplates = 100;

std::string At(const char* list, int index) { return absl::StrCat(list, "[", index, "]"); }

absl::Status CheckCounts(const v1::ImportCatalogRequest& request) {
  if (request.materials_size() > kMaxRows) {
    return InvalidField("materials", absl::StrCat("must be at most ", kMaxRows));
  }
  if (request.items_size() > kMaxRows - request.materials_size()) {
    return InvalidField("items", absl::StrCat("must be at most ", kMaxRows, " with materials"));
  }
  if (request.templates_size() > kMaxTemplates) {
    return InvalidField("templates", absl::StrCat("must be at most ", kMaxTemplates));
  }
  return absl::OkStatus();
}

// Everything that is wrong with the things of a request.
class Faults {
 public:
  // What is wrong with the thing of this name at `place`. Failures that say nothing of fields are
  // given back.
  absl::Status Add(const std::string& place, const std::string& name, const absl::Status& status) {
    if (!status.ok() && !absl::IsInvalidArgument(status)) return UnderField(place, status);
    if (!status.ok()) at_fault_.insert(name);
    for (FieldViolation& violation : AllViolationsOf(status)) {
      violation.field = absl::StrCat(place, violation.field.empty() ? "" : ".", violation.field);
      violations_.push_back(std::move(violation));
    }
    return absl::OkStatus();
  }

  // That a name is there a second time.
  void AddName(const std::string& place, const std::string& name) {
    if (names_.insert(name).second) return;
    violations_.push_back({place + ".name", absl::StrCat("'", name, "' is there twice")});
    at_fault_.insert(name);
  }

  // Whether something is wrong with a thing of this name.
  bool IsAtFault(const std::string& name) const { return at_fault_.count(name) != 0; }

  absl::Status AsStatus() const {
    return violations_.empty() ? absl::OkStatus() : InvalidFields(violations_);
  }

 private:
  std::vector<FieldViolation> violations_;
  std::set<std::string> names_, at_fault_;
};

absl::Status CheckRow(store::ReadTransaction& transaction, const v1::Item& item) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<FieldViolation> findings,
                           CheckItem(transaction, item));
  return parametric::ToStatus(findings);
}

template <typename Message>
void AddTo(PendingRecords& pending, const char* kind, const Message& message) {
  const absl::StatusOr<std::string> id = ParseResourceName(message.name(), kind, "name");
  // One that is malformed is found to be.
  if (id.ok()) pending.Add(kind, *id, message.SerializeAsString());
}

// Checks materials and items, and adds them to `pending`.
absl::Status CheckRows(const v1::ImportCatalogRequest& request, PendingRecords& pending,
                       Faults& faults) {
  for (const v1::Material& material : request.materials()) AddTo(pending, kMaterials, material);
  for (const v1::Item& item : request.items()) AddTo(pending, kItems, item);
  for (int i = 0; i < request.materials_size(); ++i) {
    const v1::Material& material = request.materials(i);
    faults.AddName(At("materials", i), material.name());
    MORTISE_RETURN_IF_ERROR(
        faults.Add(At("materials", i), material.name(), CheckMaterial(material)));
  }
  for (int i = 0; i < request.items_size(); ++i) {
    const v1::Item& item = request.items(i);
    faults.AddName(At("items", i), item.name());
    MORTISE_RETURN_IF_ERROR(faults.Add(At("items", i), item.name(), CheckRow(pending, item)));
  }
  return absl::OkStatus();
}

// Whether a template is to use something that is at fault itself. An assembly is stored already.
bool UsesWhatIsAtFault(const v1::TemplateBundle& bundle, const Faults& faults) {
  const v1::Template& message = bundle.template_();
  if (message.has_assembly()) return false;
  const auto is_at_fault = [&](const std::string& name) { return faults.IsAtFault(name); };
  const std::set<std::string> items = templates::ItemsOf(message);
  const std::set<std::string> materials = templates::MaterialsOf(message);
  return std::any_of(items.begin(), items.end(), is_at_fault) ||
         std::any_of(materials.begin(), materials.end(), is_at_fault) ||
         std::any_of(bundle.materials().begin(), bundle.materials().end(),
                     [&](const v1::Material& material) { return is_at_fault(material.name()); });
}

// The templates with what they use, stored or pending; empty where something is at fault.
absl::Status FreezeTemplates(const v1::ImportCatalogRequest& request, PendingRecords& pending,
                             Faults& faults, std::vector<v1::TemplateBundle>& frozen) {
  for (int i = 0; i < request.templates_size(); ++i) {
    const std::string place = At("templates", i);
    const v1::Template& message = request.templates(i);
    faults.AddName(place, message.name());
    const absl::Status name = ParseResourceName(message.name(), kTemplates, "name").status();
    MORTISE_RETURN_IF_ERROR(faults.Add(place, message.name(), name));
    const absl::Status tags = resources::ValidateTags(message);
    MORTISE_RETURN_IF_ERROR(faults.Add(place, message.name(), tags));
    absl::StatusOr<v1::TemplateBundle> bundle = Freeze(pending, message);
    MORTISE_RETURN_IF_ERROR(faults.Add(place, message.name(), bundle.status()));
    const bool can_be_judged = name.ok() && bundle.ok() && !UsesWhatIsAtFault(*bundle, faults);
    frozen.push_back(can_be_judged ? *std::move(bundle) : v1::TemplateBundle());
  }
  return absl::OkStatus();
}

// What was pending has a revision and a time now.
absl::Status TakeAsStored(store::ReadTransaction& transaction, v1::TemplateBundle& bundle) {
  for (v1::Item& item : *bundle.mutable_items()) {
    if (item.revision() > 0) continue;
    MORTISE_ASSIGN_OR_RETURN(item, GetItem(transaction, item.name()));
  }
  for (v1::Material& material : *bundle.mutable_materials()) {
    if (material.revision() > 0) continue;
    MORTISE_ASSIGN_OR_RETURN(material, GetMaterial(transaction, material.name()));
  }
  return absl::OkStatus();
}

absl::StatusOr<Replacement> StoreTemplate(store::Transaction& transaction,
                                          v1::TemplateBundle bundle,
                                          const resources::Author& author) {
  MORTISE_RETURN_IF_ERROR(TakeAsStored(transaction, bundle));
  v1::Template& message = *bundle.mutable_template_();
  const absl::StatusOr<v1::TemplateBundle> present = GetBundle(transaction, message.name(), 0);
  if (!absl::IsNotFound(present.status())) MORTISE_RETURN_IF_ERROR(present.status());
  if (present.ok()) KeepTags(present->template_(), &message);
  const int64_t before = present.ok() ? present->template_().revision() : 0;
  MORTISE_ASSIGN_OR_RETURN(const v1::Template stored,
                           ImportBundle(transaction, std::move(bundle), before, author));
  return Replacement{before, stored.revision()};
}

void Note(const std::string& name, const Replacement& replaced, v1::ImportCatalogResponse& answer) {
  using Change = v1::ImportCatalogResponse::Change;
  Change& change = *answer.add_changes();
  change.set_name(name);
  change.set_revision(replaced.revision);
  if (replaced.before == 0) {
    change.set_kind(Change::CREATED);
    answer.set_created_count(answer.created_count() + 1);
  } else if (replaced.revision != replaced.before) {
    change.set_kind(Change::UPDATED);
    answer.set_updated_count(answer.updated_count() + 1);
  } else {
    change.set_kind(Change::UNCHANGED);
    answer.set_unchanged_count(answer.unchanged_count() + 1);
  }
}

}  // namespace

absl::StatusOr<std::vector<v1::TemplateBundle>> PrepareImport(
    store::Store& store, const v1::ImportCatalogRequest& request,
    const std::function<bool()>& is_given_up, const templates::Parametrize& parametrize) {
  MORTISE_RETURN_IF_ERROR(CheckCounts(request));
  Faults faults;
  std::vector<v1::TemplateBundle> bundles;
  MORTISE_RETURN_IF_ERROR(store.Read([&](store::ReadTransaction& transaction) -> absl::Status {
    PendingRecords pending(transaction);
    MORTISE_RETURN_IF_ERROR(CheckRows(request, pending, faults));
    return FreezeTemplates(request, pending, faults, bundles);
  }));
  for (int i = 0; i < static_cast<int>(bundles.size()); ++i) {
    v1::TemplateBundle& bundle = bundles[static_cast<std::size_t>(i)];
    if (!bundle.has_template_()) continue;
    absl::Status wrong =
        templates::FillAndCheck(bundle, templates::Trial::kThorough, is_given_up, parametrize);
    if (absl::IsInvalidArgument(wrong)) {
      wrong = store.Read([&](store::ReadTransaction& transaction) {
        return WithNearItems(transaction, templates::ItemsOf(request.templates(i)), wrong);
      });
    }
    MORTISE_RETURN_IF_ERROR(faults.Add(At("templates", i), request.templates(i).name(), wrong));
  }
  MORTISE_RETURN_IF_ERROR(faults.AsStatus());
  return bundles;
}

absl::StatusOr<v1::ImportCatalogResponse> ImportCatalog(
    store::Transaction& transaction, const v1::ImportCatalogRequest& request,
    const std::vector<v1::TemplateBundle>& templates, const resources::Author& author) {
  // Once more, as others may have removed what is used.
  PendingRecords pending(transaction);
  Faults faults;
  MORTISE_RETURN_IF_ERROR(CheckRows(request, pending, faults));
  MORTISE_RETURN_IF_ERROR(faults.AsStatus());
  v1::ImportCatalogResponse answer;
  for (const v1::Material& material : request.materials()) {
    MORTISE_ASSIGN_OR_RETURN(const Replacement replaced,
                             ReplaceMaterial(transaction, material, author));
    Note(material.name(), replaced, answer);
  }
  for (const v1::Item& item : request.items()) {
    MORTISE_ASSIGN_OR_RETURN(const Replacement replaced, ReplaceItem(transaction, item, author));
    Note(item.name(), replaced, answer);
  }
  for (const v1::TemplateBundle& bundle : templates) {
    MORTISE_ASSIGN_OR_RETURN(const Replacement replaced,
                             StoreTemplate(transaction, bundle, author));
    Note(bundle.template_().name(), replaced, answer);
  }
  return answer;
}

}  // namespace mortise::catalog
