// Every evaluation that has been committed, in order, with the running non-dominated set.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace mortise::pareto {

struct ArchiveEntry {
  Eigen::VectorXd u;  // D, unit coordinates
  bool feasible = false;
  Eigen::VectorXd metrics;   // d, raw units; empty when infeasible
  Eigen::MatrixXd jacobian;  // d x D, dF/du; empty when none; a row of NaN: none for that metric
  Eigen::MatrixXd jacobian_estimate;  // d x D, the last model's here; empty when none was made
};

// Affine map of performance space that makes metrics comparable (§7.6 rescales to [0, 1]^d): the
// running ideal point goes to the origin, the nadir point of the non-dominated set to (1, ..., 1).
struct Scaling {
  Eigen::VectorXd ideal;  // d, raw units
  Eigen::VectorXd
      range;  // d, raw units, > 0: nadir - ideal, or a part of what was seen where that vanishes

  Eigen::VectorXd Apply(const Eigen::VectorXd& metrics) const {
    return (metrics - ideal).cwiseQuotient(range);
  }
};

class Archive {
 public:
  // Appends and returns the entry's index, which never changes.
  std::size_t Add(ArchiveEntry entry);

  const ArchiveEntry& operator[](std::size_t index) const { return entries_[index]; }
  std::size_t size() const { return entries_.size(); }
  std::size_t feasible_count() const { return feasible_count_; }

  // Indices of the feasible entries that no entry dominates, in order of arrival.
  const std::vector<std::size_t>& non_dominated() const { return non_dominated_; }

  // From the present ideal (over all feasible entries) and nadir (over the non-dominated ones).
  // Needs one feasible entry.
  Scaling CurrentScaling() const;

  // From the ideal to the worst of all feasible entries, d; 0 where nothing differs.
  Eigen::VectorXd WholeRange() const { return worst_ - ideal_; }

  // Up to `count` feasible entries nearest to `u` (Euclidean in unit coordinates), nearest first.
  std::vector<std::size_t> Nearest(const Eigen::VectorXd& u, std::size_t count) const;

  // Keeps the Jacobian that a model found at an entry, as prior for models nearby.
  void Remember(std::size_t entry, Eigen::MatrixXd jacobian);

  // The Jacobian kept nearest to `u`; empty when none is kept.
  Eigen::MatrixXd PriorJacobian(const Eigen::VectorXd& u) const;

  // Whether some entry is better by `margin` (in scaled metrics) in every metric, or as good in
  // every one and better by three times that in one: the tolerant form of dominance that decides
  // where a patch ends.
  bool ClearlyDominated(const Eigen::VectorXd& metrics, const Scaling& scaling,
                        double margin) const;

 private:
  std::vector<ArchiveEntry> entries_;
  std::size_t feasible_count_ = 0;
  std::vector<std::size_t> non_dominated_;
  std::vector<std::size_t> remembered_;  // entries with a jacobian_estimate
  Eigen::VectorXd ideal_;
  Eigen::VectorXd worst_;  // over all feasible entries
};

}  // namespace mortise::pareto
