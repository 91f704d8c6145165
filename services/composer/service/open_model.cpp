#include "services/composer/service/open_model.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"
#include "common/messages/vector_codec.h"

namespace mortise::composer {
namespace {

using parametric::Assembly;
using parametric::BoundingBox;
using parametric::Element;
using parametric::PlacedPart;

std::string GroupName(const Assembly& assembly, int group) {
  return group <= 0 ? "" : assembly.groups[static_cast<std::size_t>(group)].name;
}

// The box around parts of one component, of the principal ones where there are some.
class ComponentBox {
 public:
  void Add(const BoundingBox& box, bool connecting) {
    (connecting ? connecting_ : principal_).Add(box);
  }

  void SetOf(v1::ModelComponent* component) const {
    const Sum& sum = principal_.box ? principal_ : connecting_;
    if (!sum.box) return;
    *component->mutable_minimum() = VectorToProto(sum.box->minimum);
    *component->mutable_maximum() = VectorToProto(sum.box->maximum);
  }

 private:
  struct Sum {
    void Add(const BoundingBox& other) {
      if (!box) box = other;
      box->minimum = box->minimum.cwiseMin(other.minimum);
      box->maximum = box->maximum.cwiseMax(other.maximum);
    }
    std::optional<BoundingBox> box;
  };
  Sum principal_, connecting_;
};

// Adds the parts and groups of a design to what clients see.
void Show(const OpenModel& model, const std::string& component, const Design& design,
          std::map<std::string, ComponentBox>& boxes, v1::Model* shown) {
  for (v1::ModelPart& part : ShownParts(model, component, design)) {
    boxes[part.component()].Add({VectorFromProto(part.minimum()), VectorFromProto(part.maximum())},
                                part.connecting());
    *shown->add_parts() = std::move(part);
  }
  const Assembly& assembly = design.assembly->assembly();
  for (std::size_t i = 1; i < assembly.groups.size(); ++i) {
    v1::ModelGroup* const group = shown->add_groups();
    group->set_name(assembly.groups[i].name);
    group->set_parent(GroupName(assembly, assembly.groups[i].parent));
    group->set_component(component);
  }
}

}  // namespace

absl::StatusOr<OpenModel> Open(const StoredModel& stored, ModelDrawings& drawings,
                               const IsGivenUp& is_given_up) {
  const ModelState& state = stored.state;
  OpenModel model;
  model.name = stored.head.name();
  if (state.has_body()) {
    MORTISE_ASSIGN_OR_RETURN(Design body, drawings.DesignOf(model.name, state.body(), is_given_up));
    model.body = OpenDesign{state.body().drawing(), state.body().group(), std::move(body)};
  }
  for (const PartOwner& owner : state.owners()) {
    model.owners[owner.part()] = owner.component();
    if (owner.borrowed()) model.borrowed.insert(owner.part());
  }
  for (const LooseComponent& loose : state.loose()) {
    MORTISE_ASSIGN_OR_RETURN(Design design,
                             drawings.DesignOf(model.name, loose.design(), is_given_up));
    model.loose.push_back({loose.id(),
                           {loose.design().drawing(), loose.design().group(), std::move(design)},
                           loose.turned()});
  }
  model.components = {state.shown().components().begin(), state.shown().components().end()};
  model.warnings = {state.shown().warnings().begin(), state.shown().warnings().end()};
  return model;
}

ModelState StateOf(const OpenModel& model) {
  ModelState state;
  v1::Model& shown = *state.mutable_shown();
  std::map<std::string, ComponentBox> boxes;
  if (model.body) {
    *state.mutable_body() = StateOf(model.body->design, model.body->drawing, model.body->group);
    Show(model, "", model.body->design, boxes, &shown);
  }
  for (const auto& [part, component] : model.owners) {
    PartOwner* const owner = state.add_owners();
    owner->set_part(part);
    owner->set_component(component);
    owner->set_borrowed(model.borrowed.contains(part));
  }
  for (const OpenLoose& loose : model.loose) {
    LooseComponent* const kept = state.add_loose();
    kept->set_id(loose.id);
    *kept->mutable_design() = StateOf(loose.part.design, loose.part.drawing, loose.part.group);
    if (!loose.turned.drawing().empty()) *kept->mutable_turned() = loose.turned;
    Show(model, loose.id, loose.part.design, boxes, &shown);
  }
  for (const v1::ModelComponent& component : model.components) {
    v1::ModelComponent* const added = shown.add_components();
    *added = component;
    boxes[component.id()].SetOf(added);
  }
  for (const v1::ModelWarning& warning : model.warnings) *shown.add_warnings() = warning;
  return state;
}

std::vector<v1::ModelPart> ShownParts(const OpenModel& model, const std::string& component,
                                      const Design& design) {
  const Assembly& assembly = design.assembly->assembly();
  const auto owner_of = [&](const std::string& part) {
    if (!component.empty()) return component;
    const auto found = model.owners.find(part);
    return found == model.owners.end() ? std::string() : found->second;
  };
  std::vector<v1::ModelPart> parts;
  for (const PlacedPart& placed : PartsOf(design)) {
    const Element& element = design.assembly->elements()[static_cast<std::size_t>(placed.element)];
    const auto drawn = static_cast<std::size_t>(element.parts.front());
    v1::ModelPart& part = parts.emplace_back();
    part.set_name(placed.name);
    part.set_component(owner_of(assembly.parts[drawn].name));
    part.set_element(element.name);
    part.set_group(GroupName(assembly, element.group));
    part.set_item(element.item);
    part.set_connecting(element.connecting);
    *part.mutable_minimum() = VectorToProto(placed.box.minimum);
    *part.mutable_maximum() = VectorToProto(placed.box.maximum);
  }
  return parts;
}

absl::StatusOr<v1::ModelComponent*> FindComponent(OpenModel& model, const std::string& id) {
  for (v1::ModelComponent& component : model.components) {
    if (component.id() == id) return &component;
  }
  return InvalidField("component",
                      absl::StrCat("there is no component '", id, "' in ", model.name,
                                   NamesOffered(id, model.components, &v1::ModelComponent::id)));
}

absl::StatusOr<OpenLoose*> FindLoose(OpenModel& model, const std::string& id) {
  MORTISE_RETURN_IF_ERROR(FindComponent(model, id).status());
  for (OpenLoose& loose : model.loose) {
    if (loose.id == id) return &loose;
  }
  return PreconditionFailed("COMPONENT_CONNECTED",
                            absl::StrCat("'", id, "' is of one piece with the rest already"),
                            "component");
}

absl::StatusOr<OpenDesign*> FindDesign(OpenModel& model, const std::string& component) {
  if (!component.empty()) {
    MORTISE_ASSIGN_OR_RETURN(OpenLoose* const loose, FindLoose(model, component));
    return &loose->part;
  }
  if (model.body) return &*model.body;
  return PreconditionFailed("MODEL_EMPTY", absl::StrCat("nothing is in ", model.name, " yet"),
                            "name");
}

DesignOf DesignsIn(const OpenModel& model) {
  std::map<std::string, std::string> designs = model.owners;
  for (const std::string& part : model.borrowed) designs.erase(part);
  return [designs = std::move(designs)](const std::string& part) {
    const auto found = designs.find(part);
    return found == designs.end() ? std::string() : found->second;
  };
}

void SetPlaced(OpenModel& model, const std::string& component) {
  for (v1::ModelComponent& each : model.components) {
    if (each.id() != component) continue;
    each.set_state(v1::ModelComponent::PLACED);
    each.clear_alignments();
  }
  // Turned back, it is no longer what it was.
  for (OpenLoose& loose : model.loose) {
    if (loose.id != component) continue;
    loose.turned.clear_before();
    loose.turned.clear_turns_before();
  }
}

void MoveTo(const Eigen::Vector3d& position, Design* design) {
  const BoundingBox box = BoundsOf(*design);
  const Eigen::Vector3d foot(box.center().x(), box.center().y(), box.minimum.z());
  design->shift += position - foot;
}

}  // namespace mortise::composer
