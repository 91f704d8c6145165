// Finds how a structure can move without deforming: the null space of its stiffness.
//
// It follows from the geometry alone. An element deforms unless it moves as a rigid body, and so do
// elements that share a face unless both move alike; what is left are motions of whole bodies
// (bodies.h) that agree where the bodies meet and where supports hold (joints.h). A small matrix
// has these as its null space, whatever the size of the mesh and the elements' kind, stiffness or
// thickness: a sheet is sound however thin, and a hinge free to turn however stiff.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/fem/mechanisms/joints.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Bodies that joints connect, and their free motions.
struct MovingBodies {
  std::vector<int> bodies;  // indices of JoinedBodies::bodies
  int count = 0;            // of independent free motions; at least 1
  bool is_loose = false;    // no support holds any of them
  // A RigidMotion of each body below each other, for each motion: orthonormal. Not all, if there
  // are more than were asked for.
  Eigen::MatrixXd motions;
};

struct FreeMotions {
  JoinedBodies joined;
  std::vector<MovingBodies> groups;
  int count = 0;
};

// Motions of one group of bodies that are found, of all that are counted.
inline constexpr int kMaxMotions = 300;

// Returns what `constraints` leave free. Every node of the mesh has an element.
FreeMotions FindFreeMotions(const mesh::TetrahedralMesh& mesh, const Constraints& constraints,
                            int most = kMaxMotions);

// Returns one of them, for people: "part 'leg 3' is free to rotate about z through (20, 0, 0) mm".
// Of several bodies the fewest that can move by themselves are named.
std::string MotionText(const FreeMotions& free, const mesh::TetrahedralMesh& mesh);

// Fails with FAILED_PRECONDITION, reason RIGID_MOTION, if something can move without deforming,
// naming what and how. INVALID_ARGUMENT naming "nodes" if a node has no element.
absl::Status CheckRigidMotion(const mesh::TetrahedralMesh& mesh, const Constraints& constraints);

// Returns each as a displacement of all nodes (3 × nodes, in space), linearly independent.
std::vector<Eigen::Matrix3Xd> Displacements(const FreeMotions& free,
                                            const mesh::TetrahedralMesh& mesh);

}  // namespace mortise::simulator
