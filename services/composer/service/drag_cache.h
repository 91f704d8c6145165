// What drags take, kept at hand: of structures what any drag needs, and drags that have begun.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/base/single_flight_cache.h"
#include "mortise/v1/composer.pb.h"
#include "services/composer/model/drag_space.h"
#include "services/composer/model/node_drag.h"
#include "services/composer/service/node_controls.h"
#include "services/composer/service/open_model.h"

namespace mortise::composer {

// Which control of a model is dragged.
struct DraggedControl {
  std::string component;  // a loose one; empty for the body
  std::string node;
  std::string control;  // "width"
};

// A drag of a control of a model as it is stored. Thread safe: one value after the other.
class OpenDrag {
 public:
  // What became of a value.
  struct Dragged {
    double reached = 0;  // m
    std::vector<v1::ModelPart> parts;
  };

  OpenDrag(OpenModel model, const DraggedControl& control, NodeDrag drag);

  // The parts of the design as it is stored.
  const std::vector<v1::ModelPart>& stored() const { return stored_; }
  // m, of the control as it is stored.
  double value() const { return value_; }

  // Returns what becomes of the design. The last value is at hand. Fails as NodeDrag::To.
  absl::StatusOr<Dragged> To(double value);

  // Returns how much memory it takes, bytes.
  std::size_t MemoryUse() const;

 private:
  const OpenModel model_;
  const std::string component_;
  std::vector<v1::ModelPart> stored_;
  double value_ = 0;
  mutable std::mutex mutex_;
  NodeDrag drag_;                     // guarded by mutex_
  std::optional<double> last_value_;  // guarded by mutex_
  Dragged last_;                      // guarded by mutex_
};

// Thread safe.
class DragCache {
 public:
  // `capacity`: bytes of what is kept, half of it of structures and half of drags; the least
  // recently used is forgotten first, but for a single drag that is larger.
  explicit DragCache(std::size_t capacity = std::size_t{256} << 20);

  // What dragging takes of the structure of a design.
  absl::StatusOr<std::shared_ptr<const DragSpace>> SpaceOf(const OpenDesign& design);

  // A drag of the state of a model that has this digest; `open` opens it, if need be. Fails as
  // ParseControl, FindDesign and NodeDrag::Begin.
  absl::StatusOr<std::shared_ptr<OpenDrag>> DragOf(
      const std::string& digest, const DraggedControl& control,
      const std::function<absl::StatusOr<OpenModel>()>& open);

  // Makes a drag that is nobody else's.
  absl::StatusOr<NodeDrag> Begin(const OpenDesign& design, const DraggedControl& control);

 private:
  SingleFlightCache<std::shared_ptr<const DragSpace>> spaces_;  // by drawing and group
  SingleFlightCache<std::shared_ptr<OpenDrag>> drags_;          // by digest and control
};

}  // namespace mortise::composer
