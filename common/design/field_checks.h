// Checks of single fields, of which those of materials, items and templates are made.
#pragma once

#include <string>
#include <vector>

#include "common/parametric/template_validation.h"

namespace mortise::parametric {

// "materials/oak" for the collection "materials".
void CheckResourceName(const std::string& name, const std::string& collection,
                       std::vector<Finding>& findings);

// Texts for people, in characters of UTF-8: a title of at most 200, a description of at most
// 10,000. Lists show many of them in one message.
void CheckTitle(const std::string& field, const std::string& text, std::vector<Finding>& findings);
void CheckDescription(const std::string& field, const std::string& text,
                      std::vector<Finding>& findings);

// At most 1000 bytes.
void CheckText(const std::string& field, const std::string& text, std::vector<Finding>& findings);

// Empty, or a link that leads to a page; at most 1000 bytes.
void CheckLink(const std::string& field, const std::string& link, std::vector<Finding>& findings);

// Of a parameter: one of those in docs/templates.md, all SI and without prefixes but of the
// kilogram; "1" for none.
void CheckUnit(const std::string& field, const std::string& unit, std::vector<Finding>& findings);

void CheckPositive(const std::string& field, double value, std::vector<Finding>& findings);
void CheckNotNegative(const std::string& field, double value, std::vector<Finding>& findings);

// Whether `name` is 1 to 63 lower-case letters, digits and underscores, beginning with a letter.
bool IsMeasureName(const std::string& name);

}  // namespace mortise::parametric
