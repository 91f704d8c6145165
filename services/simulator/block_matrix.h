// A symmetric sparse matrix of 3 × 3 blocks, one row and column of blocks for each node.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "common/mesh/tetrahedral_mesh.h"

namespace mortise::simulator {

// Only blocks on and above the diagonal are kept: column j holds rows i <= j, ascending.
class BlockMatrix {
 public:
  // The pattern in which nodes of a common element are coupled; all values zero.
  explicit BlockMatrix(const mesh::TetrahedralMesh& mesh);

  // Adds `block` to rows of node i and columns of node j, for i <= j; the pattern must have it.
  void Add(int i, int j, const Eigen::Matrix3d& block);

  // this · x, with x a 3 × nodes matrix (displacement of each node).
  Eigen::Matrix3Xd Multiply(const Eigen::Matrix3Xd& x) const;

  int nodes() const { return static_cast<int>(starts_.size()) - 1; }
  const std::vector<int>& starts() const { return starts_; }  // nodes + 1, of each column's blocks
  const std::vector<int>& rows() const { return rows_; }      // node of each block's rows
  const std::vector<Eigen::Matrix3d>& blocks() const { return blocks_; }

 private:
  std::vector<int> starts_;
  std::vector<int> rows_;
  std::vector<Eigen::Matrix3d> blocks_;
};

}  // namespace mortise::simulator
