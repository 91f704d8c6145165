// Evaluates the pieces of a compiled template one by one, so that a check can go on after a piece
// that fails. Private to this folder; evaluation.h is the door.
#pragma once

#include <Eigen/Core>

#include "absl/status/statusor.h"
#include "common/design/compiled_template.h"
#include "common/design/evaluated_design.h"

namespace mortise::parametric {

// Returns the part of this index. INVALID_ARGUMENT naming the expression that fails, or the extent
// or outline that is no shape.
absl::StatusOr<EvaluatedPart> EvaluatePart(const CompiledTemplate& compiled, std::size_t part,
                                           const Eigen::VectorXd& q);

inline constexpr int kMaxRow = 200;  // pegs of a connection

// Returns the pegs of the connection of this index, for parts already evaluated. INVALID_ARGUMENT
// naming the connection if the parts do not touch, or its spacing if that makes more than kMaxRow.
absl::StatusOr<std::vector<EvaluatedConnector>> EvaluateConnection(
    const CompiledTemplate& compiled, std::size_t connection,
    const std::vector<EvaluatedPart>& parts);

// Returns the volume of the part of this index, m³, with its gradient.
absl::StatusOr<Dual> EvaluateVolume(const CompiledPart& part, const Eigen::VectorXd& q);

}  // namespace mortise::parametric
