// A multigrid preconditioner for the stiffness of solids meshed with tetrahedra.
//
// Quadratic elements first step down to linear ones on the same corners, whose displacements are
// among the quadratic ones: a node in the middle of an edge moves by the mean of the edge's ends.
// From there, or at once where elements are far longer than high, smoothed aggregation with the six
// rigid motions (aggregation.h) goes on.
#pragma once

#include <Eigen/Core>
#include <memory>

#include "absl/status/status.h"
#include "common/fem/linear/block_matrix.h"
#include "common/fem/linear/multigrid_options.h"
#include "common/fem/linear/node_frames.h"
#include "common/fem/linear/thread_team.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

class Multigrid {
 public:
  // `fixed` is 3 × nodes, non-zero where a displacement is prescribed; it is counted, like the
  // stiffness' rows, along `frames`. `team` must outlive it.
  Multigrid(const mesh::TetrahedralMesh& mesh, const Eigen::Array3Xi& fixed,
            const NodeFrames& frames, const MultigridOptions& options, ThreadTeam& team);
  ~Multigrid();

  // Builds the levels for these values; `positions`: 3 × nodes, m. FAILED_PRECONDITION, reason
  // SINGULAR, if the coarsest one is not positive definite: something is free to move.
  absl::Status Prepare(const BlockMatrix& stiffness, const Eigen::Matrix3Xd& positions);

  // Computes x ≈ K⁻¹ b (3 · nodes), zero where displacements are prescribed; b must be zero there.
  // It is a fixed, linear, symmetric and positive operation, the same to the bit on any number of
  // threads.
  void Correct(const Eigen::VectorXd& b, Eigen::VectorXd& x);

  double Bytes() const;  // of all levels
  int Levels() const;

  // Estimates what Prepare will take, bytes.
  static double EstimateBytes(const mesh::TetrahedralMesh& mesh, const BlockPattern& pattern);

 private:
  struct Topology;
  struct Hierarchy;
  std::unique_ptr<Topology> topology_;
  std::unique_ptr<Hierarchy> hierarchy_;
  MultigridOptions options_;
  ThreadTeam& team_;
};

}  // namespace mortise::simulator
