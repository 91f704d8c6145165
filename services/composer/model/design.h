// A part of a working model as it is now (thesis §5.2): an assembly that was parametrised when its
// structure last changed, and the parameters that it has now. The body of a model is one, and each
// component that is not connected yet.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/model/assembly.h"
#include "common/assembly/model/linear_design.h"
#include "common/assembly/parametric_assembly.h"

namespace mortise::composer {

using parametric::Axis;

struct Design {
  std::shared_ptr<const parametric::ParametricAssembly> assembly;
  Eigen::VectorXd q;                                // feasible (FeasibleSet)
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // m, by which all of it is moved in space
};

// Parametrises a valid assembly, and returns it as it is drawn. What nothing holds, as slats whose
// rails stayed behind, keeps its distance from what lies nearest (LoosePolicy::kHold): it can be
// dropped, and dragged as far as the rest of its relationships allow. What is `known` need not be
// found again, and changes nothing else. Fails as ParametricAssembly::Create.
absl::StatusOr<Design> AsDrawn(
    parametric::Assembly assembly,
    const std::vector<const parametric::ParametricAssembly*>& known = {});

// A design drawn anew.
struct Redrawn {
  parametric::Assembly assembly;
  // Of each part of `assembly` the name of the part of the design's assembly that it is a copy of
  // but for its box. Parts that a row has beyond those drawn are copies of its first.
  std::vector<std::string> drawn_as;
};

// Returns the design drawn as it is now, its shift included: a valid assembly with the same groups
// and joints, of which each part lies in the box that it has now. Prominent planes and the centres
// of joints are where the parameters put them. Rows have as many parts as they have now, called as
// PlacedPart says; a name that another part has already is numbered further. A shape that is
// stretched in pieces is a shape of its own, not stored yet: its name is empty. Fails as
// cad::SolidOfShape where the kernel cannot stretch one.
absl::StatusOr<Redrawn> Redraw(const Design& design);

// Returns the assembly of Redraw.
absl::StatusOr<parametric::Assembly> DrawnAt(const Design& design);

// Returns all parts as they are now, the shift included. O(parts).
std::vector<parametric::PlacedPart> PartsOf(const Design& design);

// Returns the box around all parts as they are now, m.
parametric::BoundingBox BoundsOf(const Design& design);

// Returns the box of one element as it is now, m.
parametric::BoundingBox ElementBox(const Design& design, int element);

// Returns the design with its connecting parts where their connections want them for its principal
// parts as they are (ConnectionPlacement).
absl::StatusOr<Design> Settled(Design design);

// Returns by what changes of each parameter are measured, for "nearest": sizes by themselves as
// they are drawn, places by `of_places`, m. So a top that is moved keeps its thickness, where plain
// squares would have a third of the way be thickness.
Eigen::VectorXd ChangeScales(const parametric::ParametricAssembly& assembly, double of_places);

// Returns the variables of sizes of principal elements that a change has hardly changed: by no more
// than a twentieth of the largest change in proportion. They had better stay as they were.
std::vector<int> SizesToKeep(const parametric::ParametricAssembly& assembly,
                             const Eigen::VectorXd& before, const Eigen::VectorXd& after);

// Returns parameters in which the design stands anywhere in space, and `shift` is nothing: q with
// all places moved by the shift.
Eigen::VectorXd InSpace(const Design& design);

// Returns the design of parameters in space: what the assembly's anchors hold in place becomes the
// shift. The reverse of InSpace.
Design FromSpace(std::shared_ptr<const parametric::ParametricAssembly> assembly,
                 const Eigen::VectorXd& in_space);

}  // namespace mortise::composer
