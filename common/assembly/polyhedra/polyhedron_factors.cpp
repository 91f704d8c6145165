#include "common/assembly/polyhedra/polyhedron_factors.h"

#include <algorithm>
#include <boost/pending/disjoint_sets.hpp>
#include <map>
#include <vector>

namespace mortise::parametric {
namespace {

using Connected = boost::disjoint_sets_with_storage<>;

std::size_t FirstVariable(const Eigen::MatrixXd& rows, Eigen::Index row) {
  Eigen::Index first = 0;
  while (rows(row, first) == 0) ++first;
  return static_cast<std::size_t>(first);
}

void Connect(const Eigen::MatrixXd& rows, Connected& connected) {
  for (Eigen::Index row = 0; row < rows.rows(); ++row) {
    const std::size_t first = FirstVariable(rows, row);
    for (auto i = first + 1; i < static_cast<std::size_t>(rows.cols()); ++i) {
      if (rows(row, static_cast<Eigen::Index>(i)) != 0) connected.union_set(first, i);
    }
  }
}

}  // namespace

std::vector<PolyhedronFactor> FactorsOf(const Polyhedron& polyhedron) {
  const Eigen::Index variables =
      std::max(polyhedron.inequalities.cols(), polyhedron.equalities.cols());
  Connected connected(static_cast<std::size_t>(variables));
  Connect(polyhedron.inequalities, connected);
  Connect(polyhedron.equalities, connected);
  std::vector<PolyhedronFactor> factors;
  std::map<std::size_t, std::size_t> place;  // of a set's representative
  for (int variable = 0; variable < variables; ++variable) {
    const auto [found, is_new] =
        place.emplace(connected.find_set(static_cast<std::size_t>(variable)), factors.size());
    if (is_new) factors.emplace_back();
    factors[found->second].variables.push_back(variable);
  }
  const auto factor_of = [&](const Eigen::MatrixXd& rows, Eigen::Index row) -> PolyhedronFactor& {
    return factors[place.at(connected.find_set(FirstVariable(rows, row)))];
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
