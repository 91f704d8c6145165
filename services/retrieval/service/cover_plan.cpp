#include "services/retrieval/service/cover_plan.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/logging.h"
#include "services/retrieval/service/cover_making.h"
#include "services/retrieval/service/cover_queue.h"
#include "services/retrieval/service/index_records.h"

namespace mortise::retrieval {
namespace {

// What is known of a template without making designs; `compiled` is null where the template cannot
// be compiled.
v1::ShapeIndex::Family FamilyOf(const v1::Template& head, const std::string& group,
                                const SearchedTemplate* compiled) {
  v1::ShapeIndex::Family family;
  family.set_template_(head.name());
  family.set_group(group);
  family.set_template_revision(head.revision());
  resources::CopyTags(head, &family);
  family.set_creator(head.creator());
  *family.mutable_create_time() = head.create_time();
  family.set_title(compiled ? compiled->title : head.title());
  if (!compiled) return family;
  const templates::TemplateHead& made = compiled->design_template->head();
  for (const parametric::Parameter& each : made.parameters) family.add_parameters(each.name);
  for (const parametric::Item& each : made.items) family.add_items(each.name);
  for (const parametric::Material& each : made.materials) family.add_materials(each.name);
  return family;
}

// What the cover of a family says of its designs, with what is known of its template now.
v1::ShapeIndex::Family WithDesignsOf(v1::ShapeIndex::Family family,
                                     const v1::ShapeIndex::Family& known) {
  family.set_structures(known.structures());
  family.set_points(known.points());
  family.set_tangents(known.tangents());
  family.set_evaluations(known.evaluations());
  family.set_failed_evaluations(known.failed_evaluations());
  family.set_truncated(known.truncated());
  family.set_interpolation_error(known.interpolation_error());
  family.set_digest(known.digest());
  return family;
}

}  // namespace

rpc::Origin CoverPlan::Origin() const {
  return rpc::OwnOrigin(building_.environment.signer, rpc::Role::kViewer, CurrentTraceId(),
                        kCatalogTimeout);
}

absl::Status CoverPlan::Prepare(const std::vector<v1::Template>& templates, bool refresh) {
  std::set<std::string> names;
  for (const v1::Template& each : templates) names.insert(each.name());
  for (IndexTarget& target : targets_) {
    MORTISE_ASSIGN_OR_RETURN(std::set<std::string> outdated, ForgetOthers(names, target));
    if (refresh) {
      target.wanted.emplace();
      const absl::StatusOr<v1::ShapeIndex> present =
          kIndexes.Get(*building_.environment.store, absl::StrCat(kIndexes.names, "/", target.id));
      if (!present.ok() && !absl::IsNotFound(present.status())) return present.status();
      if (present.ok()) {
        for (const auto& each : present->families()) target.wanted->insert(each.template_());
      }
    }
    if (target.wanted) target.wanted->merge(outdated);
  }
  return absl::OkStatus();
}

// Returns which templates have covers of an earlier version.
absl::StatusOr<std::set<std::string>> CoverPlan::ForgetOthers(const std::set<std::string>& names,
                                                              const IndexTarget& target) {
  std::set<std::string> outdated;
  MORTISE_RETURN_IF_ERROR(context_.Transact([&](store::Transaction& transaction) -> absl::Status {
    outdated.clear();
    MORTISE_ASSIGN_OR_RETURN(const std::vector<v1::ShapeIndex> covers,
                             ListCovers(transaction, target.id));
    for (const v1::ShapeIndex& cover : covers) {
      const std::string& name = cover.families(0).template_();
      if (!names.contains(name)) {
        MORTISE_RETURN_IF_ERROR(
            DeleteCover(transaction, target.id, name, cover.families(0).group()));
      } else if (cover.delta() == target.delta && !IsOfThisVersion(cover, *target.descriptor)) {
        outdated.insert(name);
      }
    }
    return absl::OkStatus();
  }));
  return outdated;
}

bool CoverPlan::IsAskedFor(const v1::Template& head) const {
  return std::any_of(targets_.begin(), targets_.end(),
                     [&](const IndexTarget& target) { return target.Wants(head.name()); });
}

absl::StatusOr<std::set<std::string>> CoverPlan::Plan(const v1::Template& head) {
  Targets targets;
  for (const IndexTarget& target : targets_) {
    if (target.Wants(head.name())) targets.push_back(&target);
  }
  std::set<std::string> keys;
  if (targets.empty()) return keys;
  MORTISE_RETURN_IF_ERROR(PlanGroup(head, "", targets, &keys).status());
  const auto whole = building_.templates.Get(head.name(), head.revision(), Origin());
  if (absl::IsNotFound(whole.status())) return keys;  // removed meanwhile
  std::set<std::string> groups;
  for (const std::string& group : whole.ok() ? GroupsOf(**whole) : std::vector<std::string>{}) {
    if (context_.Cancelled()) return keys;
    MORTISE_ASSIGN_OR_RETURN(const bool is_thing, PlanGroup(head, group, targets, &keys));
    if (is_thing) groups.insert(group);
  }
  for (const IndexTarget* const target : targets) {
    MORTISE_RETURN_IF_ERROR(ForgetOtherGroups(*target, head.name(), groups));
  }
  return keys;
}

// The whole, or the sub-tree below a group of it. Returns whether there is such a thing: not every
// sub-tree holds together by itself.
absl::StatusOr<bool> CoverPlan::PlanGroup(const v1::Template& head, const std::string& group,
                                          const Targets& targets, std::set<std::string>* keys) {
  const absl::StatusOr<std::shared_ptr<const SearchedTemplate>> compiled =
      building_.templates.Get(head.name(), head.revision(), Origin(), group);
  if (absl::IsNotFound(compiled.status())) return false;  // removed meanwhile
  // Only what is wrong with the template itself is told in its cover.
  if (IsPassingFailure(compiled.status())) return compiled.status();
  if (!compiled.ok() && !group.empty()) {
    Log(LogLevel::kInfo, "a sub-tree is no template by itself",
        {{"template", head.name()}, {"group", group}, {"error", compiled.status().message()}});
    return false;
  }
  v1::CoverTask task;
  *task.mutable_family() = FamilyOf(head, group, compiled.ok() ? compiled->get() : nullptr);
  task.set_trace_id(CurrentTraceId());
  task.set_anew(anew_);
  bool lacks_any = false;
  for (const IndexTarget* const target : targets) {
    const std::string content = compiled.ok() ? (*compiled)->digest : head.digest();
    const std::string digest = CoverDigest(*target->descriptor, target->delta, content);
    if (!compiled.ok()) {
      MORTISE_RETURN_IF_ERROR(PutFault(*target, task.family(), digest, compiled.status()));
      continue;
    }
    v1::WantedCover& wanted = *task.add_covers();
    wanted.set_shape_descriptor(target->kind);
    wanted.set_delta(target->delta);
    wanted.set_digest(digest);
    MORTISE_ASSIGN_OR_RETURN(const bool is_known, BringUp(*target, task.family(), digest));
    lacks_any = lacks_any || !is_known;
  }
  if (lacks_any) {
    // With those that are known: what another run of this build has queued is the same task.
    MORTISE_ASSIGN_OR_RETURN(std::string key, building_.covers.Enqueue(task));
    keys->insert(std::move(key));
  }
  return true;
}

// Whether there is the cover already, and its file is as it was written. What is said about the
// template may be new.
absl::StatusOr<bool> CoverPlan::BringUp(const IndexTarget& target,
                                        const v1::ShapeIndex::Family& family,
                                        const std::string& digest) {
  if (anew_) return false;
  MORTISE_ASSIGN_OR_RETURN(
      const std::optional<v1::ShapeIndex> known,
      resources::ReadFrom<std::optional<v1::ShapeIndex>>(
          *building_.environment.store, [&](store::ReadTransaction& transaction) {
            return FindCover(transaction, target.id, family.template_(), family.group());
          }));
  const bool is_it =
      known && known->families(0).digest() == digest && known->families(0).fault().empty();
  if (!is_it) return false;
  if (!ReadCover(*building_.blobs, known->sha256(), *target.descriptor).ok()) {
    MORTISE_RETURN_IF_ERROR(context_.Transact([&](store::Transaction& transaction) {
      return DeleteCover(transaction, target.id, family.template_(), family.group());
    }));
    return false;
  }
  v1::ShapeIndex now = *known;
  *now.mutable_families(0) = WithDesignsOf(family, known->families(0));
  now.set_format_version(kIndexFormat);
  now.set_descriptor_version(target.descriptor->properties().version);
  if (google::protobuf::util::MessageDifferencer::Equals(*known, now)) return true;
  MORTISE_RETURN_IF_ERROR(context_.Transact(
      [&](store::Transaction& transaction) { return PutCover(transaction, target.id, now); }));
  return true;
}

absl::Status CoverPlan::PutFault(const IndexTarget& target, v1::ShapeIndex::Family family,
                                 const std::string& digest, const absl::Status& fault) {
  Log(LogLevel::kWarning, "a template cannot be searched",
      {{"template", family.template_()}, {"index", target.id}, {"error", fault.message()}});
  family.set_digest(digest);
  family.set_fault(std::string(fault.message()));
  const v1::ShapeIndex cover = EmptyCover(target.kind, target.delta, *target.descriptor, family);
  return context_.Transact(
      [&](store::Transaction& transaction) { return PutCover(transaction, target.id, cover); });
}

// Covers of groups that the template has no more.
absl::Status CoverPlan::ForgetOtherGroups(const IndexTarget& target, const std::string& name,
                                          const std::set<std::string>& groups) {
  const auto list = [&](store::ReadTransaction& transaction) {
    return ListGroupCovers(transaction, target.id, name);
  };
  MORTISE_ASSIGN_OR_RETURN(
      const std::vector<v1::ShapeIndex> covers,
      resources::ReadFrom<std::vector<v1::ShapeIndex>>(*building_.environment.store, list));
  std::vector<std::string> gone;
  for (const v1::ShapeIndex& cover : covers) {
    const std::string& group = cover.families(0).group();
    if (!groups.contains(group)) gone.push_back(group);
  }
  if (gone.empty()) return absl::OkStatus();
  return context_.Transact([&](store::Transaction& transaction) -> absl::Status {
    for (const std::string& group : gone) {
      MORTISE_RETURN_IF_ERROR(DeleteCover(transaction, target.id, name, group));
    }
    return absl::OkStatus();
  });
}

}  // namespace mortise::retrieval
