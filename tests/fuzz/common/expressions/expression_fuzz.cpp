// Any text either parses and evaluates to a finite number, or is refused.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "common/expressions/expression.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using mortise::parametric::Expression;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto expression = Expression::Parse(text, {"length", "width"});
  if (!expression.ok()) return 0;
  for (const double q : {0.0, 1.0, -3.5, 1e150}) {
    const auto dual = expression->ValueAndGradient(Eigen::Vector2d(q, 2 - q));
    if (dual.ok() && !(std::isfinite(dual->value) && dual->gradient.allFinite())) std::abort();
  }
  return 0;
}
