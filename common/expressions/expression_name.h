// What a name in an expression stands for.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/expressions/unit.h"

namespace mortise::terrain {
class HeightField;
}

namespace mortise::parametric {

// A parameter: a number, or a choice among values that have names and no order. Or ground, which is
// no parameter.
struct ExpressionName {
  std::string name;
  std::optional<Dimension> dimension = {};  // nothing where nobody knows
  std::vector<std::string> choices = {};    // names of the values 0, 1 …; none of a number
  std::shared_ptr<const terrain::HeightField> ground = {};  // null of a parameter
};

}  // namespace mortise::parametric
