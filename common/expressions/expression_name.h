// What a name in an expression stands for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/expressions/unit.h"

namespace mortise::parametric {

// A number, or a choice among values that have names and no order.
struct ExpressionName {
  std::string name;
  std::optional<Dimension> dimension = {};  // nothing where nobody knows
  std::vector<std::string> choices = {};    // names of the values 0, 1 …; none of a number
};

}  // namespace mortise::parametric
