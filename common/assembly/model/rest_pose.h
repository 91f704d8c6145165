// Places elements in the rest poses of articulated designs: their planes and centres as functions
// of q (thesis §3.5.1, "several rest configurations").
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <string>
#include <vector>

#include "common/assembly/model/assembly.h"
#include "common/assembly/model/element.h"
#include "common/assembly/model/oriented_box.h"
#include "common/assembly/polyhedra/linear_form.h"

namespace mortise::parametric {

// A plane or centre of an element, in one pose of the design.
struct PosedPosition {
  int element = 0;
  bool is_center = false;
  bool is_minimum = false;  // the lower face of the element's box in this pose
  bool is_maximum = false;  // the upper face
  Axis axis = Axis::kX;     // in the pose
  LinearForm position;      // m along the axis, of q
  double drawn = 0;         // its value as the expert drew the design
  std::string label;        // "'leg 1' z maximum", with the pose unless it is the drawn one
};

// One configuration of the design: as drawn, or with one joint in one of its rest poses.
struct Pose {
  std::string name;  // empty as drawn; else "joint: pose"
  int moved_group = -1;
  int joint = -1;
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
};

// Returns the rest poses of a joint. A hinge or slide without any has its two ends (thesis §3.5.1).
std::vector<RestPose> RestPosesOf(const Joint& joint);

// Returns the drawn pose, then every rest pose of every joint with the other joints as drawn.
std::vector<Pose> PosesOf(const Assembly& assembly);

// Returns the index into q of a joint's centre along an axis. Joints come behind the elements.
inline int JointVariable(std::size_t elements, int joint, Axis axis) {
  return 6 * static_cast<int>(elements) + 3 * joint + static_cast<int>(axis);
}

// Returns q as drawn, the joints' centres included: 6 · elements + 3 · joints numbers, m.
Eigen::VectorXd DrawnParameters(const Assembly& assembly, const std::vector<Element>& elements);

// Returns how a pose moves the parts of its group at q: x becomes rotation · x + translation. It is
// the identity in the drawn pose, and the exact counterpart of the planes below for whatever moves
// with the group. Rotations that miss right angles by 1e-4 rad or less, as digits typed by hand do,
// are taken as right ones.
Eigen::Isometry3d MotionIn(const Pose& pose, const Assembly& assembly, std::size_t elements,
                           const Eigen::VectorXd& q);

// Whether a pose moves an element.
bool MovesIn(const Pose& pose, const Assembly& assembly, const Element& element);

// Returns the axes of an element's box as a pose turns it, in columns. An element that is round
// about the axis it turns about stays in its box as drawn.
Eigen::Matrix3d AxesIn(const Pose& pose, const Assembly& assembly, const Element& element);

// Returns the box of an element in a pose, at q.
OrientedBox BoxIn(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
                  int element, const Eigen::VectorXd& q);

// Returns where a point that is fixed in an element's box lies along a direction in a pose:
// direction · x, m, as a function of q. `fractions` are those of the box's sizes, from its middle.
LinearForm PlaceIn(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
                   int element, const Eigen::Vector3d& fractions, const Eigen::Vector3d& direction);

// Returns how far an element reaches along a direction, a unit vector, in a pose: the largest value
// of direction · x over its box, m, as a function of q.
LinearForm ReachIn(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
                   int element, const Eigen::Vector3d& direction);

// Returns the planes and centres of all elements in a pose. A rotation that does not take axes to
// axes leaves no plane of the moved elements parallel to one, but for those of the boxes of what is
// round about the axis that it turns about (AxesIn); then only their centres are given.
std::vector<PosedPosition> PositionsIn(const Pose& pose, const Assembly& assembly,
                                       const std::vector<Element>& elements);

// Returns the levels of all elements in a pose, as far as it leaves them at right angles to an
// axis.
std::vector<PosedPosition> LevelsIn(const Pose& pose, const Assembly& assembly,
                                    const std::vector<Element>& elements);

// Returns the lowest group that holds what a relationship of two elements in a pose binds: both
// elements, whatever its form speaks of besides, as places of feature anchors do, and in a pose the
// joint's centre, which lives beside the moved group.
int GroupIn(const Pose& pose, const Assembly& assembly, const std::vector<Element>& elements,
            const Element& a, const Element& b, const LinearForm& form);

}  // namespace mortise::parametric
