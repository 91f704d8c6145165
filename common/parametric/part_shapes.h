// The parts of a design as the CAD kernel takes them.
#pragma once

#include <vector>

#include "common/cad/part_shape.h"
#include "common/parametric/evaluated_design.h"

namespace mortise::parametric {

// One shape a part, in order, named as the parts. Faces keep their names.
std::vector<cad::PartShape> PartShapes(const EvaluatedDesign& design);

}  // namespace mortise::parametric
