// Makes an assembly of a STEP file and the annotations beside it.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/assembly/parametric_assembly.h"
#include "common/cad/step/step_assembly.h"
#include "common/design/template_definition.h"
#include "common/design/template_validation.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::catalog {

// An assembly as it was drawn. Fields are those of ImportAssemblyStepRequest.
struct DrawnAssembly {
  v1::Assembly assembly;
  // Where the file and the annotations do not agree; parts at fault have no item in `assembly`.
  std::vector<FieldViolation> findings;
  std::vector<std::string> notes;  // for people
  std::vector<int> annotations;    // of each part, index into AssemblyAnnotations::parts, or -1
};

// Returns the bytes of a STEP file that may be packed by gzip. RESOURCE_EXHAUSTED, "step", past 64
// MiB; INVALID_ARGUMENT if they cannot be unpacked.
absl::StatusOr<std::string> UnpackStep(const std::string& bytes);

// Makes every solid a part, its box in the design's axes and its shape, by name, if it does
// not fill that; the sub-assemblies are the groups, as far as there are parts in them. The
// drawing's shapes must have names. A part without annotation is principal and has no item. An item
// lies in the part in the way that its fixed sizes fit, its length along the longest. `items` are
// those that the annotations name and that exist.
DrawnAssembly MakeAssembly(const cad::StepAssembly& drawing,
                           const v1::AssemblyAnnotations& annotations,
                           const std::vector<parametric::Item>& items);

// Returns what to tell of sizes that the design holds (ParametricAssembly::HeldSizes); nothing if
// there are none.
std::string NoteOnHeldSizes(const std::vector<parametric::Measure>& held);

// What is wrong with `drawn`: its findings and those of `checked`, which names fields of the
// assembly, all at their places in the request. OK if there are none.
absl::Status AtRequest(const DrawnAssembly& drawn, const v1::AssemblyAnnotations& annotations,
                       const absl::Status& checked);

}  // namespace mortise::catalog
