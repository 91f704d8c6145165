// A growing set of primitives that is asked whether it covers a point.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "services/retrieval/cover/primitive.h"

namespace mortise::retrieval {

// Skips primitives by their centres' distances from the first few centres (pivots): by the triangle
// inequality a primitive can only be within δ of x if these differ from x's by no more than δ and
// its largest radius. Exact.
class CoverSet {
 public:
  void Add(Primitive primitive);

  // Whether a primitive of this structure, of those from number `from` on, is within `delta` of x.
  bool Covers(const Eigen::VectorXd& x, int structure, double delta, std::size_t from = 0) const;

  const std::vector<Primitive>& primitives() const { return primitives_; }
  std::size_t size() const { return primitives_.size(); }
  long cost() const { return cost_; }

 private:
  static constexpr std::size_t kPivots = 8;
  using Keys = std::array<double, kPivots>;

  Keys KeysOf(const Eigen::VectorXd& x) const;

  std::vector<Primitive> primitives_;
  std::vector<Keys> keys_;       // of each primitive's centre; 0 where there was no pivot yet
  std::vector<double> reaches_;  // the largest radius of each
  long cost_ = 0;
};

}  // namespace mortise::retrieval
