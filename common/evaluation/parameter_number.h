// The number of a parameter that is given by its value or, of a choice, by the name of it.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "mortise/v1/types.pb.h"

namespace mortise::evaluation {

// Returns the number; `choices` are the names of the values, none of a number. Whether it is within
// the range is not looked at. INVALID_ARGUMENT naming `field`.choice for a name that is none of
// them, or that says another value than the number beside it.
absl::StatusOr<double> NumberOf(const v1::ParameterValue& given,
                                const google::protobuf::RepeatedPtrField<std::string>& choices,
                                const std::string& field);

}  // namespace mortise::evaluation
