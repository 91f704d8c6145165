// Reads the parts of a STEP assembly: names, places and mass properties.
#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace mortise::cad {

struct StepPart {
  std::string name;
  double volume = 0;        // m³
  Eigen::Vector3d minimum;  // m, bounding box in the assembly's frame
  Eigen::Vector3d maximum;  // m
};

struct StepAssembly {
  std::string name;
  std::string schema;           // as in FILE_SCHEMA
  std::vector<StepPart> parts;  // leaves, in file order
};

// INVALID_ARGUMENT if `bytes` are no STEP file that can be read, or hold no solid.
absl::StatusOr<StepAssembly> ReadStep(std::string_view bytes);

}  // namespace mortise::cad
