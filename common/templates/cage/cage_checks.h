// Finds what can be seen to be wrong with a cage template without evaluating it. Private to the
// cage_* files; cage_model.h is the door.
#pragma once

#include <vector>

#include "common/design/template_validation.h"
#include "common/templates/cage/cage_template.h"

namespace mortise::parametric {

// Finds lists that are shorter or longer than they may be. Nothing else is worth looking at then.
std::vector<FieldViolation> CheckCageSizes(const CageTemplate& definition);

// Checks names, ranges, references, and whether the surface is closed and does not cross itself.
// Expressions are for CageExpressions, the cage for CageModel.
std::vector<FieldViolation> CheckCageTemplate(const CageTemplate& definition);

// Returns all triangles of a surface, face by face.
Eigen::Matrix3Xi TrianglesOf(const CageSurface& surface);

}  // namespace mortise::parametric
