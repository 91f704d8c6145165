// Checks what people write: materials, items, and templates against the items they use. Everything
// that is wrong is found in one pass and reported with its place.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "common/base/field_violations.h"
#include "common/design/template_definition.h"

namespace mortise::parametric {

// Checks ranges, units and names of a material.
std::vector<FieldViolation> ValidateMaterial(const Material& material);

// Checks an item by itself: names, prices, dates, dimensions and their ranges. `materials` are
// those known.
std::vector<FieldViolation> ValidateItem(const Item& item, const std::vector<Material>& materials);

// Checks a template with the items and materials it may use: names and references, ranges,
// expressions; then, at the defaults, at every corner of the parameter box (the ends of single
// parameters where there are more than 6) and at random points (always the same), that parts have
// positive extents and simple outlines, agree with the dimensions of their items, do not penetrate
// each other, that connected parts touch, and that pegs lie inside their parts and clear of each
// other. Empty if the template can be built at all of them. At most 100 findings, the first of each
// kind and place.
std::vector<FieldViolation> ValidateTemplate(const TemplateBundle& bundle);

// Returns OK for no findings, else INVALID_ARGUMENT naming the fields of all of them.
absl::Status ToStatus(const std::vector<FieldViolation>& findings);

}  // namespace mortise::parametric
