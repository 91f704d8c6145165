// Writes assemblies as STEP files (ISO 10303-242): named products under named sub-assemblies.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"
#include "common/cad/step/step_assembly.h"

namespace mortise::cad {

enum class StepUnit { kMillimetre, kMetre, kInch };

// Returns the bytes of a STEP file (AP242 DIS): the same for the same assembly, as the header has
// its name and time stamp (1970 if there is none) and nothing of when and where it was written.
// Each group a sub-assembly, each product a shape that is written once, each part an occurrence of
// it with its name, place and colour. Of the parts, only name, group, product, placement and colour
// count. Products and the whole have the ids, revisions and descriptions of their identities.
// Lengths are in millimetres, as workshops expect, unless another unit is asked for; the file says
// which. INVALID_ARGUMENT naming "parts[i].product" where a product has no solid;
// FAILED_PRECONDITION, NO_STEP, for one that readers would take for another solid, as a ball that
// is stretched unevenly may be; INTERNAL if the kernel fails.
absl::StatusOr<std::string> WriteStep(const StepAssembly& assembly,
                                      StepUnit unit = StepUnit::kMillimetre);

// A part of an assembly as people see it.
struct AssemblyPart {
  Solid solid;
  Eigen::Vector3d color = Eigen::Vector3d(0.8, 0.8, 0.8);  // linear red, green, blue in 0 … 1
};

// Writes an assembly without sub-assemblies, one product a part.
absl::StatusOr<std::string> WriteStep(const std::string& assembly_name,
                                      const std::vector<AssemblyPart>& parts);

}  // namespace mortise::cad
