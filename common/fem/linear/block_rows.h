// Sparse matrices of small dense blocks by rows, as multigrid's levels need them.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/fem/linear/block_pattern.h"
#include "common/fem/linear/thread_team.h"

namespace mortise::simulator {

// Rows of R × C blocks. Unlike BlockMatrix both triangles are kept, so that rows can be computed
// independently of each other.
template <class T, int R, int C>
struct BlockRows {
  using Block = Eigen::Matrix<T, R, C>;
  std::vector<int> starts{0};  // rows + 1
  std::vector<int> columns;    // of each block; ascending within a row
  std::vector<Block> blocks;

  int rows() const { return static_cast<int>(starts.size()) - 1; }
  double Bytes() const {
    return sizeof(int) * double(starts.size() + columns.size()) +
           sizeof(Block) * double(blocks.size());
  }
};

// Computes y = A x on blocks of rows begin … end − 1.
template <class T, int R, int C>
void MultiplyRows(const BlockRows<T, R, C>& a, const double* x, double* y, int begin, int end) {
  for (int i = begin; i < end; ++i) {
    Eigen::Matrix<double, R, 1> sum = Eigen::Matrix<double, R, 1>::Zero();
    for (int k = a.starts[i]; k < a.starts[i + 1]; ++k) {
      sum.noalias() += a.blocks[k] * Eigen::Map<const Eigen::Matrix<double, C, 1>>(
                                         x + std::size_t(C) * a.columns[k]);
    }
    Eigen::Map<Eigen::Matrix<double, R, 1>>(y + std::size_t(R) * i) = sum;
  }
}

// Does the same for the levels with 3 × 3 blocks, which take most of the time.
void MultiplyRows(const BlockRows<float, 3, 3>& a, const double* x, double* y, int begin, int end);
void MultiplyRows(const BlockRows<double, 3, 3>& a, const double* x, double* y, int begin, int end);

// Does the same for a symmetric matrix of 3 × 3 blocks of which those on and above the diagonal are
// kept, one for each slot of the pattern.
void MultiplySymmetric(const BlockPattern& pattern, const double* blocks, const double* x,
                       double* y, int begin, int end);

// Joins the rows of all parts, one after the other, and takes the parts.
template <class T, int R, int C>
BlockRows<T, R, C> Joined(std::vector<BlockRows<T, R, C>>& parts) {
  BlockRows<T, R, C> result;
  std::size_t blocks = 0;
  for (const auto& part : parts) blocks += part.blocks.size();
  result.columns.reserve(blocks);
  result.blocks.reserve(blocks);
  for (auto& part : parts) {
    const int before = static_cast<int>(result.columns.size());
    for (int i = 1; i <= part.rows(); ++i) result.starts.push_back(before + part.starts[i]);
    result.columns.insert(result.columns.end(), part.columns.begin(), part.columns.end());
    result.blocks.insert(result.blocks.end(), part.blocks.begin(), part.blocks.end());
    part = {};
  }
  return result;
}

// Returns the product A B, of which B has `columns` columns of blocks.
template <int R, int K, int C>
BlockRows<double, R, C> Product(const BlockRows<double, R, K>& a, const BlockRows<double, K, C>& b,
                                int columns, ThreadTeam& team) {
  using Result = BlockRows<double, R, C>;
  constexpr int kRange = 512;
  const int ranges = (a.rows() + kRange - 1) / kRange;
  std::vector<Result> parts(ranges);
  team.Run(ranges, [&](int range) {
    Result& part = parts[range];
    std::vector<int> place(columns, -1), found;
    std::vector<typename Result::Block> sums;
    for (int i = range * kRange; i < std::min(a.rows(), (range + 1) * kRange); ++i) {
      found.clear();
      sums.clear();
      for (int k = a.starts[i]; k < a.starts[i + 1]; ++k) {
        const int middle = a.columns[k];
        for (int l = b.starts[middle]; l < b.starts[middle + 1]; ++l) {
          int& at = place[b.columns[l]];
          if (at < 0) {
            at = static_cast<int>(found.size());
            found.push_back(b.columns[l]);
            sums.push_back(Result::Block::Zero());
          }
          sums[at].noalias() += a.blocks[k].lazyProduct(b.blocks[l]);
        }
      }
      std::sort(found.begin(), found.end());
      for (const int j : found) {
        part.columns.push_back(j);
        part.blocks.push_back(sums[place[j]]);
        place[j] = -1;
      }
      part.starts.push_back(static_cast<int>(part.columns.size()));
    }
  });
  return Joined(parts);
}

// Returns the transpose of A, which has `columns` columns of blocks.
template <int R, int C>
BlockRows<double, C, R> Transpose(const BlockRows<double, R, C>& a, int columns) {
  BlockRows<double, C, R> result;
  result.starts.assign(columns + 1, 0);
  for (const int j : a.columns) ++result.starts[j + 1];
  for (int j = 0; j < columns; ++j) result.starts[j + 1] += result.starts[j];
  result.columns.resize(a.columns.size());
  result.blocks.resize(a.columns.size());
  std::vector<int> next(result.starts.begin(), result.starts.end() - 1);
  for (int i = 0; i < a.rows(); ++i) {
    for (int k = a.starts[i]; k < a.starts[i + 1]; ++k) {
      const int place = next[a.columns[k]]++;
      result.columns[place] = i;
      result.blocks[place] = a.blocks[k].transpose();
    }
  }
  return result;
}

}  // namespace mortise::simulator
