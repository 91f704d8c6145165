// Units as people write them, "N m", "W/(m^2 K)", "mm", "EUR": what they measure, and how much.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace mortise::parametric {

// How often m, kg, s, K and currencies (ISO 4217) are in a unit: N is {kg: 1, m: 1, s: -2}. Without
// entries of 0; angles are plain numbers.
using Dimension = std::map<std::string, double>;

struct Unit {
  Dimension dimension;
  double factor = 1;  // SI units in one of these: 0.001 of "mm"
};

// Grammar: factors beside each other or joined by "*", at most one "/" after which a group of
// several stands in parentheses, powers with "^". Factors are 1, m, kg, g, s, min, h, K, rad, deg,
// Hz, N, Pa, J, W and currencies, those but kg, 1, min, h, K, rad and deg also with the prefixes
// u, m, c, k, M and G where people use them ("mm", "cm", "kN", "MPa"). INVALID_ARGUMENT saying what
// is not known.
absl::StatusOr<Unit> ParseUnit(std::string_view text);

// "kg m^2 s^-2"; "1" for none.
std::string ToText(const Dimension& dimension);

}  // namespace mortise::parametric
