#include "common/assembly/polyhedra/linear_programme.h"

#include <ClpSimplex.hpp>
#include <CoinError.hpp>
#include <CoinPackedMatrix.hpp>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr double kTolerance = 1e-9;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Entries of no more than this share of their row's length are what rounding has left of none. They
// say nothing, and Clp's factorisation, which asserts that no entry is 0, need not pivot on them.
constexpr double kRounding = 1e-14;

// What ClpSimplex::status() says.
constexpr int kOptimal = 0;
constexpr int kEmpty = 1;
constexpr int kEndless = 2;

// Rows of unit length, so that tolerances are distances.
CoinPackedMatrix SparseRows(const Eigen::MatrixXd& inequalities, const Eigen::VectorXd& lengths) {
  std::vector<int> rows, columns;
  std::vector<double> entries;
  for (Eigen::Index column = 0; column < inequalities.cols(); ++column) {
    for (Eigen::Index row = 0; row < inequalities.rows(); ++row) {
      const double entry = inequalities(row, column) / lengths[row];
      if (std::abs(entry) <= kRounding) continue;
      rows.push_back(static_cast<int>(row));
      columns.push_back(static_cast<int>(column));
      entries.push_back(entry);
    }
  }
  CoinPackedMatrix matrix(true, rows.data(), columns.data(), entries.data(),
                          static_cast<CoinBigIndex>(entries.size()));
  matrix.setDimensions(static_cast<int>(inequalities.rows()),
                       static_cast<int>(inequalities.cols()));
  return matrix;
}

absl::Status Failed(const std::string& why) {
  return absl::InternalError(absl::StrCat("the linear programme was not solved: ", why));
}

}  // namespace

LinearProgramme::LinearProgramme(std::unique_ptr<ClpSimplex> solver, Eigen::VectorXd lengths)
    : solver_(std::move(solver)), lengths_(std::move(lengths)) {}
LinearProgramme::LinearProgramme(LinearProgramme&&) noexcept = default;
LinearProgramme& LinearProgramme::operator=(LinearProgramme&&) noexcept = default;
LinearProgramme::~LinearProgramme() = default;

absl::StatusOr<LinearProgramme> LinearProgramme::Create(const Eigen::MatrixXd& inequalities,
                                                        const Eigen::VectorXd& bounds,
                                                        double reach) {
  if (!(reach > 0)) return InvalidField("reach", "must be positive");
  if (inequalities.rows() != bounds.size()) {
    return InvalidField("bounds", "must be one for each inequality");
  }
  if (!inequalities.allFinite() || !bounds.allFinite()) {
    return InvalidField("inequalities", "must be finite");
  }
  const Eigen::VectorXd lengths = inequalities.rowwise().norm();
  if (lengths.size() > 0 && lengths.minCoeff() == 0) {
    return InvalidField("inequalities", "has a row of zeros");
  }
  const auto variables = static_cast<std::size_t>(inequalities.cols());
  const auto rows = static_cast<std::size_t>(inequalities.rows());
  const std::vector<double> below(variables, -reach), above(variables, reach);
  const std::vector<double> indifferent(variables, 0.0), row_below(rows, -kInfinity);
  const Eigen::VectorXd row_above = bounds.cwiseQuotient(lengths);
  try {
    auto solver = std::make_unique<ClpSimplex>();
    solver->setLogLevel(0);
    solver->loadProblem(SparseRows(inequalities, lengths), below.data(), above.data(),
                        indifferent.data(), row_below.data(), row_above.data());
    solver->setOptimizationDirection(-1);
    solver->scaling(0);
    solver->setPrimalTolerance(kTolerance);
    solver->setDualTolerance(kTolerance);
    return LinearProgramme(std::move(solver), lengths);
  } catch (const CoinError& error) {
    return Failed(error.message());
  }
}

absl::StatusOr<std::optional<Eigen::VectorXd>> LinearProgramme::Furthest(
    const Eigen::VectorXd& direction) {
  const int variables = solver_->numberColumns();
  if (direction.size() != variables || !direction.allFinite()) {
    return InvalidField("direction", absl::StrCat("must be ", variables, " finite numbers"));
  }
  try {
    for (int i = 0; i < variables; ++i) solver_->setObjectiveCoefficient(i, direction[i]);
    solver_->primal();
  } catch (const CoinError& error) {
    return Failed(error.message());
  }
  switch (solver_->status()) {
    case kOptimal:
      return std::optional<Eigen::VectorXd>(
          Eigen::Map<const Eigen::VectorXd>(solver_->primalColumnSolution(), variables));
    case kEmpty:
      return PreconditionFailed("POLYHEDRON_EMPTY", "no point meets all inequalities");
    case kEndless:
      return std::optional<Eigen::VectorXd>();
    default:
      return Failed(absl::StrCat("status ", solver_->status()));
  }
}

absl::StatusOr<std::optional<ProgrammeCorner>> LinearProgramme::FurthestCorner(
    const Eigen::VectorXd& direction) {
  MORTISE_ASSIGN_OR_RETURN(auto furthest, Furthest(direction));
  if (!furthest) return std::optional<ProgrammeCorner>();
  const Eigen::Map<const Eigen::VectorXd> prices(solver_->dualRowSolution(), solver_->numberRows());
  // Clp's prices have the sign of a minimum.
  return std::optional<ProgrammeCorner>(
      {*std::move(furthest), prices.cwiseAbs().cwiseQuotient(lengths_)});
}

}  // namespace mortise::parametric
