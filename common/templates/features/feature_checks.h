// Finds what can be seen to be wrong with a list of features without any number: names, references,
// and what features are given. Private to this folder; feature_model.h is the door.
#pragma once

#include <cstddef>
#include <vector>

#include "common/design/template_validation.h"
#include "common/templates/features/cad_template.h"

namespace mortise::cad {

// The most that a template may have; one that has more is not looked at further.
inline constexpr std::size_t kMaxDefinitions = 500;
inline constexpr std::size_t kMaxFeatures = 500;

// Returns all findings at once; expressions are left to FeatureNumbers.
std::vector<FieldViolation> CheckFeatures(const CadTemplate& definition);

}  // namespace mortise::cad
