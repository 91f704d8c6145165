// Keeps every evaluation that has been committed, in order, with the running non-dominated set.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <utility>
#include <vector>

#include "services/pareto/archive/nearest_designs.h"

namespace mortise::pareto {

struct ArchiveEntry {
  Eigen::VectorXd u;         // D, unit coordinates
  bool evaluated = false;    // metrics and constraints are known
  Eigen::VectorXd metrics;   // d, raw units; empty when not evaluated
  Eigen::MatrixXd jacobian;  // d x D, dF/du; empty when none; a row of NaN: none for that metric
  Eigen::MatrixXd jacobian_estimate;  // d x D, the last model's here; empty when none was made
  Eigen::VectorXd constraints = {};   // m, raw units, met where <= 0
  Eigen::MatrixXd constraint_jacobian = {};           // m x D, as `jacobian`
  Eigen::MatrixXd constraint_jacobian_estimate = {};  // m x D, as `jacobian_estimate`
  bool feasible = false;  // evaluated, and all constraints met; by the archive
};

// An affine map of performance space that makes metrics comparable (§7.6 rescales to [0, 1]^d): the
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
  std::size_t evaluated_count() const { return evaluated_count_; }
  std::size_t feasible_count() const { return feasible_count_; }

  // Returns the indices of the feasible entries that no entry dominates, in order of arrival.
  const std::vector<std::size_t>& non_dominated() const { return non_dominated_; }

  // Returns the metrics of non_dominated(), d x n, raw units, a column each in the same order. They
  // are valid until the next Add.
  Eigen::Map<const Eigen::MatrixXd> non_dominated_metrics() const {
    return Eigen::Map<const Eigen::MatrixXd>(front_.data(), ideal_.size(),
                                             static_cast<Eigen::Index>(non_dominated_.size()));
  }

  // Returns the entries that were not dominated before the last Add, and are since.
  const std::vector<std::size_t>& displaced() const { return displaced_; }

  // Returns the scaling by the present ideal (over all feasible entries) and nadir (over the
  // non-dominated ones). While none is feasible, it is by a tenth of the range of the evaluated
  // ones, of which there must be one.
  Scaling CurrentScaling() const;

  // Returns the largest size of each constraint seen, m; 1 where all were 0.
  Eigen::VectorXd ConstraintSizes() const;

  // Returns how far an evaluated entry is from meeting all constraints, each in units of its size:
  // 0 if it meets them.
  double Violation(std::size_t entry) const;

  // Returns the range from the ideal to the worst of all feasible entries, d; 0 where nothing
  // differs.
  Eigen::VectorXd WholeRange() const { return worst_ - ideal_; }

  // Returns how far designs may differ in each parameter (D) and still tell of each other, relative
  // to the others: 1 until UseLengths says otherwise. Nearest and local models measure in these
  // lengths; prior Jacobians come from what is nearest in unit coordinates.
  const Eigen::VectorXd& lengths() const { return lengths_; }
  void UseLengths(Eigen::VectorXd lengths) { lengths_ = std::move(lengths); }

  // Returns up to `count` evaluated entries nearest to `u`, nearest first.
  std::vector<std::size_t> Nearest(const Eigen::VectorXd& u, std::size_t count) const;

  // Keeps the Jacobian that a model of metrics, or of constraints, found at an entry, as prior for
  // models nearby.
  void Remember(std::size_t entry, Eigen::MatrixXd jacobian);
  void RememberConstraints(std::size_t entry, Eigen::MatrixXd jacobian);

  // Returns the Jacobian kept nearest to `u`; empty when none is kept.
  Eigen::MatrixXd PriorJacobian(const Eigen::VectorXd& u) const;
  Eigen::MatrixXd PriorConstraintJacobian(const Eigen::VectorXd& u) const;

  // Whether some entry is better by `margin` (in scaled metrics) in every metric, or as good in
  // every one and better by three times that in one: the tolerant form of dominance that decides
  // where a patch ends.
  bool ClearlyDominated(const Eigen::VectorXd& metrics, const Scaling& scaling,
                        double margin) const;

 private:
  std::vector<ArchiveEntry> entries_;
  std::size_t evaluated_count_ = 0;
  std::size_t feasible_count_ = 0;
  // Scans over all entries, or all that are not dominated, read what they compare from one piece of
  // memory: from each entry's own it takes several times as long.
  std::vector<double> designs_;  // u of each entry, one after the other
  Eigen::VectorXd lengths_;      // D, once there is an entry
  std::vector<std::size_t> non_dominated_;
  std::vector<double> front_;  // metrics of those, one after the other
  std::vector<std::size_t> displaced_;
  using Estimate = Eigen::MatrixXd ArchiveEntry::*;
  void AddToFront(std::size_t entry);
  void Keep(std::size_t entry, Estimate estimate, Eigen::MatrixXd jacobian, NearestDesigns& kept);
  Eigen::MatrixXd NearestOf(const NearestDesigns& kept, Estimate estimate,
                            const Eigen::VectorXd& u) const;
  NearestDesigns::Designs Designs() const;

  NearestDesigns evaluated_;
  NearestDesigns remembered_;              // entries with a jacobian_estimate
  NearestDesigns remembered_constraints_;  // with a constraint_jacobian_estimate
  Eigen::VectorXd ideal_;
  Eigen::VectorXd worst_;  // over all feasible entries, or evaluated ones while there are none
  Eigen::VectorXd constraint_sizes_;  // largest seen
};

// Whether the evaluator offered the gradient of every row, of metrics or of constraints.
bool OffersEvery(const Eigen::MatrixXd& jacobian);

// Returns the scaled metrics of the entries that none dominates, d x n, in their order.
Eigen::MatrixXd ScaledFront(const Archive& archive, const Scaling& scaling);

}  // namespace mortise::pareto
