// A symmetric sparse matrix of 3 × 3 blocks, one row and column of blocks for each node.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "common/fem/linear/block_pattern.h"
#include "common/fem/linear/thread_team.h"
#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Values on a pattern that several matrices (stiffness and mass, or the stiffnesses of a sweep of
// parameters) may share. Only blocks on and above the diagonal are kept.
class BlockMatrix {
 public:
  // Makes a matrix whose values are all zero.
  explicit BlockMatrix(std::shared_ptr<const BlockPattern> pattern);

  // Makes a matrix on a pattern of its own.
  explicit BlockMatrix(const mesh::TetrahedralMesh& mesh);

  // Adds `block` to rows of node i and columns of node j, for i <= j; the pattern must have it.
  void Add(int i, int j, const Eigen::Matrix3d& block);

  // Adds the matrix of every element. integrate(e, blocks) writes the blocks of element e, in the
  // order of BlockPattern::pairs(), zero before; it is called from the team's threads. Each value
  // is summed in the order of elements, so that it does not depend on the number of threads.
  void AddElements(const std::function<void(int, Eigen::Matrix3d*)>& integrate, ThreadTeam& team);

  // Returns this · x, with x a 3 × nodes matrix (displacement of each node).
  Eigen::Matrix3Xd Multiply(const Eigen::Matrix3Xd& x) const;

  // Does the same on the threads of a team: y = this · x, to the same bits.
  void Multiply(const Eigen::Matrix3Xd& x, Eigen::Matrix3Xd& y, ThreadTeam& team) const;

  // Does the same on 3 · nodes numbers each.
  void Multiply(const double* x, double* y, ThreadTeam& team) const;

  int nodes() const { return pattern_->nodes(); }
  const std::shared_ptr<const BlockPattern>& pattern() const { return pattern_; }
  const std::vector<int>& starts() const { return pattern_->starts(); }
  const std::vector<int>& rows() const { return pattern_->rows(); }
  const std::vector<Eigen::Matrix3d>& blocks() const { return blocks_; }  // one for each slot
  std::vector<Eigen::Matrix3d>& blocks() { return blocks_; }

 private:
  std::shared_ptr<const BlockPattern> pattern_;
  std::vector<Eigen::Matrix3d> blocks_;
};

}  // namespace mortise::simulator
