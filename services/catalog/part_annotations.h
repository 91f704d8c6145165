// Which annotation is about which part of a STEP file.
#pragma once

#include <vector>

#include "common/cad/step_assembly.h"
#include "common/parametric/template_validation.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::catalog {

// Index into AssemblyAnnotations::parts, or -1, of each part and of each leaf that is none.
struct Assignment {
  std::vector<int> parts;
  std::vector<int> leaves;
};

// Adds to `findings`, with fields of ImportAssemblyStepRequest: annotations of parts that are not
// there, parts that have several, annotations that contradict themselves, surfaces that are not
// said to be left out.
Assignment AssignAnnotations(const cad::StepAssembly& drawing,
                             const v1::AssemblyAnnotations& annotations,
                             std::vector<parametric::Finding>& findings);

}  // namespace mortise::catalog
