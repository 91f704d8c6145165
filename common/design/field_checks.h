// Checks of single fields, of which those of materials, items and templates are made.
#pragma once

#include <string>
#include <vector>

#include "common/design/template_definition.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {

// Checks the name of a resource: "materials/oak" for the collection "materials".
void CheckResourceName(const std::string& name, const std::string& collection,
                       std::vector<FieldViolation>& findings);

// Check texts for people, in characters of UTF-8: a title of at most 200, a description of at most
// 10,000. Lists show many of them in one message.
void CheckTitle(const std::string& field, const std::string& text,
                std::vector<FieldViolation>& findings);
void CheckDescription(const std::string& field, const std::string& text,
                      std::vector<FieldViolation>& findings);

// Checks that a text has at most 1000 bytes.
void CheckText(const std::string& field, const std::string& text,
               std::vector<FieldViolation>& findings);

// Checks that a text is empty, or a link that leads to a page, of at most 1000 bytes.
void CheckLink(const std::string& field, const std::string& link,
               std::vector<FieldViolation>& findings);

// Checks the unit of a parameter: one of those in docs/templates.md, all SI and without prefixes
// but of the kilogram; "1" for none.
void CheckUnit(const std::string& field, const std::string& unit,
               std::vector<FieldViolation>& findings);

// Checks the names of a choice's values, and that its numbers are those that follow from them.
void CheckChoices(const std::string& field, const Parameter& parameter,
                  std::vector<FieldViolation>& findings);

void CheckPositive(const std::string& field, double value, std::vector<FieldViolation>& findings);
void CheckNotNegative(const std::string& field, double value,
                      std::vector<FieldViolation>& findings);

}  // namespace mortise::parametric
