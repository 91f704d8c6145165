#include "common/parametric/polyhedron_factors.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <vector>

namespace mortise::parametric {
namespace {

// Variables that rows connect.
class Connected {
 public:
  explicit Connected(Eigen::Index variables) : parent_(static_cast<std::size_t>(variables)) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  int Find(int variable) {
    while (parent_[static_cast<std::size_t>(variable)] != variable) {
      int& parent = parent_[static_cast<std::size_t>(variable)];
      parent = parent_[static_cast<std::size_t>(parent)];
      variable = parent;
    }
    return variable;
  }

  void Join(int a, int b) { parent_[static_cast<std::size_t>(Find(a))] = Find(b); }

 private:
  std::vector<int> parent_;
};

int FirstVariable(const Eigen::MatrixXd& rows, Eigen::Index row) {
  Eigen::Index first = 0;
  while (rows(row, first) == 0) ++first;
  return static_cast<int>(first);
}

void Connect(const Eigen::MatrixXd& rows, Connected& connected) {
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const int first = FirstVariable(rows, row);
    for (Eigen::Index i = first + 1; i < rows.cols(); ++i) {
      if (rows(row, i) != 0) connected.Join(first, static_cast<int>(i));
    }
  }
}

}  // namespace

std::vector<PolyhedronFactor> FactorsOf(const Polyhedron& polyhedron) {
  const Eigen::Index variables =
      std::max(polyhedron.inequalities.cols(), polyhedron.equalities.cols());
  Connected connected(variables);
  Connect(polyhedron.inequalities, connected);
  Connect(polyhedron.equalities, connected);
  std::vector<PolyhedronFactor> factors;
  std::map<int, std::size_t> place;  // of a set's representative
  for (int variable = 0; variable < variables; ++variable) {
    const auto [found, is_new] = place.emplace(connected.Find(variable), factors.size());
    if (is_new) factors.emplace_back();
    factors[found->second].variables.push_back(variable);
  }
  const auto factor_of = [&](const Eigen::MatrixXd& rows, Eigen::Index row) -> PolyhedronFactor& {
    return factors[place.at(connected.Find(FirstVariable(rows, row)))];
  };
  for (Eigen::Index row = 0; row < polyhedron.inequalities.rows(); ++row) {
    factor_of(polyhedron.inequalities, row).inequalities.push_back(static_cast<int>(row));
  }
  for (Eigen::Index row = 0; row < polyhedron.equalities.rows(); ++row) {
    factor_of(polyhedron.equalities, row).equalities.push_back(static_cast<int>(row));
  }
  return factors;
}

Polyhedron PolyhedronOf(const Polyhedron& whole, const PolyhedronFactor& factor) {
  return {whole.inequalities(factor.inequalities, factor.variables),
          whole.bounds(factor.inequalities), whole.equalities(factor.equalities, factor.variables),
          whole.values(factor.equalities)};
}

Eigen::VectorXd EntriesOf(const Eigen::VectorXd& whole, const PolyhedronFactor& factor) {
  return whole(factor.variables);
}

void SetEntries(const Eigen::VectorXd& entries, const PolyhedronFactor& factor,
                Eigen::VectorXd& whole) {
  whole(factor.variables) = entries;
}

}  // namespace mortise::parametric
