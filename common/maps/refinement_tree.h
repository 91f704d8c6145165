// A K-d tree over the unit box [0,1]^K with the basis functions of its samples: the interpolation
// algorithm of thesis 6.4, 6.5 and appendix A, in any dimension.
//
// Elements are split halfway along one direction. Samples lie at the corners of every common cuboid
// of elements. The basis function ψ_k of sample k is a sum of B-splines, ψ_k = Σ α_k^{i,j} φ_i^j
// (6.6), and P(x) = Σ_k p_k ψ_k(x) (6.1).
//
// What holds for Basis::kLinear, whatever the splits (executable as CheckInvariants):
//  - partition of unity: Σ_k ψ_k(x) = 1;
//  - linear precision: a linear function is reproduced exactly;
//  - locality: ψ_k vanishes on all elements that do not touch sample k;
//  - value at samples: P(x_k) = p_k;
//  - continuity everywhere, across T-junctions, too.
// Basis::kCubic has the same elements, samples and refinement. Its coefficients come from local
// models (coefficients.h), and InterpolationMap evaluates it. What holds, whatever the splits:
//  - partition of unity and linear precision, to rounding;
//  - it is twice continuously differentiable in the whole box;
//  - a sample acts only on elements that are at most four steps from one neighbour to the next
//  away from
//    one that it touches.
// It does not take its samples' values exactly: its error there is of the order of its error
// elsewhere.
//
// Two things differ from Algorithm 1 as printed. A B-spline takes its value from the corners of the
// common cuboid R around its local point y in the present tree, not only when it violates locality.
// The proofs of appendix A hold as before, and what is interpolated depends on the elements alone,
// not on the order in which they were split. And disparity is bounded: the number of active
// B-splines over an element grows as 2^((K-1)Δ) where Δ is the difference of its numbers of splits
// between directions.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "common/maps/basis.h"
#include "common/maps/element_tree.h"
#include "common/maps/lattice.h"
#include "common/maps/spline_set.h"

namespace mortise::maps {

struct RefinementOptions {
  // The most that an element's numbers of splits along two directions may differ. 0: as
  // DefaultDisparity says. Split splits along other directions first where it would be exceeded.
  int most_disparity = 0;
  // The most splits along a direction that lead to an element, 1 to 22.
  int most_depth = 20;

  bool operator==(const RefinementOptions&) const = default;
};

// The bound on disparity that keeps an element below some 8,000 linear B-splines: 20, 11, 5, 3, 2
// for K = 1 … 5, then 2 for K = 6, and 1.
int DefaultDisparity(int dimension);

// One split. Elements are numbered in the order in which they arise: 0 is the box, and the split
// that was the n-th makes elements 2n-1 and 2n, the lower one first.
struct ElementSplit {
  int element = 0;
  int direction = 0;

  bool operator==(const ElementSplit&) const = default;
};

struct SampleWeight {
  int sample = 0;
  double weight = 0;
};

// ψ_k(x) of all samples that act at a point x, ascending by sample, and their derivatives (6.13).
struct PointWeights {
  std::vector<int> samples;
  Eigen::VectorXd weights;    // one for each of `samples`
  Eigen::MatrixXd gradients;  // K × samples, by the coordinates of the unit box
};

struct ElementBox {
  Eigen::VectorXd low;
  Eigen::VectorXd high;
};

class RefinementTree {
 public:
  // A tree of one element, its 2^K corners are samples 0 … 2^K - 1. INVALID_ARGUMENT, field
  // `dimension`, `basis` or `options.…`: dimensions are 1 to 10 (cubic: 1 to 5).
  static absl::StatusOr<RefinementTree> Create(int dimension, Basis basis,
                                               const RefinementOptions& options = {});

  // The tree that `history` of another of the same dimension, basis and options tells, bit for bit.
  // INVALID_ARGUMENT, field `splits[n].…`: not a split of an element of that moment.
  static absl::StatusOr<RefinementTree> Replay(int dimension, Basis basis,
                                               const RefinementOptions& options,
                                               std::span<const ElementSplit> history);

