// Finds the families whose covers come nearest to a descriptor, exactly and without looking at all
// primitives (thesis §4.5, and what §4.7.3 leaves to others).
//
// Our own structure, a metric tree: primitives lie in leaves; each node knows a ball and a box
// around all that is below it, in the space of the leading principal components of the centres and
// the length of what these leave. Distances there are never longer than between descriptors, so
// they bound from below what a node holds, at a fraction of the cost. Nodes are looked at in the
// order of their bounds until none can hold anything nearer. Tangents are bounded with their whole
// ellipsoid.
//
// Families that are nearly the same, as variants of one template, have nearly the same primitives.
// These lie in a leaf together, as a group: the distance from the box around the first one's
// ellipsoid is convex in where the box is, so that it and its slope, computed once, bound those
// from all others from below by a product of a few numbers each.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "services/retrieval/cover/primitive.h"
#include "services/retrieval/index/index_arrays.h"

namespace mortise::retrieval {

// The cover of a family, by a number of the caller's, >= 0.
struct FamilyCover {
  int family = 0;
  std::vector<Primitive> primitives;
};

// What is looked for.
struct IndexQuery {
  // One to four descriptors (N) of the same shape, as for upright turns: the best counts.
  std::vector<Eigen::VectorXd> descriptors;
  int count = 1;  // how many families, >= 1
  // Which families are allowed; asked at most once for each. All without.
  std::function<bool(int family)> allowed = nullptr;
};

// A family and its nearest primitive.
struct IndexMatch {
  int family = 0;
  int primitive = 0;  // its place in the family's cover
  int turn = 0;       // which descriptor of the query it is nearest to
  double distance = 0;
  int entry = 0;  // its place in the index, for PrimitiveOf
};

// What a search took.
struct IndexEffort {
  long nodes = 0;      // whose bounds were computed
  long distances = 0;  // from primitives
};

// Immutable, and safe to ask from several threads. Copies share their arrays.
class PrimitiveIndex {
 public:
  // Of covers in any order, with at least one primitive between them. Centres and axes are kept as
  // floats (seven digits). The same covers give the same arrays, whatever their order.
  // INVALID_ARGUMENT: a family is there twice or has a negative number; dimensions differ or are 0;
  // a radius is not positive; numbers are not finite. O(P N (d + log P)) for P primitives.
  static absl::StatusOr<PrimitiveIndex> Build(std::vector<FamilyCover> covers);

  // Over arrays that `owner` keeps (index_file.h).
  PrimitiveIndex(IndexArrays arrays, std::shared_ptr<const void> owner);

  // Returns the nearest families, nearest first; of equal distances the smaller family number
  // first, and within a family the primitive with the smaller number, then the smaller turn. Fewer
  // than `count` if fewer are allowed. Equal to LinearScan, to the bit. INVALID_ARGUMENT: count <
  // 1, no or more than four descriptors, of wrong size or not finite.
  absl::StatusOr<std::vector<IndexMatch>> Nearest(const IndexQuery& query,
                                                  IndexEffort* effort = nullptr) const;

  // The same by looking at every primitive: for tests and benches.
  absl::StatusOr<std::vector<IndexMatch>> LinearScan(const IndexQuery& query) const;

  // Returns the primitive of a match of this index: what was given to Build, but for rounding of
  // centre and axes to floats. O(N m).
  Primitive PrimitiveOf(const IndexMatch& match) const;

  Eigen::Index dimension() const { return arrays_.sizes.dimension; }
  int families() const { return static_cast<int>(arrays_.sizes.families); }
  std::int64_t primitives() const { return arrays_.sizes.primitives; }
  const IndexArrays& arrays() const { return arrays_; }

 private:
  absl::Status Check(const IndexQuery& query) const;

  IndexArrays arrays_;
  std::shared_ptr<const void> owner_;
};

}  // namespace mortise::retrieval
