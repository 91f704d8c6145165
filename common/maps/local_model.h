// How strongly a function bends over an element along each direction, from what is known around it.
// Private to this folder. Our own.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/maps/known_points.h"
#include "common/maps/lattice.h"

namespace mortise::maps {

// Fits 1, z … z⁴ of each direction and z_a z_b (z: 0 at the centre of the box, ±1/2 on its faces)
// to the values of the points by weighted least squares, with a slight penalty on the curved terms,
// so that few points do, and a larger one on the third and fourth power, which are there so that
// they are not taken for bending along others. Products of two directions are there because
// multi-linear functions have them, and take no part in the error. Returns K × outputs: the error
// of linear interpolation along each direction at the centre.
Eigen::MatrixXd BendingOver(const LatticeBox& box, int dimension, int outputs,
                            const KnownPoints& points, const std::vector<int>& numbers);

}  // namespace mortise::maps
