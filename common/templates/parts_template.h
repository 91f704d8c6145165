// Makes a template of parts whose sizes are expressions (docs/catalogue.md) a Template.
#pragma once

#include <memory>

#include "common/design/template_definition.h"
#include "common/templates/template.h"

namespace mortise::templates {

// Fails with INVALID_ARGUMENT naming the fields at fault, as parametric::TemplateFunction::Create
// does.
absl::StatusOr<std::shared_ptr<const Template>> MakePartsTemplate(
    const parametric::TemplateBundle& bundle);

}  // namespace mortise::templates
