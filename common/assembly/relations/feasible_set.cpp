#include "common/assembly/relations/feasible_set.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/assembly/polyhedra/hit_and_run.h"
#include "common/assembly/polyhedra/linear_programme.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/assembly/polyhedra/polyhedron_extents.h"
#include "common/assembly/polyhedra/polyhedron_factors.h"
#include "common/assembly/relations/equality_solver.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr double kDrawnTolerance = 1e-9;  // m
constexpr double kParallel = 1e-9;        // between unit normals
constexpr double kRounding = 1e-13;       // in a unit normal
constexpr double kNoShare = 1e-7;         // of a relationship in a conflict

double AmountBroken(const Relationship& relationship, const Eigen::VectorXd& q) {
  const double value = relationship.form.At(q);
  return relationship.equality ? std::abs(value) : std::max(value, 0.0);
}

absl::Status Unbounded() {
  return PreconditionFailed("FEASIBLE_SET_UNBOUNDED",
                            "the design can move or grow without end: anchor an element");
}

absl::Status Conflict(const std::vector<std::string>& reasons) {
  return PreconditionFailed("DEMANDS_CONFLICT",
                            absl::StrCat("cannot hold together: ", absl::StrJoin(reasons, "; ")));
}

}  // namespace

absl::StatusOr<FeasibleSet> FeasibleSet::Create(std::vector<Relationship> relationships,
                                                const Eigen::VectorXd& drawn,
                                                const std::vector<int>& variables,
                                                const std::vector<int>& parents,
                                                EqualitySolver* solver) {
  FeasibleSet set;
  set.all_ = std::move(relationships);
  set.drawn_ = drawn;
  set.weights_ = Eigen::VectorXd::Ones(drawn.size());
  const std::vector<Violation> violations = set.Violations(drawn, kDrawnTolerance);
  if (!violations.empty()) {
    return PreconditionFailed("DRAWN_DESIGN_INFEASIBLE",
                              absl::StrCat("the design as drawn breaks ", violations.size(),
                                           " relationships, first: ", violations[0].description));
  }
  EqualitySolver own;
  set.UseSolution(SolveEqualities(set.all_, variables, parents, solver == nullptr ? own : *solver));
  set.ReduceInequalities();
  return set;
}

absl::StatusOr<FeasibleSet> FeasibleSet::Rescaled(const Eigen::VectorXd& scales) const {
  if (scales.size() != drawn_.size() || !scales.allFinite() || (scales.array() <= 0).any()) {
    return InvalidField("scales", absl::StrCat("must be ", drawn_.size(), " positive numbers"));
  }
  FeasibleSet set = *this;
  set.weights_ = scales.array().square().inverse();
  set.Reframe();
  return set;
}

FeasibleSet FeasibleSet::FreedAlong(const Eigen::MatrixXd& directions) const {
  const auto forbids = [&](const Relationship& relationship) {
    Eigen::RowVectorXd change = Eigen::RowVectorXd::Zero(directions.cols());
    for (const LinearTerm& term : relationship.form.terms) {
      change += term.coefficient * directions.row(term.variable);
    }
    return change.cwiseAbs().maxCoeff() > kParallel;
  };
  FeasibleSet set = *this;
  std::erase_if(set.all_, forbids);
  std::erase_if(set.equalities_, forbids);
  set.basis_.conservativeResize(Eigen::NoChange, basis_.cols() + directions.cols());
  set.basis_.rightCols(directions.cols()) = directions;
  set.Reframe();
  return set;
}

void FeasibleSet::Reframe() {
  if (basis_.cols() == 0) return;
  const Eigen::LLT<Eigen::MatrixXd> metric(basis_.transpose() * weights_.asDiagonal() * basis_);
  basis_ = metric.matrixL().solve(basis_.transpose()).transpose();
  inequalities_.clear();
  ReduceInequalities();
}

