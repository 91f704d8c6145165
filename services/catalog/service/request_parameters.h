// Reads the parameters of a request that looks at an assembly, before that is tried.
#pragma once

#include <google/protobuf/repeated_field.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/parametric_assembly.h"
#include "mortise/v1/assembly.pb.h"

namespace mortise::catalog {

// Returns the parameters of a request, which are its `field`; those drawn if it has none.
// INVALID_ARGUMENT naming each number that is not finite, too far away or a size that is not
// positive ("q[4]"), or the field where there are too few or too many of them, or the design would
// have far too many parts.
absl::StatusOr<Eigen::VectorXd> RequestParameters(const google::protobuf::RepeatedField<double>& q,
                                                  const parametric::ParametricAssembly& assembly,
                                                  const std::string& field);

// Returns those of each of the points, with what is wrong with any of them; of very much, the
// first 40.
absl::StatusOr<std::vector<Eigen::VectorXd>> RequestPoints(
    const google::protobuf::RepeatedPtrField<v1::EvaluateAssemblyRequest::Point>& points,
    const parametric::ParametricAssembly& assembly);

}  // namespace mortise::catalog
