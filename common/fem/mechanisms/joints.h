// Writes what joins bodies to each other and to the supports as equations of their rigid motions.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/elements/supports.h"
#include "common/fem/mechanisms/bodies.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// A rigid motion of a body: the shift of its centre, and its rotation times its size, so that both
// are about as far as its ends move.
using RigidMotion = Eigen::Matrix<double, 6, 1>;

// Bodies of which no two are joined so firmly that they move as one.
struct JoinedBody {
  Body body;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // of its bounding box, m
  double size = 1;                                   // half its bounding box's diagonal, m
  bool is_held = false;    // against all six motions, by supports and bodies that are held
  bool is_joined = false;  // shares nodes with another one
};

// of_first · motion of `first` + of_second · motion of `second`: how the two move against each
// other at a joint, in one of six ways. Its length is 1.
struct JointEquation {
  int joint = 0;
  int first = 0;
  int second = -1;  // none: what holds the first one is at rest
  RigidMotion of_first = RigidMotion::Zero();
  RigidMotion of_second = RigidMotion::Zero();
};

struct JoinedBodies {
  std::vector<JoinedBody> bodies;        // at most one of them is held
  std::vector<JointEquation> equations;  // what joints do not let happen: nothing but rounding
  std::vector<JointEquation> slips;      // what they do
  std::vector<double> tolerances;        // of each joint: rounding, as a share of what slips
};

// Motions, lengths and offsets smaller than this, as a share of the size of the bodies concerned,
// are taken for nothing: nodes of a joint that miss a line by less lie on it. Coordinates of six
// digits, as many files have them, are off by less.
inline constexpr double kJointTolerance = 1e-5;

// Joins the bodies of a mesh. Two that share one point keep three motions against each other, two
// whose shared nodes lie on a straight line the rotation about it, two whose shared nodes do not
// become one body, as do all that supports hold. Every node has an element.
JoinedBodies JoinBodies(const mesh::TetrahedralMesh& mesh, const Constraints& constraints);

}  // namespace mortise::simulator
