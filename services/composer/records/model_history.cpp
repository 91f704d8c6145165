#include "services/composer/records/model_history.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "common/base/errors.h"
#include "common/base/violation_lists.h"
#include "common/messages/vector_codec.h"
#include "common/resources/record_page.h"
#include "services/composer/records/model_records.h"

namespace mortise::composer {
namespace {

constexpr double kMoved = 1e-9;  // m

// A part by what it is of, the body (empty) or a loose component, and its name there.
using PartKey = std::pair<std::string, std::string>;

std::map<PartKey, const v1::ModelPart*> PartsByKey(const v1::Model& model) {
  std::set<std::string> loose;
  for (const v1::ModelComponent& component : model.components()) {
    if (component.state() != v1::ModelComponent::CONNECTED) loose.insert(component.id());
  }
  std::map<PartKey, const v1::ModelPart*> parts;
  for (const v1::ModelPart& part : model.parts()) {
    const bool is_loose = loose.contains(part.component());
    parts.emplace(PartKey(is_loose ? part.component() : "", part.name()), &part);
  }
  return parts;
}

double Apart(const v1::Vector3& a, const v1::Vector3& b) {
  return (VectorFromProto(a) - VectorFromProto(b)).cwiseAbs().maxCoeff();
}

bool IsSame(const v1::ModelPart& a, const v1::ModelPart& b) {
  return a.component() == b.component() && a.item() == b.item() && a.group() == b.group() &&
         std::max(Apart(a.minimum(), b.minimum()), Apart(a.maximum(), b.maximum())) <= kMoved;
}

void AddPart(const v1::ModelPart& part, v1::ModelStep::Change change, v1::ModelStep* step,
             std::set<std::string>& touched) {
  v1::ModelStep::Part* const added = step->add_parts();
  added->set_name(part.name());
  added->set_component(part.component());
  added->set_change(change);
  touched.insert(part.component());
}

void AddComponent(const std::string& id, v1::ModelStep::Change change, v1::ModelStep* step) {
  v1::ModelStep::Component* const added = step->add_components();
  added->set_id(id);
  added->set_change(change);
}

std::string KeyOf(const std::string& name, std::int64_t revision) {
  return absl::StrFormat("%s/%012d", name.substr(name.find('/') + 1), revision);
}

}  // namespace

void AddChanges(const v1::Model& before, const v1::Model& after, v1::ModelStep* step) {
  std::set<std::string> touched;  // components
  auto left = PartsByKey(before);
  for (const auto& [key, part] : PartsByKey(after)) {
    const auto found = left.find(key);
    if (found == left.end()) {
      AddPart(*part, v1::ModelStep::ADDED, step, touched);
      continue;
    }
    if (!IsSame(*found->second, *part)) AddPart(*part, v1::ModelStep::CHANGED, step, touched);
    left.erase(found);
  }
  for (const auto& [key, part] : left) AddPart(*part, v1::ModelStep::REMOVED, step, touched);
  std::map<std::string, v1::ModelComponent::State> states;
  for (const v1::ModelComponent& component : before.components()) {
    states[component.id()] = component.state();
  }
  for (const v1::ModelComponent& component : after.components()) {
    const auto found = states.find(component.id());
    if (found == states.end()) {
      AddComponent(component.id(), v1::ModelStep::ADDED, step);
      continue;
    }
    if (found->second != component.state() || touched.contains(component.id())) {
      AddComponent(component.id(), v1::ModelStep::CHANGED, step);
    }
    states.erase(found);
  }
  for (const auto& [id, state] : states) AddComponent(id, v1::ModelStep::REMOVED, step);
}

absl::Status PutRevision(store::Transaction& transaction, const v1::Model& head,
                         const std::string& text, const v1::Model& before, const v1::Model& after,
                         const resources::Author& author) {
  v1::ModelStep step;
  step.set_revision(head.revision());
  step.set_text(text);
  step.set_user(author.user);
  *step.mutable_time() = head.update_time();
  step.set_digest(head.digest());
  AddChanges(before, after, &step);
  return transaction.Put(kRevisions, KeyOf(head.name(), head.revision()), step.SerializeAsString())
      .status();
}

absl::StatusOr<v1::ListModelStepsResponse> ReadRevisions(store::Store& store,
                                                         const v1::ListModelStepsRequest& asked) {
  absl::Status findings = resources::ReadPageQuery(asked).status();
  if (asked.after_revision() < 0) {
    findings = CombineViolations(findings, InvalidField("after_revision", "must not be negative"));
  }
  MORTISE_RETURN_IF_ERROR(findings);
  MORTISE_ASSIGN_OR_RETURN(resources::PageQuery query, resources::ReadPageQuery(asked));
  if (query.after.empty()) query.after = KeyOf(asked.name(), asked.after_revision());
  using Steps = resources::Page<v1::ModelStep>;
  MORTISE_ASSIGN_OR_RETURN(
      Steps page, resources::ReadFrom<Steps>(
                      store, [&](store::ReadTransaction& transaction) -> absl::StatusOr<Steps> {
                        MORTISE_RETURN_IF_ERROR(kModels.Get(transaction, asked.name()).status());
                        const std::string prefix =
                            asked.name().substr(asked.name().find('/') + 1) + "/";
                        return resources::ReadPage<v1::ModelStep>(
                            transaction, {.kind = kRevisions, .key_prefix = prefix}, query);
                      }));
  return resources::ToResponse(std::move(page), &v1::ListModelStepsResponse::mutable_steps);
}

}  // namespace mortise::composer
