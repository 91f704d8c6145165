// Computes smooth nodal stresses from those at integration points by superconvergent patch recovery
// (Zienkiewicz and Zhu, Int. J. Numer. Methods Eng. 33, 1992, 1331-1364).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/fem/linear/thread_team.h"
#include "common/fem/stress/part_surface.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

using Stresses = Eigen::Matrix<double, 6, Eigen::Dynamic>;  // columns are Vector6d

// Inside a part: fits a polynomial (linear, or quadratic for quadratic elements) by least squares
// to the stresses at the integration points of the elements round each corner node, and takes its
// value there; at the middle of an edge the mean of its ends' polynomials, of those that are
// inside. Where there are few elements, their neighbours join. The result is one order more
// accurate than the stress of the elements themselves.
//
// On a part's surface a polynomial would be extrapolated, from one side only and over as many
// elements again as are inside: across what a bore turns by in a few elements, and where stress
// falls most. There, and in the middle of edges between two nodes of the surface, the mean over the
// elements at the node is taken, each one's stress continued linearly from its integration points.
// `at_points`: 6 × (points · elements), those of an element in a row, in the order of
// TetrahedronRule(1 or 2). Returns 6 × slots.
Stresses RecoverByPatches(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes,
                          const PartSurface& surface, const Stresses& at_points, ThreadTeam& team);

// A number recovered at a slot as RecoverByPatches does, from one at each integration point, and
// how it follows from them and from where they are.
struct RecoveredValue {
  double value = 0;
  std::vector<int> points;      // the integration points that it is made of: columns of `at_points`
  std::vector<double> weights;  // of each: the value is the sum of weights times values
  Eigen::Matrix3Xd by_place;    // 3 × points, its derivative by the place of each, 1/m
  Eigen::Vector3d by_node = Eigen::Vector3d::Zero();  // by the place of the slot's node, 1/m
};

// Recovers a value at points. `at_points` has points · elements columns. Points may be there twice.
// O(elements) for the places of points.
RecoveredValue RecoverAt(const mesh::TetrahedralMesh& mesh, const PartNodes& nodes,
                         const PartSurface& surface, int slot, const Eigen::VectorXd& at_points);

}  // namespace mortise::simulator
