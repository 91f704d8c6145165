// What a component of a model may be connected by, as ConnectComponent takes it, and the trials of
// suggestions.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "services/composer/catalog/collection_connections.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// Returns the turns of those components of a model that are turned, each once. Fails as ReadTurns.
absl::StatusOr<std::vector<Eigen::Matrix3d>> TurnsIn(const OpenModel& model);

// The design that a component is of, as the component is turned.
struct OwnOrigin {
  std::shared_ptr<const Drawing> drawing;
  std::shared_ptr<const Connections> connections;
};

// Returns the assemblies whose connections may hold the component to the body: those `drawn`; the
// same turned by each of `turns`, so that what stands along y is held together as what stands along
// x; and the component's `own` as it is given, whatever has become of it in the catalog, with the
// catalog's beside it where there are turns. Without those that are made of other revisions of
// items, with other sizes, than the component and the body. Fails as CollectionConnections::Turned.
absl::StatusOr<ConnectionOrigins> SourcesFor(const ConnectionOrigins& drawn,
                                             const std::vector<Eigen::Matrix3d>& turns,
                                             const OwnOrigin& own, const Drawing& body,
                                             CollectionConnections& collection,
                                             const IsGivenUp& is_given_up);

}  // namespace mortise::composer
