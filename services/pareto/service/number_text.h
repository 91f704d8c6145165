// Numbers for people.
#pragma once

#include <string>

namespace mortise::pareto {

// `value` in six digits, or in as many as it takes to print it otherwise than `other`, which it is
// compared with: what misses a limit must not look as if it met it. Of equal ones in six digits.
std::string TextBeside(double value, double other);

}  // namespace mortise::pareto
