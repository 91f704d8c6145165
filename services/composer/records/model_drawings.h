// The drawings of models, parametrised: what all changes of models work on. Parametrising takes up
// to seconds, so what was used last is kept.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/parametric_assembly.h"
#include "common/base/single_flight_cache.h"
#include "common/store/store.h"
#include "model_state.pb.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/model/design.h"
#include "services/composer/records/drawing.h"

namespace mortise::composer {

// Whether nobody waits for the work any more.
using IsGivenUp = std::function<bool()>;

using Connections = std::vector<CollectionConnection>;

// Thread safe. No method may be called from within a transaction: what others make is waited for,
// and they may wait for the store.
class ModelDrawings {
 public:
  // `capacity`: bytes of what is kept, the least recently used forgotten first. The store must
  // outlive it.
  explicit ModelDrawings(store::Store* store, std::size_t capacity = std::size_t{256} << 20);

  // A drawing of the model called `model`. INTERNAL, STORAGE_FAILED where it is missing.
  absl::StatusOr<std::shared_ptr<const Drawing>> Get(const std::string& model,
                                                     const std::string& digest);

  // The drawing turned by right angles. Fails as TurnedDrawing.
  absl::StatusOr<std::shared_ptr<const Drawing>> Turned(
      const std::shared_ptr<const Drawing>& drawing, const Eigen::Matrix3d& turn);

  // The drawing, or the sub-tree below a node of it, parametrised. What is `known` need not be
  // found again. Fails as parametric::ParametrizeKnowing; CANCELLED.
  absl::StatusOr<std::shared_ptr<const parametric::ParametricAssembly>> Parametrize(
      const Drawing& drawing, const std::string& group, const IsGivenUp& is_given_up,
      const std::vector<const parametric::ParametricAssembly*>& known = {});

  // Keeps what a drawing was made of, so that it need not be parametrised again.
  void Keep(const Drawing& drawing,
            std::shared_ptr<const parametric::ParametricAssembly> parametrised);

  // The connections of a drawing, part by part (part_connection.h). Fails as ConnectionsOf.
  absl::StatusOr<std::shared_ptr<const Connections>> ConnectionsIn(const Drawing& drawing);

  // A design of a model. Fails as Get and Parametrize.
  absl::StatusOr<Design> DesignOf(const std::string& model, const DesignState& state,
                                  const IsGivenUp& is_given_up);

 private:
  store::Store* const store_;
  // By digest; those that are turned by that of what they are turned from, and the turns.
  SingleFlightCache<std::shared_ptr<const Drawing>> drawings_;
  // By digest and group.
  SingleFlightCache<std::shared_ptr<const parametric::ParametricAssembly>> parametrised_;
  SingleFlightCache<std::shared_ptr<const Connections>> connections_;  // by digest
};

// What is stored of a design.
DesignState StateOf(const Design& design, const std::string& drawing, const std::string& group);

}  // namespace mortise::composer