void FeasibleSet::UseSolution(const SolvedEqualities& solved) {
  for (const Relationship* kept : solved.kept) equalities_.push_back(*kept);
  Eigen::Index degrees = 0;
  for (const FreeVariables& free : solved.free) degrees += free.directions.cols();
  basis_ = Eigen::MatrixXd::Zero(drawn_.size(), degrees);
  Eigen::Index column = 0;
  for (const FreeVariables& free : solved.free) {
    for (std::size_t i = 0; i < free.variables.size(); ++i) {
      basis_.row(free.variables[i]).segment(column, free.directions.cols()) =
          free.directions.row(static_cast<Eigen::Index>(i));
    }
    column += free.directions.cols();
  }
}

void FeasibleSet::ReduceInequalities() {
  struct Reduced {
    const Relationship* relationship;
    Eigen::VectorXd normal;
    double slack;
  };
  using Direction = std::vector<std::pair<Eigen::Index, std::int64_t>>;  // entries that are not 0
  std::vector<Reduced> kept;
  std::map<Direction, std::size_t> by_direction;
  for (const Relationship& relationship : all_) {
    if (relationship.equality) continue;
    Eigen::VectorXd normal = Eigen::VectorXd::Zero(basis_.cols());
    for (const LinearTerm& term : relationship.form.terms) {
      normal += term.coefficient * basis_.row(term.variable).transpose();
    }
    const double length = normal.norm();
    if (length <= kParallel) continue;  // the equalities decide it, and as drawn it holds
    normal /= length;
    // Rounding must not tie together what has nothing to do with each other.
    normal = (normal.array().abs() <= kRounding).select(0, normal);
    const double slack = -relationship.form.At(drawn_) / length;
    Direction direction;
    for (Eigen::Index i = 0; i < normal.size(); ++i) {
      const auto rounded = std::llround(normal[i] / kParallel / 10);
      if (rounded != 0) direction.emplace_back(i, rounded);
    }
    const auto [place, is_new] = by_direction.emplace(std::move(direction), kept.size());
    if (is_new) {
      kept.push_back({&relationship, std::move(normal), slack});
    } else if (slack < kept[place->second].slack) {
      kept[place->second] = {&relationship, std::move(normal), slack};
    }
  }
  normals_.resize(static_cast<Eigen::Index>(kept.size()), basis_.cols());
  slacks_.resize(static_cast<Eigen::Index>(kept.size()));
  for (std::size_t i = 0; i < kept.size(); ++i) {
    inequalities_.push_back(*kept[i].relationship);
    normals_.row(static_cast<Eigen::Index>(i)) = kept[i].normal.transpose();
    slacks_[static_cast<Eigen::Index>(i)] = kept[i].slack;
  }
}

std::vector<Violation> FeasibleSet::Violations(const Eigen::VectorXd& q, double tolerance) const {
  std::vector<Violation> violations;
  for (const Relationship& relationship : all_) {
    const double amount = AmountBroken(relationship, q);
    if (!(amount <= tolerance)) violations.push_back({relationship.description, amount});
  }
  return violations;
}

absl::StatusOr<FeasibleSet::Held> FeasibleSet::Hold(const std::vector<Demand>& demands) const {
  Held held{{normals_, slacks_, Eigen::MatrixXd(0, basis_.cols()), Eigen::VectorXd(0)}, {}};
  for (std::size_t i = 0; i < demands.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(const auto row, RowOf(demands[i], i));
    const double missing = demands[i].value - demands[i].form.At(drawn_);
    if (row.norm() <= kParallel) {
      if (std::abs(missing) <= kDrawnTolerance) continue;
      std::vector<std::string> reasons = EqualitiesBehind({&demands[i].form});
      reasons.insert(reasons.begin(), demands[i].description);
      return Conflict(reasons);
    }
    const Eigen::Index rows = held.feasible.equalities.rows() + 1;
    held.feasible.equalities.conservativeResize(rows, Eigen::NoChange);
    held.feasible.equalities.bottomRows(1) = row.transpose();
    held.feasible.values.conservativeResize(rows);
    held.feasible.values[rows - 1] = missing;
    held.demands.push_back(&demands[i]);
  }
  return held;
}

