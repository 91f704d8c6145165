// One level of a multigrid preconditioner: a smoother, and the correction from the next coarser
// one.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "common/fem/linear/block_rows.h"
#include "common/fem/linear/thread_team.h"

namespace mortise::simulator {

// Computes x ≈ A⁻¹ b by a fixed linear, symmetric and positive operation.
class Corrector {
 public:
  virtual ~Corrector() = default;
  virtual void Correct(const Eigen::VectorXd& b, Eigen::VectorXd& x) = 0;
  virtual double Bytes() const = 0;  // of it and all coarser levels
  virtual int Levels() const = 0;
};

// Moves between a level and the next coarser one: x += P e, and b' = Pᵀ b.
class Transfer {
 public:
  virtual ~Transfer() = default;
  virtual void Prolong(const Eigen::VectorXd& coarse, Eigen::VectorXd& x) const = 0;
  virtual void Restrict(const Eigen::VectorXd& b, Eigen::VectorXd& coarse) const = 0;
  virtual double Bytes() const = 0;
};

// Returns the largest eigenvalue of D⁻¹ A, by Lanczos' method from a fixed start; D has the
// diagonal blocks.
template <class T, int B>
double LargestEigenvalue(const BlockRows<T, B, B>& a,
                         const std::vector<Eigen::Matrix<double, B, B>>& inverse_diagonal,
                         ThreadTeam& team);

// Returns the inverses of the diagonal blocks. Directions without stiffness (of nodes that a coarse
// level does not need) get the inverse zero.
template <class T, int B>
std::vector<Eigen::Matrix<double, B, B>> InvertDiagonal(const BlockRows<T, B, B>& a);

// A V-cycle whose smoother is Chebyshev's polynomial of D⁻¹ A, D the diagonal blocks: as good as
// Gauss-Seidel, symmetric, and its rows may be computed in any order.
template <class T, int B>
class SmoothedLevel : public Corrector {
 public:
  // `steps` are those of the polynomial, before and after the correction. It damps eigenvalues from
  // `smoothed_part` of the largest one up; those below are left to `coarse`. `team` must outlive
  // the level.
  SmoothedLevel(BlockRows<T, B, B> matrix, std::unique_ptr<Transfer> transfer,
                std::unique_ptr<Corrector> coarse, int steps, double smoothed_part,
                ThreadTeam& team);

  void Correct(const Eigen::VectorXd& b, Eigen::VectorXd& x) override;
  double Bytes() const override;
  int Levels() const override { return 1 + coarse_->Levels(); }

 private:
  void Smooth(const Eigen::VectorXd& b, Eigen::VectorXd& x, bool from_zero);

  BlockRows<T, B, B> matrix_;
  std::vector<Eigen::Matrix<double, B, B>> inverse_diagonal_;
  std::unique_ptr<Transfer> transfer_;
  std::unique_ptr<Corrector> coarse_;
  int steps_;
  double smoothed_part_;
  ThreadTeam& team_;
  double largest_;
  Eigen::VectorXd direction_, moved_, residual_, coarse_load_, coarse_correction_;
};

// The coarsest level, solved exactly.
class DenseLevel : public Corrector {
 public:
  // A symmetric matrix of few unknowns.
  explicit DenseLevel(Eigen::MatrixXd matrix);
  bool positive_definite() const { return positive_definite_; }
  void Correct(const Eigen::VectorXd& b, Eigen::VectorXd& x) override;
  double Bytes() const override { return 8.0 * factor_.size(); }
  int Levels() const override { return 1; }

 private:
  Eigen::MatrixXd factor_;  // Cholesky's, in the lower triangle
  bool positive_definite_;
};

}  // namespace mortise::simulator
