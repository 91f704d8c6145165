// Makes a CAD template, a list of features (thesis §6.1), a Template of one part.
#pragma once

#include <memory>

#include "common/templates/features/cad_template.h"
#include "common/templates/template.h"

namespace mortise::templates {

// `head` says what the catalog knows; its title and parameters are taken from `definition`. Each
// boundary condition of F(q) has a face of its own name, "condition:<name>", which is all the faces
// that it acts on together. INVALID_ARGUMENT naming all that cad::ValidateCadTemplate finds, or
// "material" if it is not among those of `head`.
absl::StatusOr<std::shared_ptr<const Template>> MakeFeatureTemplate(TemplateHead head,
                                                                    cad::CadTemplate definition);

}  // namespace mortise::templates