// By Farkas' lemma some combination of the rows says nothing of z; in q it is made of equalities.
absl::Status FeasibleSet::ConflictOf(const Held& held, const std::vector<int>& equalities,
                                     const std::vector<int>& inequalities) const {
  std::vector<std::string> reasons;
  std::vector<const LinearForm*> forms;
  for (const int row : equalities) {
    const Demand& demand = *held.demands[static_cast<std::size_t>(row)];
    reasons.push_back(demand.description);
    forms.push_back(&demand.form);
  }
  for (const int row : inequalities) {
    const Relationship& inequality = inequalities_[static_cast<std::size_t>(row)];
    reasons.push_back(inequality.description);
    forms.push_back(&inequality.form);
  }
  for (std::string& name : EqualitiesBehind(forms)) reasons.push_back(std::move(name));
  return Conflict(reasons);
}

// The kept equalities of which a combination of these forms is made that is the same for all z.
std::vector<std::string> FeasibleSet::EqualitiesBehind(
    const std::vector<const LinearForm*>& forms) const {
  Eigen::MatrixXd across =
      Eigen::MatrixXd::Zero(basis_.cols(), static_cast<Eigen::Index>(forms.size()));
  for (std::size_t i = 0; i < forms.size(); ++i) {
    for (const LinearTerm& term : forms[i]->terms) {
      across.col(static_cast<Eigen::Index>(i)) +=
          term.coefficient * basis_.row(term.variable).transpose();
    }
  }
  Eigen::VectorXd shares = Eigen::VectorXd::Ones(across.cols());
  if (across.cols() > 1) {
    Eigen::FullPivLU<Eigen::MatrixXd> decomposition(across);
    decomposition.setThreshold(kParallel);
    shares = decomposition.kernel().col(0);
  }
  std::map<int, double> combination;  // by variable
  for (std::size_t i = 0; i < forms.size(); ++i) {
    for (const LinearTerm& term : forms[i]->terms) {
      combination[term.variable] += shares[static_cast<Eigen::Index>(i)] * term.coefficient;
    }
  }
  std::vector<int> variables(static_cast<std::size_t>(drawn_.size()));
  std::iota(variables.begin(), variables.end(), 0);
  std::vector<std::string> names;
  for (const EqualityBlock& block : SplitIntoBlocks(equalities_, variables)) {
    const bool takes_part =
        std::any_of(block.variables.begin(), block.variables.end(),
                    [&](int variable) { return combination.count(variable) != 0; });
    if (block.equalities.empty() || !takes_part) continue;
    const Eigen::MatrixXd columns = ColumnsOf(block);
    Eigen::VectorXd wanted = Eigen::VectorXd::Zero(columns.rows());
    for (std::size_t i = 0; i < block.variables.size(); ++i) {
      const auto found = combination.find(block.variables[i]);
      if (found != combination.end()) wanted[static_cast<Eigen::Index>(i)] = found->second;
    }
    const Eigen::VectorXd parts = columns.colPivHouseholderQr().solve(wanted);
    for (Eigen::Index i = 0; i < parts.size(); ++i) {
      if (std::abs(parts[i]) <= kNoShare * std::max(1.0, parts.cwiseAbs().maxCoeff())) continue;
      // What repeats together does so in place and in size, under one name.
      const std::string& name = block.equalities[static_cast<std::size_t>(i)]->description;
      if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

absl::StatusOr<Eigen::VectorXd> FeasibleSet::Nearest(const Eigen::VectorXd& wish,
                                                     const std::vector<Demand>& demands) const {
  if (wish.size() != drawn_.size() || !wish.allFinite()) {
    return InvalidField("wish", absl::StrCat("must be ", drawn_.size(), " finite numbers"));
  }
  MORTISE_ASSIGN_OR_RETURN(const Held held, Hold(demands));
  MORTISE_ASSIGN_OR_RETURN(
      const Projection nearest,
      ProjectOnto(held.feasible, basis_.transpose() * weights_.cwiseProduct(wish - drawn_)));
  if (nearest.point) return Eigen::VectorXd(drawn_ + basis_ * *nearest.point);
  return ConflictOf(held, nearest.equalities, nearest.inequalities);
}

absl::StatusOr<Eigen::VectorXd> FeasibleSet::Furthest(const LinearForm& form,
                                                      const std::vector<Demand>& demands) const {
  MORTISE_ASSIGN_OR_RETURN(Eigen::VectorXd row, RowOf({form, 0, ""}, 0));
  if (row.norm() <= kParallel) row.setZero();
  MORTISE_ASSIGN_OR_RETURN(const Held held, Hold(demands));
  MORTISE_ASSIGN_OR_RETURN(const parametric::Furthest end,
                           FurthestAlong(held.feasible, row, Eigen::VectorXd::Zero(row.size())));
  if (end.point) return Eigen::VectorXd(drawn_ + basis_ * *end.point);
  if (end.equalities.empty() && end.inequalities.empty()) return Unbounded();
  return ConflictOf(held, end.equalities, end.inequalities);
}

absl::StatusOr<std::vector<Range>> FeasibleSet::RangesOf(
    const std::vector<LinearForm>& forms) const {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(forms.size()), basis_.cols());
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < forms.size(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(rows.row(static_cast<Eigen::Index>(i)), RowOf({forms[i], 0, ""}, i));
    ranges.push_back({forms[i].At(drawn_), forms[i].At(drawn_)});
  }
  const Polyhedron whole{normals_, slacks_, Eigen::MatrixXd(0, basis_.cols()), Eigen::VectorXd(0)};
  for (const PolyhedronFactor& of : FactorsOf(whole)) {
    std::vector<int> moving;  // forms whose value the factor changes
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      if (rows(i, of.variables).norm() > kParallel) moving.push_back(static_cast<int>(i));
    }
    if (moving.empty()) continue;
    const Polyhedron factor = PolyhedronOf(whole, of);
    MORTISE_ASSIGN_OR_RETURN(const Extents extents, ExtentsAlong(factor.inequalities, factor.bounds,
                                                                 rows(moving, of.variables)));
    if (!extents.least.allFinite() || !extents.greatest.allFinite()) return Unbounded();
    for (std::size_t i = 0; i < moving.size(); ++i) {
      Range& range = ranges[static_cast<std::size_t>(moving[i])];
      range.minimum += extents.least[static_cast<Eigen::Index>(i)];
      range.maximum += extents.greatest[static_cast<Eigen::Index>(i)];
    }
  }
  return ranges;
}

absl::StatusOr<PolyhedronShadow> FeasibleSet::ValuesOf(const std::vector<LinearForm>& forms) const {
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(forms.size()), basis_.cols());
  Eigen::VectorXd drawn(rows.rows());
  for (std::size_t i = 0; i < forms.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    MORTISE_ASSIGN_OR_RETURN(rows.row(at), RowOf({forms[i], 0, ""}, i));
    drawn[at] = forms[i].At(drawn_);
    if (rows.row(at).norm() > kParallel) continue;
    return InvalidField(absl::StrCat("forms[", i, "]"), "is the same in all designs");
  }
  absl::StatusOr<PolyhedronShadow> shadow = ShadowOf(normals_, slacks_, rows);
  if (DetailOf(shadow.status()).reason == "POLYHEDRON_UNBOUNDED") return Unbounded();
  MORTISE_RETURN_IF_ERROR(shadow.status());
  shadow->bounds += shadow->inequalities * drawn;
  return shadow;
}

