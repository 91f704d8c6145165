// Says which nodes of a mesh are coupled, and where each element's share of a matrix goes.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::simulator {

// The pattern of symmetric matrices in which the nodes of a common element are coupled. It depends
// on the elements only, not on positions: a sweep of parameters over one topology shares it.
// Only blocks on and above the diagonal have a slot: column j holds rows i <= j, ascending, the
// last of them j itself.
class BlockPattern {
 public:
  // `elements` has the nodes of each element, by columns, all within 0 … nodes − 1.
  BlockPattern(int nodes, const Eigen::MatrixXi& elements);

  int nodes() const { return static_cast<int>(starts_.size()) - 1; }
  int elements() const { return elements_; }
  int corners() const { return corners_; }  // of an element

  const std::vector<int>& starts() const { return starts_; }  // nodes + 1, of each column's slots
  const std::vector<int>& rows() const { return rows_; }      // node of each slot's rows

  // Returns the slots strictly above the diagonal once more, by rows: row i holds columns j > i,
  // ascending.
  const std::vector<int>& row_starts() const { return row_starts_; }    // nodes + 1
  const std::vector<int>& row_columns() const { return row_columns_; }  // node of the columns
  const std::vector<int>& row_slots() const { return row_slots_; }

  // Returns the slot of the block that couples nodes i <= j, or -1 if nothing does.
  int Find(int i, int j) const;

  // The blocks of an element's matrix are its pairs of corners (a, b), a <= b, in the order
  // (0,0), (0,1), …, (1,1), (1,2), …. Their number:
  int pairs() const { return corners_ * (corners_ + 1) / 2; }

  // Returns 2 × slot for each pair of element `e`, plus 1 if the block is to be transposed.
  const int* ElementSlots(int e) const { return &element_slots_[std::size_t(pairs()) * e]; }

 private:
  void FindRows(const Eigen::MatrixXi& elements);
  void IndexByRows();

  int corners_ = 0, elements_ = 0;
  std::vector<int> starts_, rows_;
  std::vector<int> row_starts_, row_columns_, row_slots_;
  std::vector<int> element_slots_;
};

}  // namespace mortise::simulator
