// What the connections of a component let it do, while they are looked for: it is to move as it did
// where it comes from, and in no other way.
#pragma once

#include <optional>
#include <string>

#include "services/composer/connecting/connect.h"
#include "services/composer/connecting/motions.h"

namespace mortise::composer {

class ComponentMotion {
 public:
  // `name` is what the component is called in the model: it counts where no fastener of the
  // original holds the component firmly. `original`, null for none, must outlive this.
  ComponentMotion(const BothSides& sides, const std::string& name, const Original* original);

  // How the component is to move against the body.
  const WantedMotion& wanted() const { return wanted_; }
  // What may be fastened to what.
  const MovingFrames& frames() const { return frames_; }
  // Whether what was taken lets the component move by a joint.
  bool IsJointed() const { return joint_.has_value(); }

  // Whether a connection of another design would let the component move in another way than it is
  // to, or than what was taken does.
  bool Differs(const Candidate& candidate, const parametric::OptimizedConnection& placed) const;

  // Whether a joint of a connection comes with it: what only touches has none, unless nothing else
  // holds the component where it comes from, as guides hold a sliding door.
  bool BringsJoint(const CollectionConnection& connection) const;

  // Notes what a connection that is used fastens, and lets move.
  void Take(const Candidate& candidate, const parametric::OptimizedConnection& placed);

 private:
  const Original* original_;
  const parametric::Joint* own_joint_ = nullptr;  // of the original, that moves the component
  bool only_touches_ = false;                     // nothing fastens it there
  WantedMotion wanted_;
  MovingFrames frames_;
  std::optional<parametric::Joint> joint_;
};

}  // namespace mortise::composer
