// Finds what can be seen to be wrong with a template at given parameters. Private to this folder;
// template_validation.h is the door.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/design/compiled_template.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {

// Checks shapes, sizes against items, penetrations, contacts and pegs at `q`. It goes on after a
// part or connection that fails, so that all that is wrong there is found. Each finding's `message`
// leaves out which parameters it was found at.
std::vector<FieldViolation> CheckDesign(const CompiledTemplate& compiled, const Eigen::VectorXd& q);

}  // namespace mortise::parametric
