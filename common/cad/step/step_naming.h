// Names what was read from a STEP file, and adds the notes that need names.
#pragma once

#include "common/cad/step/step_assembly.h"

namespace mortise::cad {

// Gives parts, leaves and groups distinct names, and says where they differ from the file's.
void NameAll(StepAssembly& assembly);

// Says, by the parts' names, which are mirror images or larger or smaller than their product.
void TellOfDistortions(StepAssembly& assembly);

}  // namespace mortise::cad
