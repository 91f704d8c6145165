// Says where everything stands while a step is shown: what is built already in its place, what
// comes in pulled apart against its way, fasteners before their holes. Pictures and the shapes of
// the guide's page show the same.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "services/fabplanner/plan/design.h"
#include "services/fabplanner/plan/plan.h"

namespace mortise::fabplanner {

// What a part is to the step.
enum class StepRole { kStanding, kAdded, kFastener };

// A part of the design, `offset` (m) from its place.
struct ArrangedPart {
  const Part* part = nullptr;
  StepRole role = StepRole::kStanding;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

// A peg, `offset` (m) from its place: it stands in the part that moves less.
struct ArrangedPeg {
  const Peg* peg = nullptr;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

// The way of what comes in, from `place` + `from` to `place` + `to`, m. Once all is in its place
// both ends are `place`.
struct StepWay {
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  Eigen::Vector3d from = Eigen::Vector3d::Zero();
  Eigen::Vector3d to = Eigen::Vector3d::Zero();
};

// Points into the design that it was made of.
struct StepArrangement {
  std::vector<ArrangedPart> parts;  // what stands, then what is added, then fasteners
  std::vector<ArrangedPeg> pegs;    // of designs whose fasteners are no parts
  std::vector<StepWay> arrows;      // of parts that come in
  std::vector<StepWay> goals;       // of each peg and screw: the hole that it goes into
};

// Returns how far a part is drawn from its place in step `number` (from 1) of a pegged design, m.
// What was built in one piece before moves in one piece. The largest piece that stands already (or,
// in the first step, the largest part) stays; the others are pulled away from it against their
// pegs, `distance` for each joint on the way.
Eigen::Vector3d ExplodedOffset(const std::string& part, const Design& design,
                               const std::vector<AssemblyStep>& steps, int number, double distance);

// Returns the arrangement of step `number`, from 1 to as many as there are. Of steps that know
// their ways in, only what the step says to stand or to come in is there; `holes` say from where
// its screws come.
StepArrangement ArrangeStep(const Design& design, const Items& items,
                            const std::vector<Hole>& holes, const std::vector<AssemblyStep>& steps,
                            int number);

}  // namespace mortise::fabplanner
