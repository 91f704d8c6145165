// Makes a LinearSolver by Cholesky's factor.
#pragma once

#include <memory>

#include "common/fem/linear/linear_solver.h"

namespace mortise::simulator {

// Analyses the pattern. RESOURCE_EXHAUSTED if the factor would exceed the limit.
absl::StatusOr<std::unique_ptr<LinearSolver>> CreateDirectSolver(
    std::shared_ptr<const BlockPattern> pattern, const Eigen::Array3Xi& fixed,
    const SolverOptions& options);

}  // namespace mortise::simulator
