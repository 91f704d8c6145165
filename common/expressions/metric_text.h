// The text of a metric's expression: what stands in quotes, functions of places and numbers with
// units, taken out of it. Private to metric_expressions.cpp and its tests.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "common/expressions/metric_function.h"
#include "common/expressions/unit.h"

namespace mortise::parametric {

// A number with a unit, '30 N m', in SI units.
struct Quantity {
  double value = 0;
  Dimension dimension;
};

// What stood in quotes, in its order; the others are empty.
struct QuotedTerm {
  std::string name;  // that stands for it in the text
  MetricCall call;   // without a function: it is a quantity
  Quantity quantity;
};

struct MetricText {
  // For Expression: as long as the original, with a name in the place of each term, so that columns
  // stay what they are.
  std::string text;
  std::vector<QuotedTerm> terms;
};

// INVALID_ARGUMENT with the column (counted from 1) and what was expected there.
absl::StatusOr<MetricText> ReadMetricText(std::string_view text);

}  // namespace mortise::parametric
