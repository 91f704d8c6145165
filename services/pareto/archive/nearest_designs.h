// Finds the designs nearest to one, among very many.
//
// In tens of dimensions trees prune little, but the designs of a search are not spread over all of
// them: they follow the front, of d - 1 dimensions. So they are kept sorted by the parameter in
// which they differ most, and looked at outwards from where the wanted one would stand, until the
// next is further away in that parameter alone than those found are altogether.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "absl/container/btree_set.h"

namespace mortise::pareto {

class NearestDesigns {
 public:
  // All designs by number, of which a set has some. D x n, valid during a call.
  using Designs = Eigen::Map<const Eigen::MatrixXd>;

  // Adds design number `number`, a column of `designs`. O(log n), and now and then O(n D + n log n)
  // to choose another parameter to sort by.
  void Add(std::size_t number, const Designs& designs);

  // Returns the numbers of up to `count` designs nearest to `u`, nearest first, of equally near
  // ones those with lower numbers. Distances are Euclidean, with parameter i in units of 1 /
  // weights[i]. O(n D) at worst, mostly a small part of it.
  std::vector<std::size_t> Nearest(const Eigen::VectorXd& u, const Eigen::VectorXd& weights,
                                   std::size_t count, const Designs& designs) const;

  std::size_t size() const { return order_.size(); }

 private:
  void SortBySpread(const Designs& designs);

  Eigen::Index parameter_ = 0;                             // they are sorted by
  absl::btree_set<std::pair<double, std::size_t>> order_;  // its values, and numbers
};

}  // namespace mortise::pareto
