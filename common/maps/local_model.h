// How strongly a function bends over an element along each direction, from what is known around it.
// Our own.
#pragma once

#include <Eigen/Core>

#include "common/maps/refinement_tree.h"

namespace mortise::maps {

// Fits 1, z … z⁴ of each direction and z_a z_b (z: 0 at the centre of the box, ±1/2 on its faces)
// to the values of the points by weighted least squares, with a slight penalty on the curved terms,
// so that few points do, and a larger one on the third and fourth power, which are there so that
// they are not taken for bending along others. Products of two directions are there because
// multi-linear functions have them, and take no part in the error. points: K × n, at least one, in
// the unit box; values: outputs × n. Returns K × outputs: the error of linear interpolation along
// each direction at the centre.
Eigen::MatrixXd BendingOver(const ElementBox& box, const Eigen::MatrixXd& points,
                            const Eigen::MatrixXd& values);

}  // namespace mortise::maps
