// A manifold given by functions, over a box that further constraints may cut.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "services/retrieval/cover/manifold.h"

namespace mortise::retrieval {

// What a FunctionManifold is made of. Functions are called on several threads at once.
struct ManifoldFunctions {
  Eigen::VectorXd lower, upper;  // K: the box
  // Which parameters are whole numbers: samples have whole ones, and the functions are given none
  // between them, so that nothing changes along them but from one structure to another. None if
  // empty.
  std::vector<bool> whole = {};
  // Cut the box, besides; none by default. They must leave something of it.
  LinearConstraints cuts = {};
  Eigen::Index dimension = 0;  // N
  std::function<absl::StatusOr<Eigen::VectorXd>(const Eigen::VectorXd&)> evaluate;
  std::function<int(const Eigen::VectorXd&)> structure = nullptr;  // 0 everywhere without
  std::function<absl::StatusOr<Derivatives>(const Eigen::VectorXd&)> derivatives = nullptr;
  double noise = 1e-12;
};

// See manifold.h. Sample fails (FAILED_PRECONDITION, POLYHEDRON_EMPTY) where the cuts leave
// nothing.
class FunctionManifold : public Manifold {
 public:
  explicit FunctionManifold(ManifoldFunctions functions);

  Eigen::Index parameters() const override { return functions_.lower.size(); }
  Eigen::Index dimension() const override { return functions_.dimension; }
  const LinearConstraints& constraints() const override { return constraints_; }
  absl::StatusOr<std::vector<Eigen::VectorXd>> Sample(int count, std::uint64_t seed) const override;
  absl::StatusOr<Eigen::VectorXd> Evaluate(const Eigen::VectorXd& q) const override;
  int Structure(const Eigen::VectorXd& q) const override;
  double noise() const override { return functions_.noise; }
  bool OffersDerivatives() const override { return functions_.derivatives != nullptr; }
  absl::StatusOr<Derivatives> DerivativesAt(const Eigen::VectorXd& q) const override;

 private:
  Eigen::VectorXd Rounded(Eigen::VectorXd q) const;

  ManifoldFunctions functions_;
  LinearConstraints constraints_;
};

}  // namespace mortise::retrieval
