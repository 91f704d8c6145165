// Any text either parses and evaluates to a finite number, or is refused.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>
#include <vector>

#include "common/expressions/expression.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using mortise::parametric::Expression;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::vector<mortise::parametric::ExpressionName> names = {
      {"length", mortise::parametric::Dimension{{"m", 1}}},
      {"width", std::nullopt},
      {"arms", std::nullopt, {"none", "both"}}};
  for (const double choice : {0.0, 1.0}) {
    if (const auto condition = Expression::ParseCondition(text, names); condition.ok()) {
      (void)condition->Holds(Eigen::Vector3d(1, 2, choice));
    }
  }
  const auto expression = Expression::Parse(text, names);
  if (!expression.ok()) return 0;
  for (const double q : {0.0, 1.0, -3.5, 1e150}) {
    const auto dual = expression->ValueAndGradient(Eigen::Vector3d(q, 2 - q, 1));
    if (dual.ok() && !(std::isfinite(dual->value) && dual->gradient.allFinite())) std::abort();
  }
  return 0;
}
