// Axes and processes between structs and messages. For codecs alone.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "common/design/template_definition.h"
#include "mortise/v1/catalog.pb.h"

namespace mortise::parametric {

// INVALID_ARGUMENT naming `field` for anything but X, Y, Z.
absl::StatusOr<Axis> AxisFromProto(v1::Axis axis, const std::string& field);
v1::Axis AxisToProto(Axis axis);

// INVALID_ARGUMENT naming `field` for an unknown process.
absl::StatusOr<Process> ProcessFromProto(v1::Process process, const std::string& field);
v1::Process ProcessToProto(Process process);

}  // namespace mortise::parametric
