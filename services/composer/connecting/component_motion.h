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
  // `name` is what the component is called in the model: it counts where its original does not hold
  // it firmly. `original`, null for none, must outlive this.
  ComponentMotion(const BothSides& sides, const std::string& name, const Original* original,
                  ItemKindOf kind_of);

  // How the component is to move against the body.
  const WantedMotion& wanted() const { return wanted_; }
  // What may be fastened to what.
  const MovingFrames& frames() const { return frames_; }
  // Whether what was taken lets the component move: by a joint, or by hinges or slides of its own
  // design, which may have none drawn.
  bool IsLetMove() const { return joint_ || has_own_hardware_; }

  // Say why a connection must not be used, wherever it is from; empty if it may be. Wherever it is
  // placed: it would hold fast what is to move, or fasten what joints move against each other.
  std::string WhyNotHeld(const Candidate& candidate, const BothSides& sides) const;
  // Where it is placed: it would let the component move in another way than it is to, or than what
  // was taken does.
  std::string WhyNotMoved(const Candidate& candidate,
                          const parametric::OptimizedConnection& placed) const;

  // Whether a joint of a connection comes with it: something of it guides the component, or it is
  // one of those contacts that together keep it on its way here as they do where it comes from, as
  // guides do a sliding door.
  bool BringsJoint(const Candidate& candidate) const;

  // Notes what a connection that is used fastens, and lets move.
  void Take(const Candidate& candidate, const parametric::OptimizedConnection& placed);

 private:
  bool IsFastenedIn(const Original& original, const std::vector<PrincipalPart>& component) const;
  // What of the original keeps the component on its way by contact alone, if no guide does.
  Guidance GuidanceIn(const Original& original, const std::vector<PrincipalPart>& component) const;
  // Whether a connection lets the component move by a joint, and by connecting parts of its own.
  bool HasGuides(const Candidate& candidate) const;
  // Whether it has hinges or slides, but no joint.
  bool HasOnlyHardware(const Candidate& candidate) const;
  // Whether it is a contact that may be one of several that keep the component on its way.
  bool IsContactOnWay(const Candidate& candidate) const;

  const Original* original_;
  const ItemKindOf kind_of_;
  const parametric::Joint* own_joint_ = nullptr;  // of the original, that moves the component
  Guidance wanted_guidance_, guidance_;           // by contact: in the original, and here
  WantedMotion wanted_;
  MovingFrames frames_;
  std::optional<parametric::Joint> joint_;
  std::optional<parametric::Joint> contact_joint_;  // of the first contact on its way
  bool has_own_hardware_ = false;
};

}  // namespace mortise::composer
