// Finds what can be seen to be wrong with a template without evaluating it. For those
// who read templates; template_validation.h is the door.
#pragma once

#include <vector>

#include "common/design/template_validation.h"

namespace mortise::parametric {

// Checks names, references, ranges, expressions and limits of size. If it finds nothing, the
// template compiles.
std::vector<FieldViolation> CheckTemplate(const TemplateBundle& bundle);

}  // namespace mortise::parametric
