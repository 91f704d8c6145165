// Values of a template's parameters: vectors in the template's order, and values by name.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/design/template_definition.h"
#include "common/design/template_validation.h"

namespace mortise::parametric {

// Returns the default of every parameter.
Eigen::VectorXd Defaults(const std::vector<Parameter>& parameters);

// Returns the parameter vector with `values` where given and defaults elsewhere. INVALID_ARGUMENT
// naming "parameters[i]" for an unknown or repeated name, a value that is not finite or out of
// range (by more than 1e-9 of the range).
absl::StatusOr<Eigen::VectorXd> CompleteParameters(const std::vector<Parameter>& parameters,
                                                   const std::vector<NamedValue>& values);

// Returns `q` rounded to each parameter's step, what a workshop can set, and kept within the range.
Eigen::VectorXd RoundToSteps(const std::vector<Parameter>& parameters, const Eigen::VectorXd& q);

// Whether each value may be given to its parameter; otherwise INVALID_ARGUMENT naming the fields
// "parameters[i].value".
absl::Status CheckParameterValues(const std::vector<Parameter>& parameters,
                                  const Eigen::VectorXd& q);

// Returns every parameter out of its range, "parameters[i]"; or that there are too many or few of
// them.
std::vector<FieldViolation> CheckRanges(const std::vector<Parameter>& parameters,
                                        const Eigen::Ref<const Eigen::VectorXd>& q);

// Returns where a design is tried before it is accepted: the defaults first, so that what is wrong
// there is said of them; every corner of the parameter box, or the ends of single parameters where
// there are more than 6; and `random` points, always the same.
std::vector<Eigen::VectorXd> TrialPoints(const std::vector<Parameter>& parameters, int random);

// Returns "length = 0.2, width = 0.1", for people. `q` has one entry a parameter.
std::string ToText(const std::vector<Parameter>& parameters,
                   const Eigen::Ref<const Eigen::VectorXd>& q);

// Returns the names with their values, in order. `q` has one entry a parameter.
std::vector<NamedValue> NamedValues(const std::vector<Parameter>& parameters,
                                    const Eigen::VectorXd& q);

}  // namespace mortise::parametric
