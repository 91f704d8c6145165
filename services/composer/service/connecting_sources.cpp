#include "services/composer/service/connecting_sources.h"

#include <algorithm>
#include <utility>

#include "common/base/errors.h"
#include "services/composer/service/turn_methods.h"

namespace mortise::composer {

absl::StatusOr<std::vector<Eigen::Matrix3d>> TurnsIn(const OpenModel& model) {
  std::vector<Eigen::Matrix3d> turns;
  for (const v1::ModelComponent& component : model.components) {
    if (component.turns().empty()) continue;
    MORTISE_ASSIGN_OR_RETURN(const Eigen::Matrix3d turn, methods::ReadTurns(component.turns()));
    if (std::find(turns.begin(), turns.end(), turn) == turns.end()) turns.push_back(turn);
  }
  return turns;
}

absl::StatusOr<ConnectionOrigins> SourcesFor(const ConnectionOrigins& drawn,
                                             const std::vector<Eigen::Matrix3d>& turns,
                                             const OwnOrigin& own, const Drawing& body,
                                             CollectionConnections& collection,
                                             const IsGivenUp& is_given_up) {
  const std::string& name = own.drawing->bundle.assembly().name();
  ConnectionOrigins sources = drawn;
  if (!turns.empty()) {
    ConnectionOrigins own_drawn;
    if (const auto found = drawn.find(name); found != drawn.end()) own_drawn.insert(*found);
    MORTISE_ASSIGN_OR_RETURN(
        ConnectionOrigins more,
        collection.Turned(own_drawn, Eigen::Matrix3d::Identity(), is_given_up));
    sources.merge(more);
  }
  // Turning takes long: what holds nothing of the two stays as it is drawn.
  const ConnectionOrigins of_use =
      turns.empty() ? ConnectionOrigins() : ThatMayHold(drawn, body, *own.drawing);
  for (const Eigen::Matrix3d& turn : turns) {
    MORTISE_ASSIGN_OR_RETURN(ConnectionOrigins more, collection.Turned(of_use, turn, is_given_up));
    sources.merge(more);
  }
  sources[name] = {own.drawing, own.connections};
  v1::AssemblyBundle together = body.bundle;
  if (CombineItems(own.drawing->bundle, &together).ok()) LeaveOutOtherItems(together, sources);
  return sources;
}

}  // namespace mortise::composer
