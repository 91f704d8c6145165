// What the contract has and templates cannot do yet: choices, absent and repeated parts. It is
// refused, lest a design lack silently what its template says.
#pragma once

#include "absl/status/status.h"
#include "mortise/v1/template.pb.h"
#include "mortise/v1/types.pb.h"

namespace mortise::templates {

// UNIMPLEMENTED, NOT_BUILT, naming the first such field of a template.
absl::Status CheckNoUnbuiltFields(const v1::Template& message);

// INVALID_ARGUMENT naming "parameters[i].choice" of each value that is given by a name, as no
// template has choices.
absl::Status CheckNoChoices(
    const google::protobuf::RepeatedPtrField<v1::ParameterValue>& parameters);

}  // namespace mortise::templates
