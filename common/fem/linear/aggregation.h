// Builds coarse levels by smoothed aggregation, which know only a matrix and the motions it resists
// least.
//
// P. Vaněk, J. Mandel, M. Brezina, "Algebraic multigrid by smoothed aggregation for second and
// fourth order elliptic problems", Computing 56 (1996): nodes that are strongly coupled make one
// coarse node with six unknowns, whose basis is the rigid motions of the aggregate; one step of
// Jacobi's method smooths the basis, and the coarse matrix is PᵀAP.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "common/fem/linear/block_rows.h"
#include "common/fem/linear/multigrid_level.h"
#include "common/fem/linear/multigrid_options.h"
#include "common/fem/linear/thread_team.h"

namespace mortise::simulator {

// The six rigid motions at a node with B unknowns.
template <int B>
using RigidModes = std::vector<Eigen::Matrix<double, B, 6>>;

// The index of the aggregate of each node, or -1 if it is coupled to no other. Blocks weaker than
// `strength`, next to the diagonal ones of their nodes, do not couple.
struct Aggregates {
  std::vector<int> of;
  int count = 0;
};
template <int B>
Aggregates FindAggregates(const BlockRows<double, B, B>& matrix, double strength);

// Returns a preconditioner of a symmetric positive definite matrix, down to a level small enough
// for a dense factor. `modes`: for each node, zero in rows of prescribed displacements. `team` must
// outlive it. Null if the coarsest matrix is not positive definite: the structure is a mechanism.
std::unique_ptr<Corrector> BuildAggregationLevels(BlockRows<double, 3, 3> matrix,
                                                  const RigidModes<3>& modes,
                                                  const MultigridOptions& options,
                                                  ThreadTeam& team);

}  // namespace mortise::simulator
