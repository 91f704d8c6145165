// Completes the units of a STEP file before its shapes are made. Private to this folder: it brings
// Open CASCADE.
#pragma once

#include <StepData_StepModel.hxx>
#include <string>
#include <vector>

namespace mortise::cad {

// Gives representations without a unit of length millimetres, as other programs take them; the
// kernel would take metres. An accuracy that says less than 0.05 mm becomes that: the kernel makes
// one of what is closer together than a file is accurate. Returns what was changed, for people, and
// which units are not what their name says.
std::vector<std::string> CompleteUnits(const Handle(StepData_StepModel) & model);

}  // namespace mortise::cad
