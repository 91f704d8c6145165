#include "common/assembly/polyhedra/linear_form.h"

#include <cmath>

namespace mortise::parametric {
namespace {

constexpr double kCancelled = 1e-14;  // of the larger coefficient: what is left of equal ones

void Append(LinearForm& form, int variable, double coefficient, double scale) {
  if (std::abs(coefficient) > kCancelled * scale) form.terms.push_back({variable, coefficient});
}

}  // namespace

LinearForm LinearForm::Variable(int variable, double coefficient) {
  return {.terms = {{variable, coefficient}}, .constant = 0};
}

double LinearForm::At(const Eigen::VectorXd& q) const {
  double value = constant;
  for (const LinearTerm& term : terms) value += term.coefficient * q[term.variable];
  return value;
}

LinearForm Combine(double scale_a, const LinearForm& a, double scale_b, const LinearForm& b) {
  LinearForm sum;
  sum.constant = scale_a * a.constant + scale_b * b.constant;
  auto i = a.terms.begin();
  auto j = b.terms.begin();
  while (i != a.terms.end() || j != b.terms.end()) {
    if (j == b.terms.end() || (i != a.terms.end() && i->variable < j->variable)) {
      Append(sum, i->variable, scale_a * i->coefficient, std::abs(i->coefficient));
      ++i;
    } else if (i == a.terms.end() || j->variable < i->variable) {
      Append(sum, j->variable, scale_b * j->coefficient, std::abs(j->coefficient));
      ++j;
    } else {
      const double from_a = scale_a * i->coefficient;
      const double from_b = scale_b * j->coefficient;
      Append(sum, i->variable, from_a + from_b, std::abs(from_a) + std::abs(from_b));
      ++i;
      ++j;
    }
  }
  return sum;
}

}  // namespace mortise::parametric
