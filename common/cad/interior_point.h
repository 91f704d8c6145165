// A point inside a part's shape.
#pragma once

#include <Eigen/Core>

#include "common/mesh/part_shape.h"

namespace mortise::cad {

// A point strictly inside the prism: at half its height, in the middle of the widest stretch of the
// outline along a line that misses all corners.
Eigen::Vector3d InteriorPoint(const mesh::PartShape& part);

}  // namespace mortise::cad
