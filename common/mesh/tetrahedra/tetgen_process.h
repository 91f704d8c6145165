// Runs TetGen in a process of its own. On some surfaces, mostly such with needles, it reads memory
// that is not its own, and it ends the process it is in on others: that is a failure of a mesh
// here, not of who asked for it.
#pragma once

#include <string>

// The library is compiled with this definition; without it the header declares functions that exit.
#define TETLIBRARY
#include <tetgen.h>

#include "absl/status/status.h"

namespace mortise::mesh {

// Fills `output` with the points, elements, attributes of elements and marked triangles that TetGen
// makes of `input` with `switches` (its manual, chapter 5) in at most so many seconds of processor
// time. The same input gives the same mesh, in any number of threads at once.
//
// Errors: RESOURCE_EXHAUSTED where memory ends; INTERNAL where TetGen fails, crashes or does not
// end in time, or no process can be made.
absl::Status RunTetGen(const std::string& switches, int seconds, tetgenio& input, tetgenio& output);

}  // namespace mortise::mesh
