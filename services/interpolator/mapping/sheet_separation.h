// Takes apart what touches itself in an edge or a vertex, so that it can be walked on. Private to
// this folder.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::interpolator {

// Gives each sheet of a surface vertices of its own where several meet in one, or in an edge of
// more than two triangles: two boxes that stand corner to corner. The first keeps the vertex, the
// others get copies, behind all others. At an edge those triangles belong together that have the
// solid between them. `triangles`: outward. Returns for each copy which vertex it is one of.
std::vector<int> SeparateSheets(const Eigen::Matrix3Xd& vertices, Eigen::Matrix3Xi& triangles);

}  // namespace mortise::interpolator
