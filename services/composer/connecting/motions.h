// How a component is to move against the body that it is connected to: a drawer slides, a door
// turns, a shelf does neither (thesis §3.5.1, §5.6).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "services/composer/connecting/candidate.h"
#include "services/composer/connecting/guides.h"
#include "services/composer/connecting/part_connection.h"
#include "services/composer/model/placed_forms.h"

namespace mortise::composer {

// Whether a group or part is to move by its name, our own: one that ends in "drawer", "door",
// "lid", "flap", "hatch" or "gate", but for numbers: "left-door", "drawer 2"; not "door frame", nor
// what has such a part beside others: "desk with drawer".
bool IsMeantToMove(const std::string& name);

// Which motion a connection must allow to what stands for one of its principals, against the other.
struct WantedMotion {
  bool moves = false;                         // else it is to be firm
  std::optional<parametric::JointKind> kind;  // any, where that is not known
  // By what that is known, for people: "by 'left drawer slide'", "by its name".
  std::string because = {};
};

// "slide", "turn", or "move" where it is not known which.
const char* VerbOf(const WantedMotion& motion);

// Returns how a component is to move. `joint` is that of its original design that moves it as a
// whole (OwnJointOf), null without one; then its name in the model says (IsMeantToMove), or that of
// its only principal part.
WantedMotion WantedMotionOf(const std::vector<PrincipalPart>& component, const std::string& name,
                            const parametric::Joint* joint);

// Returns the joint of a design that moves those principal parts that the component has, and no
// others; null if there is none.
const parametric::Joint* OwnJointOf(const parametric::Assembly& original,
                                    const std::vector<PrincipalPart>& component);

// How a connection lets one of its principals, `second`, move against another, `first`, that stays.
struct AllowedMotion {
  bool is_firm = true;  // no joint moves either against the other
  std::vector<parametric::JointKind> kinds =
      {};  // of joints that move `second` alone, and have guides
};
AllowedMotion AllowedMotionOf(const parametric::ElementConnection& connection, int first,
                              int second, const ItemKindOf& kind_of);

// Whether that is what is wanted.
bool Allows(const AllowedMotion& allowed, const WantedMotion& wanted);

// Returns the joint of a connection, by its index there, that moved what the component's parts
// stand for and nothing else: with it the component moves against the body.
std::optional<int> JointOfComponent(const Candidate& candidate);

// Returns that joint, which there must be, where the connection is placed.
parametric::Joint JointWhere(const Candidate& candidate,
                             const parametric::OptimizedConnection& placed, int joint);

// Whether two joints allow the same motion: along or about one axis, or about one point, to
// `tolerance`, m.
bool MoveAlike(const parametric::Joint& a, const parametric::Joint& b, double tolerance);

// A part of the body and one of the component, by their indices.
using PartPair = std::pair<int, int>;

// Returns the pairs that a connection holds together, firmly or by the joint that moves the
// component: not those that another joint of its own moves against each other, nor any where it has
// no connecting parts.
std::vector<PartPair> HeldPairs(const Candidate& candidate);

// Which parts of a component may be fastened to which of a body: never two parts that joints move
// against each other to one that is firm.
class MovingFrames {
 public:
  MovingFrames(const BothSides& sides);

  // Whether neither of the two is moved by a joint of its own side.
  bool BothStay(int body, int component) const;
  // Whether the two may be fastened to each other with all that is so far.
  bool MayFasten(int body, int component) const;
  // The first of these pairs that may not be fastened when those before it are; nothing if all may.
  std::optional<PartPair> FirstConflict(const std::vector<PartPair>& pairs) const;
  void Fasten(int body, int component);

 private:
  // Of each part the innermost group that a joint moves and that it is in, 0 for what stays: parts
  // with the same number are firm to each other.
  std::vector<int> body_, component_;
  std::map<int, int> component_of_body_, body_of_component_;  // what is fastened
};

}  // namespace mortise::composer
