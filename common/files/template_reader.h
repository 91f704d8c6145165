// Templates of parts as people write them: what can be read of a message, and all that is wrong
// with it. Target mortise_template_codec.
#pragma once

#include <vector>

#include "common/design/template_definition.h"
#include "common/design/template_validation.h"
#include "mortise/v1/template.pb.h"

namespace mortise::parametric {

// Returns what can be read of a template of parts, and findings about the rest: axes and kinds that
// are missing or unknown, parts without a body. Something of the same type stands for each of
// these.
TemplateDefinition ReadTemplate(const v1::Template& message, std::vector<FieldViolation>& findings);

// Returns everything wrong with a template of parts: what cannot be read, and what makes no sense
// of the rest, as ValidateTemplate says, but what only follows from something that cannot be read.
// `items` and `materials` are those that there are.
std::vector<FieldViolation> ValidateTemplateMessage(const v1::Template& message,
                                                    const std::vector<Item>& items,
                                                    const std::vector<Material>& materials);

}  // namespace mortise::parametric
