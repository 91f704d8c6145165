// Which annotation is about which part of a STEP file.
#pragma once

#include <vector>

#include "common/cad/step/step_assembly.h"
#include "common/design/template_definition.h"
#include "common/design/template_validation.h"
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
                             std::vector<FieldViolation>& findings);

// Returns what is wrong with annotations of the parts of no drawing: the items (`items` are those
// that exist), roles, axes, groups, planes and titles that they name. `annotations.parts[i]` for
// each i of `which`; `groups` are those that there are. Fields as above.
std::vector<FieldViolation> CheckWithoutParts(
    const v1::AssemblyAnnotations& annotations, const std::vector<int>& which,
    const google::protobuf::RepeatedPtrField<v1::AssemblyGroup>& groups,
    const std::vector<parametric::Item>& items);

// The same of all annotations to a file that cannot be read, and of the texts about the whole.
std::vector<FieldViolation> CheckWithoutDrawing(const v1::AssemblyAnnotations& annotations,
                                                const std::vector<parametric::Item>& items);

}  // namespace mortise::catalog
