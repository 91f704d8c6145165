// Values of a template's parameters: vectors in the template's order, and values by name.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/design/evaluated_design.h"
#include "common/design/structure.h"
#include "common/design/template_definition.h"
#include "common/design/template_validation.h"
#include "common/expressions/expression_name.h"

namespace mortise::parametric {

// Fills in what a choice leaves out: unit, minimum, maximum and step. Numbers stay as they are.
void FillChoice(Parameter& parameter);

// Returns what expressions may name, in order.
std::vector<ExpressionName> ExpressionNames(const std::vector<Parameter>& parameters);

// Whether a parameter takes whole numbers alone: a choice, or one with a step of 1 from a whole
// minimum.
bool IsWhole(const Parameter& parameter);

// Returns `q` with those that take whole numbers alone rounded to them; the others as they are.
Eigen::VectorXd WithWholeNumbers(const std::vector<Parameter>& parameters, Eigen::VectorXd q);

// Returns the name of the value of this number; empty of what is no choice or no value of it.
const std::string& ChoiceAt(const Parameter& parameter, double value);

// Returns the default of every parameter.
Eigen::VectorXd Defaults(const std::vector<Parameter>& parameters);

// Returns the parameter vector with `values` where given and defaults elsewhere. INVALID_ARGUMENT
// naming "parameters[i]" for an unknown or repeated name, a value that is not finite or out of
// range (by more than 1e-9 of the range), and what is no value of a choice. Choices are given by
// the name of the value, by its number, or by both where they agree.
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
// there is said of them; every combination of choices, or each value by itself where there are more
// than 256 combinations; every corner of the box of the other parameters, or the ends of single
// ones where there are more than 6; and `random` points, always the same, with whole numbers where
// a parameter is one. Corners come with every combination where that makes no more than 256 points;
// otherwise they, and random points, go through the combinations in turn.
std::vector<Eigen::VectorXd> TrialPoints(const std::vector<Parameter>& parameters, int random);

// Returns "length = 0.2, armrests = both", for people. `q` has one entry a parameter.
std::string ToText(const std::vector<Parameter>& parameters,
                   const Eigen::Ref<const Eigen::VectorXd>& q);

// Returns what each parameter that is a choice is, in order.
std::vector<StructureChoice> ChosenAt(const std::vector<Parameter>& parameters,
                                      const Eigen::VectorXd& q);

// Returns the names with their values, and the names of values of choices, in order. `q` has one
// entry a parameter.
std::vector<NamedValue> NamedValues(const std::vector<Parameter>& parameters,
                                    const Eigen::VectorXd& q);

}  // namespace mortise::parametric
