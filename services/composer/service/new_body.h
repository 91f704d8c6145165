// What a model's body becomes when its structure changes: drawn anew, parametrised, and stored as a
// drawing.
#pragma once

#include <memory>

#include "absl/status/statusor.h"
#include "services/composer/catalog/collection_connections.h"
#include "services/composer/connecting/connect.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// The drawings that a merged assembly is made of.
struct MergedFrom {
  const Drawing& body;
  const Drawing& component;
  const ConnectionOrigins& connections;  // that may have been used
};

// Makes the body that connecting came to that of the model, whose component is then no longer
// loose. Returns its drawing, which is to be stored. Fails as DrawAnew and ModelDrawings.
absl::StatusOr<std::shared_ptr<const Drawing>> TakeConnected(
    const Connected& connected, const std::string& component, const MergedFrom& from,
    ModelDrawings& drawings, const IsGivenUp& is_given_up, OpenModel* model);

// Takes a node out of the body, with the components of which nothing is left. Returns the drawing
// of the rest. Fails as WithoutNode, DrawAnew and ModelDrawings.
absl::StatusOr<std::shared_ptr<const Drawing>> TakeWithout(const std::string& node,
                                                           ModelDrawings& drawings,
                                                           const IsGivenUp& is_given_up,
                                                           OpenModel* model);

// Returns the body drawn as it is now, as an assembly called `name`.
absl::StatusOr<Drawing> DrawBody(const OpenModel& model, const std::string& name,
                                 ModelDrawings& drawings);

}  // namespace mortise::composer