  int dimension() const { return elements_.dimension(); }
  Basis basis() const { return basis_; }
  const RefinementOptions& options() const { return options_; }
  // All splits in their order, those that the bound on disparity asked for included.
  const std::vector<ElementSplit>& history() const { return history_; }

  // The numbers of all elements, ascending. An element that is split is one no longer.
  std::vector<int> Elements() const;
  int element_count() const { return elements_.element_count(); }
  bool IsElement(int element) const;
  ElementBox BoxOf(int element) const;
  const LatticeBox& LatticeBoxOf(int element) const { return elements_.BoxOf(element); }
  // The number of splits along the direction that led to the element: its edge is 2^-depth.
  int DepthOf(int element, int direction) const { return elements_.DepthOf(element, direction); }
  // The elements that touch the element, without itself.
  std::vector<int> Neighbours(int element) const;

  int sample_count() const { return elements_.sample_count(); }
  Eigen::VectorXd SamplePosition(int sample) const;
  const LatticePoint& SampleLattice(int sample) const { return elements_.SampleAt(sample); }
  // B(e): the samples on the element, ascending.
  const std::vector<int>& ElementSamples(int element) const { return elements_.SamplesOf(element); }
  // N(x_k): the elements that touch the sample.
  std::vector<int> SampleElements(int sample) const;
  // The element that a point of the unit box lies in. Of two that share it, the upper one.
  int Locate(const Eigen::Ref<const Eigen::VectorXd>& point) const;

  // Whether Split may be called, as to the depth.
  bool CanSplit(int element, int direction) const;
  // The direction that a split along `direction` has to be preceded by, because of the bound on
  // disparity; `direction` itself if there is none.
  int DirectionBefore(int element, int direction) const;
  // The positions of samples that a split along `direction` alone would add.
  std::vector<LatticePoint> NewSamples(int element, int direction) const;

  // Splits the element halfway along `direction`: Algorithm 1. Where the bound on disparity asks
  // for it, the element is first split along others, and then all its parts along `direction`.
  // Returns the numbers of the new samples. INVALID_ARGUMENT, field `element` or `direction`.
  absl::StatusOr<std::vector<int>> Split(int element, int direction);

  // ψ_k(x) for a point of the unit box (coordinates outside of it are taken to its faces). Of the
  // linear basis; nothing for the cubic one.
  PointWeights Weights(const Eigen::Ref<const Eigen::VectorXd>& point) const;

  // The active B-splines and the samples that each takes its value from: its coefficient is
  // q = Σ weight · p_sample (A.11). For who packs a map.
  const SplineSet& splines() const { return splines_; }
  std::vector<SampleWeight> Allocation(const BSpline& spline) const;
  // The finest level of which a B-spline may be active over the element.
  int FinestLevel(int element) const { return finest_[element]; }
  // The coarsest such level.
  int CoarsestLevel(int element) const { return elements_.MostDepthOf(element); }
  const ElementTree& elements() const { return elements_; }

 private:
  RefinementTree(int dimension, Basis basis, const RefinementOptions& options);
  void SplitOnce(int element, int direction, std::vector<int>& added);

  Basis basis_;
  RefinementOptions options_;
  ElementTree elements_;
  SplineSet splines_;
  std::vector<int> finest_;  // for each node
  std::vector<ElementSplit> history_;
};

// Checks unity, linear precision, locality and value at samples of a linear tree to
// `tolerance`, at every sample and at `points` seeded points of each element, and exactly, for
// every B-spline, Remarks 1, 2, 6 and 7 of appendix A and that its local point is one. Of a cubic
// tree: the Remarks alone. INTERNAL: says what is broken and where.
absl::Status CheckInvariants(const RefinementTree& tree, int points = 2, double tolerance = 1e-12);

}  // namespace mortise::maps
