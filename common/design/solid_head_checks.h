// Checks what templates of one solid (lists of features, meshes in cages) have in common before
// their shape: texts, parameters, and the names of numbers.
#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "common/design/template_definition.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {

inline constexpr std::size_t kMaxSolidParameters = 64;

// Checks "templates/{id}", "materials/{id}", and texts of at most 1000 bytes.
void CheckSolidTexts(const std::string& name, const std::string& title,
                     const std::string& description, const std::string& material,
                     std::vector<FieldViolation>& findings);

// Checks that `name` is an identifier and not among `seen`, to which it is added.
void CheckUniqueName(const std::string& field, const std::string& name, std::set<std::string>& seen,
                     std::vector<FieldViolation>& findings);

// Checks the same of a parameter or definition, which is no word of the expression language either.
void CheckNumberName(const std::string& field, const std::string& name, std::set<std::string>& seen,
                     std::vector<FieldViolation>& findings);

// Checks that there are 1 to 64 parameters with names that are not among `seen`, units, and
// defaults within their ranges.
void CheckSolidParameters(const std::vector<Parameter>& parameters, std::set<std::string>& seen,
                          std::vector<FieldViolation>& findings);

// Checks that there are `least` to `most` of something.
void CheckCount(const std::string& field, std::size_t count, std::size_t least, std::size_t most,
                std::vector<FieldViolation>& findings);

}  // namespace mortise::parametric
