// What can be seen to be wrong with a list of features without any number: names, references, and
// what features are given. Private to this folder; feature_model.h is the door.
#pragma once

#include <vector>

#include "common/cad/cad_template.h"
#include "common/parametric/template_validation.h"

namespace mortise::cad {

// All findings at once; expressions are left to FeatureNumbers.
std::vector<parametric::Finding> CheckFeatures(const CadTemplate& definition);

}  // namespace mortise::cad
