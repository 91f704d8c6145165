// Rules of parts that are to move: a drawer that is screwed to a shelf cannot be opened.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "services/composer/holding/finding.h"
#include "services/composer/holding/joints.h"
#include "services/composer/model/design.h"

namespace mortise::composer {

inline constexpr char kScrewedFast[] = "screwed-fast";
inline constexpr char kCannotMove[] = "cannot-move";

// Returns the design that a part of an assembly came with, by whatever names tell designs apart;
// empty where it came with none, as the screws of a connection of another design.
using DesignOf = std::function<std::string(const std::string& part)>;

// Returns the same for the parts of a design drawn anew, which are copies of those of `design_of`.
// What it is asked of, and `redrawn`, outlive it.
DesignOf OfRedrawn(const Redrawn& redrawn, const DesignOf& design_of);

// Returns what keeps parts that are to move from moving, our own. `joints` are those of JointsOf,
// made with the items.
//
//   screwed-fast  a fault: a joint of the assembly moves a part, but a screw, bolt or dowel goes
//                 from it into a part that stays, or a bracket is fastened to both. What lies on
//                 the axis of a hinge, goes through the middle of a ball, or is smooth and lies
//                 along a slide may do so
//   cannot-move   a warning: a group or a part is meant to move (IsMeantToMove, motions.h), nothing
//                 moves it or what it is in, and it is fastened so to what is beside it. What its
//                 own design fastens (`design_of`) stays so, whatever it is called, as in
//                 connecting (ComponentMotion); without `design_of` nothing is known of that
//
// Each joint or group is told of once, with all parts of it that are held, and of what holds them
// the first few. Texts name what is to move, and by what that is known.
std::vector<Finding> JudgeMotion(const parametric::Assembly& drawn,
                                 const std::vector<Joint>& joints,
                                 const DesignOf& design_of = nullptr);

}  // namespace mortise::composer
