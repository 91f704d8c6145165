// A model while it is worked on: its designs, parametrised.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "model_state.pb.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/holding/motion_rules.h"
#include "services/composer/model/design.h"
#include "services/composer/records/model_drawings.h"
#include "services/composer/records/model_records.h"

namespace mortise::composer {

// A design of a model, and what it is drawn in.
struct OpenDesign {
  std::string drawing;  // digest
  std::string group;    // node of the drawing; empty for the whole
  Design design;
};

struct OpenLoose {
  std::string id;  // of v1::ModelComponent
  OpenDesign part;
  TurnedFrom turned;  // empty of one that lies as it is drawn
};

struct OpenModel {
  std::string name;                           // models/{id}
  std::optional<OpenDesign> body;             // what is connected; none of an empty model
  std::map<std::string, std::string> owners;  // component of each part of the body as drawn
  // Connecting parts of the body that connections of other designs than their components' brought.
  std::set<std::string> borrowed;
  std::vector<OpenLoose> loose;  // components that are not connected
  std::vector<v1::ModelComponent> components;
  std::vector<v1::ModelWarning> warnings;
};

// Parametrises what a model is made of; what was used lately is at hand. Fails as
// ModelDrawings::DesignOf.
absl::StatusOr<OpenModel> Open(const StoredModel& stored, ModelDrawings& drawings,
                               const IsGivenUp& is_given_up);

// Returns the state of a model as it is now, with what clients see of it.
ModelState StateOf(const OpenModel& model);

// Returns what clients see of the parts of a design that takes the place of the body or, if
// `component` is not empty, of that loose component.
std::vector<v1::ModelPart> ShownParts(const OpenModel& model, const std::string& component,
                                      const Design& design);

// Returns the component of an id. INVALID_ARGUMENT, "component".
absl::StatusOr<v1::ModelComponent*> FindComponent(OpenModel& model, const std::string& id);

// Returns the component, which must not be connected. INVALID_ARGUMENT; FAILED_PRECONDITION,
// COMPONENT_CONNECTED.
absl::StatusOr<OpenLoose*> FindLoose(OpenModel& model, const std::string& id);

// Returns the design of a model that a node is of: the body, or the loose component that is named.
// Fails as FindLoose; FAILED_PRECONDITION, MODEL_EMPTY, where there is no body.
absl::StatusOr<OpenDesign*> FindDesign(OpenModel& model, const std::string& component);

// Returns the design that each part of the body, as drawn, came with, as the component's id:
// nothing for borrowed ones. It keeps what it needs of the model.
DesignOf DesignsIn(const OpenModel& model);

// Says that a loose component has been moved or resized since it snapped.
void SetPlaced(OpenModel& model, const std::string& component);

// Moves a design so that the middle of the lower side of its box is there, m.
void MoveTo(const Eigen::Vector3d& position, Design* design);

}  // namespace mortise::composer
