#include "common/expressions/identifier.h"

#include <algorithm>
#include <array>

namespace mortise::parametric {

bool IsIdentifier(std::string_view name) {
  if (name.empty() || name.size() > 63 || (name[0] >= '0' && name[0] <= '9')) return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
  });
}

bool IsReserved(std::string_view name) {
  constexpr std::array<std::string_view, 18> kWords = {"pi",
                                                       "sqrt",
                                                       "sin",
                                                       "cos",
                                                       "tan",
                                                       "floor",
                                                       "ceil",
                                                       "abs",
                                                       "min",
                                                       "max",
                                                       "if",
                                                       "and",
                                                       "or",
                                                       "not",
                                                       "terrain",
                                                       "terrain_slope",
                                                       "terrain_lowest",
                                                       "terrain_highest"};
  return std::find(kWords.begin(), kWords.end(), name) != kWords.end();
}

bool IsMeasureName(const std::string& name) {
  if (name.empty() || name.size() > 63 || name[0] < 'a' || name[0] > 'z') return false;
  return std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace mortise::parametric
