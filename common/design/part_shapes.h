// The parts of a design as the CAD kernel takes them.
#pragma once

#include <vector>

#include "common/design/evaluated_design.h"
#include "common/mesh/shapes/part_shape.h"

namespace mortise::parametric {

// Returns the shape of a part that is a prism, named as the part. Faces keep their names.
mesh::PartShape PartShapeOf(const EvaluatedPart& part);

// Returns the shapes of all parts, in order.
std::vector<mesh::PartShape> PartShapes(const EvaluatedDesign& design);

}  // namespace mortise::parametric
