// A template of parts whose sizes are expressions (docs/catalogue.md), as a Template.
#pragma once

#include <memory>

#include "common/design/template_definition.h"
#include "common/templates/template.h"

namespace mortise::templates {

// INVALID_ARGUMENT naming the fields at fault, as parametric::TemplateFunction::Create.
absl::StatusOr<std::shared_ptr<const Template>> MakePartsTemplate(
    const parametric::TemplateBundle& bundle);

}  // namespace mortise::templates
