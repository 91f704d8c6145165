// What parameters, definitions, features, faces and conditions may be called.
#pragma once

#include <string_view>

namespace mortise::parametric {

// Whether `name` is a letter or underscore, then letters, digits and underscores, 63 at most.
bool IsIdentifier(std::string_view name);

// Whether `name` is a word of the expression language (expression.h), such as "pi" or "sin".
bool IsReserved(std::string_view name);

// Whether `name` is 1 to 63 lower-case letters, digits and underscores, beginning with a letter.
bool IsMeasureName(const std::string& name);

}  // namespace mortise::parametric
