#include "common/fem/linear/block_pattern.h"

#include <algorithm>

namespace mortise::simulator {

BlockPattern::BlockPattern(int nodes, const Eigen::MatrixXi& elements)
    : corners_(static_cast<int>(elements.rows())), elements_(static_cast<int>(elements.cols())) {
  starts_.assign(nodes + 1, 0);
  element_slots_.assign(std::size_t(pairs()) * elements_, 0);
  FindRows(elements);
  IndexByRows();
}

void BlockPattern::FindRows(const Eigen::MatrixXi& elements) {
  const int nodes = this->nodes();
  // Elements round each node, as a compressed list, each with the corner that the node is.
  std::vector<int> first(nodes + 1, 0);
  for (Eigen::Index k = 0; k < elements.size(); ++k) ++first[elements.data()[k] + 1];
  for (int v = 0; v < nodes; ++v) first[v + 1] += first[v];
  std::vector<Eigen::Vector2i> around(elements.size());
  std::vector<int> next(first.begin(), first.end() - 1);
  for (int e = 0; e < elements_; ++e) {
    for (int b = 0; b < corners_; ++b) around[next[elements(b, e)]++] = {e, b};
  }
  Eigen::MatrixXi pair(corners_, corners_);
  for (int a = 0, k = 0; a < corners_; ++a) {
    for (int b = a; b < corners_; ++b) pair(a, b) = pair(b, a) = k++;
  }
  std::vector<int> seen(nodes, -1), slot(nodes);
  for (int j = 0; j < nodes; ++j) {
    const std::size_t begin = rows_.size();
    // The diagonal is there even of a node without elements.
    seen[j] = j;
    rows_.push_back(j);
    for (int k = first[j]; k < first[j + 1]; ++k) {
      for (int a = 0; a < corners_; ++a) {
        const int i = elements(a, around[k][0]);
        if (i > j || seen[i] == j) continue;
        seen[i] = j;
        rows_.push_back(i);
      }
    }
    std::sort(rows_.begin() + begin, rows_.end());
    for (std::size_t k = begin; k < rows_.size(); ++k) slot[rows_[k]] = static_cast<int>(k);
    starts_[j + 1] = static_cast<int>(rows_.size());
    for (int k = first[j]; k < first[j + 1]; ++k) {
      const int e = around[k][0], b = around[k][1];
      for (int a = 0; a < corners_; ++a) {
        const int i = elements(a, e);
        if (i > j) continue;
        element_slots_[std::size_t(pairs()) * e + pair(a, b)] = 2 * slot[i] + (a > b);
      }
    }
  }
}

void BlockPattern::IndexByRows() {
  row_starts_.assign(nodes() + 1, 0);
  for (int j = 0; j < nodes(); ++j) {
    for (int k = starts_[j]; k < starts_[j + 1]; ++k) row_starts_[rows_[k] + 1] += rows_[k] < j;
  }
  for (int i = 0; i < nodes(); ++i) row_starts_[i + 1] += row_starts_[i];
  row_columns_.resize(row_starts_.back());
  row_slots_.resize(row_starts_.back());
  std::vector<int> next(row_starts_.begin(), row_starts_.end() - 1);
  for (int j = 0; j < nodes(); ++j) {
    for (int k = starts_[j]; k < starts_[j + 1]; ++k) {
      if (rows_[k] == j) continue;
      const int place = next[rows_[k]]++;
      row_columns_[place] = j;
      row_slots_[place] = k;
    }
  }
}

int BlockPattern::Find(int i, int j) const {
  const auto begin = rows_.begin() + starts_[j], end = rows_.begin() + starts_[j + 1];
  const auto found = std::lower_bound(begin, end, i);
  return found != end && *found == i ? static_cast<int>(found - rows_.begin()) : -1;
}

}  // namespace mortise::simulator
