// The active B-splines of a map: step 2 of Algorithm 1, by the refinement relations (6.5) and
// (6.12). A part of RefinementTree (refinement_tree.h).
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "common/maps/basis.h"
#include "common/maps/lattice.h"

namespace mortise::maps {

// A B-spline that is or was active. Its coefficient sum and its local point are kept as whole
// numbers by Remark 6: both are sums over its refined parents, α = Σ a and y = Σ a c / Σ a.
struct BSpline {
  int level = 0;
  LatticePoint centre{};
  bool active = true;
  std::int64_t weight = 0;                             // α in parts of whole_weight()
  std::array<std::int64_t, kMostDirections> moment{};  // Σ a c in the same parts

  // y: where the B-spline takes its value from.
  RationalPoint LocalPoint() const { return {moment, weight}; }
};

class SplineSet {
 public:
  SplineSet(int dimension, Basis basis);

  int count() const { return static_cast<int>(splines_.size()); }
  int active_count() const { return active_count_; }
  const BSpline& At(int number) const { return splines_[number]; }
  // The `weight` of a B-spline without active ancestors (α = 1).
  std::int64_t whole_weight() const { return whole_weight_; }
  // The number of the B-spline if it is or was active, or -1.
  int Find(int level, const LatticePoint& centre) const;
  // The region where the B-spline is not zero, which may reach out of the box.
  LatticeBox SupportOf(const BSpline& spline) const;

  // Refines every active B-spline of `level` that overlaps the box, in all directions at once.
  // Returns the region in which it activated others of the next level.
  LatticeBox RefineOver(const LatticeBox& box, int level);

 private:
  void Refine(int number);
  void AddTo(int level, const LatticePoint& centre, std::int64_t part, const LatticePoint& parent);

  int dimension_;
  int reach_;  // half of the support in centre distances: 1 linear, 2 cubic
  std::int64_t whole_weight_ = 1;
  int active_count_ = 0;
  std::vector<BSpline> splines_;
  std::unordered_map<LeveledPoint, int, LatticeHash> index_;
};

}  // namespace mortise::maps
