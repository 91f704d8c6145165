// Adds to a design what a request says of how it is held, loaded and heated.
#pragma once

#include "absl/status/status.h"
#include "common/design/evaluated_design.h"
#include "mortise/v1/simulator.pb.h"

namespace mortise::simulator {

// Adds the conditions of `setup` behind those of the design, and takes its reference temperature.
// What the setup leaves out is put in its place in the message: names, and parts that the faces
// name or of which only one bears. INVALID_ARGUMENT naming all that is wrong, below "setup": a part
// or face that there is not (with what there is), numbers that their kind does not take.
absl::Status AddSetup(v1::AnalysisSetup& setup, parametric::EvaluatedDesign& design);

}  // namespace mortise::simulator
