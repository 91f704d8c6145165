// Assemblies as STEP files (ISO 10303-242), one named product a part under one named assembly.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"

namespace mortise::cad {

// A part of an assembly as people see it.
struct AssemblyPart {
  Solid solid;
  Eigen::Vector3d color = Eigen::Vector3d(0.8, 0.8, 0.8);  // linear red, green, blue in 0 … 1
};

// The bytes of a STEP file (AP242 DIS), lengths in millimetres as workshops expect, with the unit
// written in it. INTERNAL if the kernel fails.
absl::StatusOr<std::string> WriteStep(const std::string& assembly_name,
                                      const std::vector<AssemblyPart>& parts);

}  // namespace mortise::cad
