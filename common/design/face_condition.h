// A support, load or heat on faces of one solid, or a load of all of it, at given parameters.
#pragma once

#include <string>
#include <vector>

#include "common/design/boundary_condition.h"

namespace mortise::parametric {

struct FaceCondition : ConditionNumbers {
  std::string name;
  BoundaryConditionKind kind = BoundaryConditionKind::kFixed;
  std::vector<int> faces;  // indices of the solid's faces; none for the whole body
  std::string load_case;   // of a load; empty where it acts in every one
};

}  // namespace mortise::parametric
