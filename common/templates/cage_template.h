// Makes a mesh in a cage (thesis §7.6.2) a Template of one part.
#pragma once

#include <memory>

#include "common/templates/cage/cage_template.h"
#include "common/templates/template.h"

namespace mortise::templates {

// Makes the template as MakeFeatureTemplate does. It has exact gradients of volume and mass, and no
// boundary representation.
absl::StatusOr<std::shared_ptr<const Template>> MakeCageTemplate(
    TemplateHead head, parametric::CageTemplate definition);

}  // namespace mortise::templates
