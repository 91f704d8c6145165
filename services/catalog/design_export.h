// Designs as files that other programs open.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "common/parametric/evaluated_design.h"
#include "common/parametric/template_definition.h"

namespace mortise::catalog {

// STEP AP242: the B-rep of every part under its name, in an assembly named `assembly_name`.
absl::StatusOr<std::string> ExportStep(const parametric::EvaluatedDesign& design,
                                       const parametric::TemplateBundle& bundle,
                                       const std::string& assembly_name);

// Binary glTF: the triangles of every part.
absl::StatusOr<std::string> ExportGlb(const parametric::EvaluatedDesign& design,
                                      const parametric::TemplateBundle& bundle,
                                      const std::string& assembly_name);

}  // namespace mortise::catalog
