#include "services/composer/records/model_history.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
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

std::set<std::string> LooseOf(const v1::Model& model) {
  std::set<std::string> loose;
  for (const v1::ModelComponent& component : model.components()) {
    if (component.state() != v1::ModelComponent::CONNECTED) loose.insert(component.id());
  }
  return loose;
}

std::map<PartKey, const v1::ModelPart*> PartsByKey(const v1::Model& model) {
  const std::set<std::string> loose = LooseOf(model);
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

// The hierarchy of a model, to find what parts are below.
class Nodes {
 public:
  explicit Nodes(const v1::Model& model) : loose_(LooseOf(model)) {
    for (const v1::ModelGroup& group : model.groups()) {
      parent_of_[{group.component(), group.name()}] = group.parent();
    }
  }

  // Adds the element and the groups that a part is in, the innermost first, but for those that are
  // there already.
  void AddOf(const v1::ModelPart& part, v1::ModelStep::Part* step) const {
    const std::string& of = loose_.contains(part.component()) ? part.component() : kBody;
    Add(part.element(), step);
    std::string group = part.group();
    while (!group.empty()) {
      Add(group, step);
      const auto parent = parent_of_.find({of, group});
      group = parent == parent_of_.end() ? "" : parent->second;
    }
  }

 private:
  static void Add(const std::string& node, v1::ModelStep::Part* step) {
    const auto& nodes = step->nodes();
    if (std::find(nodes.begin(), nodes.end(), node) == nodes.end()) step->add_nodes(node);
  }

  inline static const std::string kBody;

  const std::set<std::string> loose_;
  std::map<PartKey, std::string> parent_of_;
};

v1::ModelStep::Part* AddPart(const v1::ModelPart& part, v1::ModelStep::Change change,
                             v1::ModelStep* step, std::set<std::string>& touched) {
  v1::ModelStep::Part* const added = step->add_parts();
  added->set_name(part.name());
  added->set_component(part.component());
  added->set_change(change);
  touched.insert(part.component());
  return added;
}

void AddComponent(const std::string& id, v1::ModelStep::Change change, v1::ModelStep* step) {
  v1::ModelStep::Component* const added = step->add_components();
  added->set_id(id);
  added->set_change(change);
}

std::string KeyOf(const std::string& name, std::int64_t revision) {
  return absl::StrFormat("%s/%012d", name.substr(name.find('/') + 1), revision);
}

constexpr std::int64_t kMostSteps = 1000;  // that are looked through
constexpr std::size_t kMostNamed = 5;      // parts of a step

// What of that which is named a step has changed: the component, or parts.
std::vector<std::string> TouchedBy(const v1::ModelStep& step, const NamedNode& named) {
  std::vector<std::string> touched;
  if (!named.component.empty()) {
    for (const v1::ModelStep::Component& component : step.components()) {
      if (component.id() == named.component) touched.push_back(component.id());
    }
  }
  if (!named.node) return touched;
  for (const v1::ModelStep::Part& part : step.parts()) {
    const auto& nodes = part.nodes();
    // Steps of earlier versions do not tell of nodes.
    if (named.node->empty() || nodes.empty() || part.name() == *named.node ||
        std::find(nodes.begin(), nodes.end(), *named.node) != nodes.end()) {
      touched.push_back(part.name());
    }
  }
  return touched;
}

// "revision 5, 'drag width' by ada, changed 'shelf 1' and 'shelf 2'".
std::string Describe(const v1::ModelStep& step, const std::vector<std::string>& touched) {
  const std::size_t named = std::min(touched.size(), kMostNamed);
  return absl::StrCat(
      "revision ", step.revision(), ", '", step.text(), "' by ", step.user(), ", changed '",
      absl::StrJoin(touched.begin(), touched.begin() + static_cast<std::ptrdiff_t>(named), "', '"),
      "'", touched.size() > named ? absl::StrCat(" and ", touched.size() - named, " more") : "");
}

}  // namespace

void AddChanges(const v1::Model& before, const v1::Model& after, v1::ModelStep* step) {
  std::set<std::string> touched;  // components
  const Nodes nodes_before(before), nodes_after(after);
  auto left = PartsByKey(before);
  for (const auto& [key, part] : PartsByKey(after)) {
    const auto found = left.find(key);
    if (found == left.end()) {
      nodes_after.AddOf(*part, AddPart(*part, v1::ModelStep::ADDED, step, touched));
      continue;
    }
    if (!IsSame(*found->second, *part)) {
      v1::ModelStep::Part* const added = AddPart(*part, v1::ModelStep::CHANGED, step, touched);
      nodes_after.AddOf(*part, added);
      nodes_before.AddOf(*found->second, added);
    }
    left.erase(found);
  }
  for (const auto& [key, part] : left) {
    nodes_before.AddOf(*part, AddPart(*part, v1::ModelStep::REMOVED, step, touched));
  }
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

absl::Status CheckUntouched(store::ReadTransaction& transaction, const v1::Model& head,
                            std::int64_t revision, const NamedNode& named) {
  const std::int64_t present = head.revision();
  if (revision < 1 || revision > present || present - revision > kMostSteps) {
    return StaleRevision(head.name(), revision, present);
  }
  std::vector<std::string> changes;
  for (std::int64_t number = revision + 1; number <= present; ++number) {
    const absl::StatusOr<store::Record> record =
        transaction.Get(kRevisions, KeyOf(head.name(), number));
    // Of what earlier versions made there is no record.
    if (absl::IsNotFound(record.status())) return StaleRevision(head.name(), revision, present);
    MORTISE_RETURN_IF_ERROR(record.status());
    MORTISE_ASSIGN_OR_RETURN(const v1::ModelStep step,
                             resources::ParseRecord<v1::ModelStep>(kRevisions, *record));
    const std::vector<std::string> touched = TouchedBy(step, named);
    if (!touched.empty()) changes.push_back(Describe(step, touched));
  }
  if (changes.empty()) return absl::OkStatus();
  return WithDetail(
      absl::AbortedError(absl::StrCat("what this is about has changed since revision ", revision,
                                      ": ", absl::StrJoin(changes, "; "), "; read '", head.name(),
                                      "' again, and repeat the change if it is still wanted")),
      {"REBASE_CONFLICT", head.name()});
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
