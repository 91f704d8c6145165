// By what a result is found again: a key of all that it depends on.
#pragma once

#include <string>

#include "mortise/v1/simulator.pb.h"

namespace mortise::simulator {

// Counted up where the same design gets other numbers, of our own evaluator: those that are stored
// are not given any more. 2: round faces in Gmsh's triangles; 3: elements that follow them;
// 4: stress on surfaces from the strain along them and the traction; 5: a budget of elements.
inline constexpr int kPhysicsVersion = 5;

// Counted up where our own files of shape and fields have more in them. 2: control variables.
inline constexpr int kFieldsVersion = 2;

// Returns the key of an evaluation's task in its queue: of the subject's digest, the exact
// parameters, the metrics and whether their gradients are wanted, what the request defines, what is
// wanted of shape and fields, and all settings. Those of our own evaluator depend on the version of
// its physics, those of others do not.
std::string ResultKey(const v1::Task& task, int physics_version = kPhysicsVersion);

}  // namespace mortise::simulator