absl::StatusOr<std::vector<Eigen::VectorXd>> FeasibleSet::Corners(int count,
                                                                  std::uint64_t seed) const {
  if (count < 0) return InvalidField("count", "must not be negative");
  const Polyhedron whole{normals_, slacks_, Eigen::MatrixXd(0, basis_.cols()), Eigen::VectorXd(0)};
  std::vector<Eigen::VectorXd> corners(static_cast<std::size_t>(count),
                                       Eigen::VectorXd::Zero(basis_.cols()));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (const PolyhedronFactor& of : FactorsOf(whole)) {
    const Polyhedron factor = PolyhedronOf(whole, of);
    MORTISE_ASSIGN_OR_RETURN(LinearProgramme programme,
                             LinearProgramme::Create(factor.inequalities, factor.bounds));
    for (Eigen::VectorXd& corner : corners) {
      Eigen::VectorXd direction(static_cast<Eigen::Index>(of.variables.size()));
      for (double& component : direction) component = normal(random);
      MORTISE_ASSIGN_OR_RETURN(const auto furthest, programme.Furthest(direction));
      if (!furthest) return Unbounded();
      SetEntries(*furthest, of, corner);
    }
  }
  for (Eigen::VectorXd& corner : corners) corner = drawn_ + basis_ * corner;
  return corners;
}

