// Affine functions of the parameters q with few terms. Planes, centres and relationships of a
// linear template are written in them (thesis §3.5.1).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace mortise::parametric {

struct LinearTerm {
  int variable = 0;  // index into q
  double coefficient = 0;
};

// The sum of coefficient · q[variable], plus a constant. Terms are ordered by variable, none is
// zero.
struct LinearForm {
  std::vector<LinearTerm> terms;
  double constant = 0;

  static LinearForm Variable(int variable, double coefficient = 1);
  double At(const Eigen::VectorXd& q) const;
};

// Returns scale_a · a + scale_b · b.
LinearForm Combine(double scale_a, const LinearForm& a, double scale_b, const LinearForm& b);

inline LinearForm operator+(const LinearForm& a, const LinearForm& b) {
  return Combine(1, a, 1, b);
}
inline LinearForm operator-(const LinearForm& a, const LinearForm& b) {
  return Combine(1, a, -1, b);
}
inline LinearForm operator*(double scale, const LinearForm& a) { return Combine(scale, a, 0, {}); }

}  // namespace mortise::parametric
