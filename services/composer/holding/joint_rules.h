// Rules of what joins the parts of a model. An elastic analysis takes parts that touch to be
// bonded; these judge what bonds them.
#pragma once

#include <string>
#include <vector>

#include "services/composer/holding/finding.h"
#include "services/composer/holding/joints.h"

namespace mortise::composer {

// What the rules want. Lengths are in diameters of the pin, of a screw that of its thread.
struct JointRules {
  // "edge-distance": from a screw's or bolt's axis to the faces of the part beside it. EN 1995-1-1,
  // Table 8.2, wants 3 with a bored hole, at an edge that is not loaded; below that it is a notice.
  // Furniture makes do with less in the edges of boards: below 2, our own, it is a warning, and
  // what comes out of the part, below ½, a fault.
  double screw_edge = 3;
  double screw_edge_least = 2;
  // The same of a dowel, our own: one that is no thicker than half the board.
  double dowel_edge = 1;
  // The same in metal: EN 1993-1-8, Table 3.3.
  double metal_edge = 1.2;
  // "thread-depth": of a screw in the part that it ends in. EN 1995-1-1, 8.7.2, wants 6 of thread;
  // below that it is a notice, below 4, our own, a warning. All of it counts as thread.
  double screw_depth = 6;
  double screw_depth_least = 4;
  // "dowel-depth": of a dowel in each part; our own.
  double dowel_depth = 1.5;
  // "fastener-spacing": a fastener for every so many metres of a contact; our own.
  double fastener_spacing = 0.3;
};

// Returns what is wrong with joints one by one: the rules above, and "bracket-not-fastened" where
// no screw or bolt holds a bracket, hinge or slide to a part that it touches. Distances are of
// boxes, so that parts that do not fill theirs are left out, and so are pins at a slant.
std::vector<Finding> JudgeJoints(const std::vector<Joint>& joints, const JointRules& rules = {});

// Rules of what nothing holds.
inline constexpr char kUnconnected[] = "unconnected";
inline constexpr char kOnlyTouches[] = "only-touches";

// Returns what is wrong with how the principal parts of these names are joined to a whole, our own:
//
//   unconnected   a fault: parts that do not even touch the rest
//   only-touches  a warning: parts that nothing fastens to the rest; whether they are glued is not
//                 known
//   can-turn      a warning: what is held by pins on one axis alone turns about it. What a joint
//                 of the assembly moves, wheels and bearings are to turn
//
// The rest is what has the most parts, of several the one with the first part; of what stands on
// the floor, which is as low as the lowest part or fastener of the joints.
std::vector<Finding> JudgeWhole(const std::vector<std::string>& parts,
                                const std::vector<Joint>& joints);

}  // namespace mortise::composer