absl::StatusOr<std::optional<Eigen::VectorXd>> FeasibleSet::UnboundedDirection() const {
  const Polyhedron whole{normals_, slacks_, Eigen::MatrixXd(0, basis_.cols()), Eigen::VectorXd(0)};
  for (const PolyhedronFactor& factor : FactorsOf(whole)) {
    MORTISE_ASSIGN_OR_RETURN(
        const auto open, parametric::UnboundedDirection(PolyhedronOf(whole, factor).inequalities));
    if (!open) continue;
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(basis_.cols());
    SetEntries(*open, factor, direction);
    return std::optional<Eigen::VectorXd>(basis_ * direction);
  }
  return std::optional<Eigen::VectorXd>();
}

absl::StatusOr<Eigen::VectorXd> FeasibleSet::RowOf(const Demand& demand, std::size_t index) const {
  Eigen::VectorXd row = Eigen::VectorXd::Zero(basis_.cols());
  bool is_usable = std::isfinite(demand.value) && std::isfinite(demand.form.constant);
  for (const LinearTerm& term : demand.form.terms) {
    is_usable = is_usable && term.variable >= 0 && term.variable < drawn_.size() &&
                std::isfinite(term.coefficient);
    if (is_usable) row += term.coefficient * basis_.row(term.variable).transpose();
  }
  if (is_usable) return row;
  return InvalidField(absl::StrCat("demands[", index, "]"),
                      "must be finite and speak of parameters there are");
}

absl::StatusOr<std::vector<Eigen::VectorXd>> FeasibleSet::Sample(int count,
                                                                 std::uint64_t seed) const {
  if (count < 0) return InvalidField("count", "must not be negative");
  MORTISE_ASSIGN_OR_RETURN(const auto open, UnboundedDirection());
  if (open) return Unbounded();
  MORTISE_ASSIGN_OR_RETURN(std::vector<Eigen::VectorXd> samples,
                           SamplePolyhedron(normals_, slacks_, count, seed));
  for (Eigen::VectorXd& sample : samples) sample = drawn_ + basis_ * sample;
  return samples;
}

std::vector<Relationship> Anchor(const std::vector<Element>& elements, int element) {
  std::vector<Relationship> anchor;
  const Element& held = elements[static_cast<std::size_t>(element)];
  for (const Axis axis : {Axis::kX, Axis::kY, Axis::kZ}) {
    Relationship relationship;
    relationship.kind = RelationshipKind::kConcentric;
    relationship.form = LinearForm::Variable(CenterVariable(element, axis));
    relationship.form.constant = -held.box.center()[static_cast<int>(axis)];
    relationship.group = held.group;
    relationship.description =
        absl::StrCat("'", held.name, "' held in place along ", AxisName(axis));
    anchor.push_back(std::move(relationship));
  }
  return anchor;
}

}  // namespace mortise::parametric
