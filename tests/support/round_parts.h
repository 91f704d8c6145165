// Drawings of round parts that fit into each other, as STEP: what imports take longest over. Made
// by the CAD kernel, the same each time.
#pragma once

#include <string>

namespace mortise::testing {

// Returns a shaft in a bearing in a housing, with two collars and a cap: seven round parts about
// one axis, each in contact with its neighbours over cylinders and faces.
std::string BearingStep();

// Returns a board with `pins` bores in rows of ten, and in each bore a pin with a washer above and
// one below the board: 3 · pins + 1 parts.
std::string PinBoardStep(int pins);

}  // namespace mortise::testing
