#include "services/simulator/block_matrix.h"

#include <algorithm>

namespace mortise::simulator {

BlockMatrix::BlockMatrix(const mesh::TetrahedralMesh& mesh) {
  const int node_count = static_cast<int>(mesh.nodes.cols());
  const int corners = static_cast<int>(mesh.tetrahedra.rows());
  const int elements = static_cast<int>(mesh.tetrahedra.cols());
  // Elements round each node, as a compressed list.
  std::vector<int> first(node_count + 1, 0), around(std::size_t(corners) * elements);
  for (Eigen::Index k = 0; k < mesh.tetrahedra.size(); ++k) ++first[mesh.tetrahedra.data()[k] + 1];
  for (int v = 0; v < node_count; ++v) first[v + 1] += first[v];
  std::vector<int> next(first.begin(), first.end() - 1);
  for (int e = 0; e < elements; ++e) {
    for (int k = 0; k < corners; ++k) around[next[mesh.tetrahedra(k, e)]++] = e;
  }
  starts_.reserve(node_count + 1);
  starts_.push_back(0);
  std::vector<int> seen(node_count, -1);
  for (int j = 0; j < node_count; ++j) {
    const std::size_t begin = rows_.size();
    for (int a = first[j]; a < first[j + 1]; ++a) {
      for (int k = 0; k < corners; ++k) {
        const int i = mesh.tetrahedra(k, around[a]);
        if (i > j || seen[i] == j) continue;
        seen[i] = j;
        rows_.push_back(i);
      }
    }
    std::sort(rows_.begin() + begin, rows_.end());
    starts_.push_back(static_cast<int>(rows_.size()));
  }
  blocks_.assign(rows_.size(), Eigen::Matrix3d::Zero());
}

void BlockMatrix::Add(int i, int j, const Eigen::Matrix3d& block) {
  const auto begin = rows_.begin() + starts_[j], end = rows_.begin() + starts_[j + 1];
  blocks_[std::lower_bound(begin, end, i) - rows_.begin()] += block;
}

Eigen::Matrix3Xd BlockMatrix::Multiply(const Eigen::Matrix3Xd& x) const {
  Eigen::Matrix3Xd y = Eigen::Matrix3Xd::Zero(3, nodes());
  for (int j = 0; j < nodes(); ++j) {
    for (int k = starts_[j]; k < starts_[j + 1]; ++k) {
      const int i = rows_[k];
      y.col(i) += blocks_[k] * x.col(j);
      if (i != j) y.col(j) += blocks_[k].transpose() * x.col(i);
    }
  }
  return y;
}

}  // namespace mortise::simulator
