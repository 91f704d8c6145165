#include "common/assembly/polyhedra/nearest_point_search.h"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr double kTolerance = 1e-10;  // distance, for rows of unit length
constexpr double kDependent = 1e-9;   // length of what is left of a unit normal among others
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kSparse = 0.25;  // of entries that are not 0
// What it takes to add a vector again, of what it would take if none of its entries were 0: most
// have few.
constexpr double kShareOfAdding = 0.125;

// The first `count` columns' products with a vector.
Eigen::VectorXd AlongColumns(const Eigen::MatrixXd& columns, Eigen::Index count,
                             const Eigen::VectorXd& vector) {
  const auto used = columns.leftCols(count);
  const Eigen::Index full = (vector.array() != 0).count();
  if (static_cast<double>(full) > kSparse * static_cast<double>(vector.size())) {
    return used.transpose() * vector;
  }
  Eigen::VectorXd along = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < vector.size(); ++i) {
    if (vector[i] != 0) along += vector[i] * used.row(i).transpose();
  }
  return along;
}

// Subtracts columns · shares.
void Subtract(const Eigen::MatrixXd& columns, const Eigen::VectorXd& shares,
              Eigen::VectorXd& from) {
  const Eigen::Index full = (shares.array() != 0).count();
  if (static_cast<double>(full) > kSparse * static_cast<double>(shares.size())) {
    from -= columns.leftCols(shares.size()) * shares;
    return;
  }
  for (Eigen::Index i = 0; i < shares.size(); ++i) {
    if (shares[i] != 0) from -= shares[i] * columns.col(i);
  }
}

}  // namespace

// What is left is projected again where little is left: once leaves rounding of vectors that are
// nearly dependent.
IndependentVectors::Split IndependentVectors::SplitOf(const Eigen::VectorXd& vector) const {
  constexpr double kLittleLeft = 0.5;  // of the length
  Split split{AlongColumns(q_, count_, vector), vector};
  Subtract(q_, split.along, split.rest);
  if (split.rest.norm() > kLittleLeft * vector.norm()) return split;
  const Eigen::VectorXd again = AlongColumns(q_, count_, split.rest);
  Subtract(q_, again, split.rest);
  split.along += again;
  return split;
}

// What was removed last leaves its direction behind in the first column that is not used.
void IndependentVectors::SplitAgain(const Eigen::VectorXd& vector, Split& split) const {
  split.along = AlongColumns(q_, count_, vector);
  const auto freed = q_.col(count_);
  split.rest += freed.dot(vector) * freed;
}

// Solves R · shares = along from below; of vectors with little in common most entries are 0.
Eigen::VectorXd IndependentVectors::SharesOf(const Split& split) const {
  Eigen::VectorXd shares = split.along;
  for (Eigen::Index i = count_; i-- > 0;) {
    if (shares[i] == 0) continue;
    shares[i] /= r_(i, i);
    shares.head(i) -= shares[i] * r_.col(i).head(i);
  }
  return shares;
}

Eigen::VectorXd IndependentVectors::SharesOfShortest(const Eigen::VectorXd& products,
                                                     Eigen::VectorXd& shortest) const {
  const auto r = r_.topLeftCorner(count_, count_);
  const Eigen::VectorXd along = r.transpose().triangularView<Eigen::Lower>().solve(products);
  shortest = q_.leftCols(count_) * along;
  return r.triangularView<Eigen::Upper>().solve(along);
}

void IndependentVectors::Add(const Split& split) {
  Reserve(count_ + 1);
  const double length = split.rest.norm();
  q_.col(count_) = split.rest / length;
  r_.col(count_).setZero();
  r_.col(count_).head(count_) = split.along;
  r_(count_, count_) = length;
  ++count_;
}

// Column by column, as R is stored: each is turned as those before it were, and then once more to
// have nothing below its diagonal.
void IndependentVectors::Remove(Eigen::Index index) {
  std::vector<Eigen::JacobiRotation<double>> turns;
  for (Eigen::Index column = index; column + 1 < count_; ++column) {
    r_.col(column).head(column + 2) = r_.col(column + 1).head(column + 2).eval();
    double* const entries = r_.col(column).data();
    for (Eigen::Index row = index; row < column; ++row) {
      const Eigen::JacobiRotation<double>& turned = turns[static_cast<std::size_t>(row - index)];
      const double upper = entries[row], lower = entries[row + 1];
      entries[row] = turned.c() * upper - turned.s() * lower;
      entries[row + 1] = turned.s() * upper + turned.c() * lower;
    }
    Eigen::JacobiRotation<double>& turn = turns.emplace_back();
    turn.makeGivens(entries[column], entries[column + 1], &entries[column]);
    entries[column + 1] = 0;
    q_.applyOnTheRight(column, column + 1, turn);
  }
  --count_;
}

void IndependentVectors::Reserve(Eigen::Index count) {
  if (count <= q_.cols()) return;
  const Eigen::Index capacity = std::max<Eigen::Index>(8, 2 * q_.cols());
  q_.conservativeResize(Eigen::NoChange, capacity);
  r_.conservativeResize(capacity, capacity);
}

struct NearestPointSearch::DualStep {
  double length = kInfinity;
  Eigen::Index blocking = -1;  // index into the active ones
};

NearestPointSearch::UnitRows::UnitRows(const Eigen::MatrixXd& rows) : scale(rows.rowwise().norm()) {
  all = scale.cwiseInverse().asDiagonal() * rows;
  const auto full = static_cast<double>((all.array() != 0).count());
  if (full <= kSparse * static_cast<double>(all.size())) sparse = all.sparseView();
}

Eigen::VectorXd NearestPointSearch::UnitRows::Times(const Eigen::VectorXd& x) const {
  if (sparse) return *sparse * x;
  return all * x;
}

NearestPointSearch::NearestPointSearch(const Polyhedron& polyhedron)
    : is_held_(static_cast<std::size_t>(polyhedron.equalities.rows()), true), is_new_(is_held_) {
  UnitRows inequalities(polyhedron.inequalities);
  UnitRows equalities(polyhedron.equalities);
  values_ = polyhedron.values.cwiseQuotient(equalities.scale);
  Eigen::VectorXd bounds = polyhedron.bounds.cwiseQuotient(inequalities.scale);
  rows_ = std::make_shared<const Rows>(
      Rows{std::move(inequalities), std::move(equalities), std::move(bounds)});
}

void NearestPointSearch::Hold(int equality, double value) {
  const auto index = static_cast<std::size_t>(equality);
  values_[equality] = value / rows_->equalities.scale[equality];
  is_new_[index] = is_new_[index] || !is_held_[index];
  is_held_[index] = true;
}

void NearestPointSearch::Release(int equality) {
  const auto index = static_cast<std::size_t>(equality);
  is_held_[index] = is_new_[index] = false;
}

absl::StatusOr<Projection> NearestPointSearch::NearestTo(const Eigen::VectorXd& x) {
  x_ = x;
  steps_ = 0;
  conflict_.clear();
  if (active_.empty()) normals_ = IndependentVectors(x.size());
  LetGoOfWhatPulls();
  MORTISE_ASSIGN_OR_RETURN(bool is_met, TakeUpEqualities());
  if (is_met) {
    MORTISE_ASSIGN_OR_RETURN(is_met, TakeUpWhatIsViolated());
  }
  Projection projection;
  if (is_met) projection.point = x_;
  for (const Active& constraint : is_met ? active_ : conflict_) {
    (constraint.is_equality ? projection.equalities : projection.inequalities)
        .push_back(constraint.row);
  }
  std::sort(projection.inequalities.begin(), projection.inequalities.end());
  std::sort(projection.equalities.begin(), projection.equalities.end());
  return projection;
}

std::size_t NearestPointSearch::MemoryUse() const {
  const auto bytes_of = [](const UnitRows& rows) {
    const Eigen::Index sparse = rows.sparse ? 2 * rows.sparse->nonZeros() : 0;
    return static_cast<std::size_t>(rows.all.size() + sparse) * sizeof(double);
  };
  return bytes_of(rows_->inequalities) + bytes_of(rows_->equalities);
}

// Begins with the active constraints of the last search that are held still: x goes to the nearest
// point on them. Without those that keep it there against its will, what is left is a beginning.
void NearestPointSearch::LetGoOfWhatPulls() {
  std::vector<bool> goes;
  for (const Active& active : active_) {
    goes.push_back(active.is_equality && !is_held_[static_cast<std::size_t>(active.row)]);
  }
  RemoveAll(goes);
  std::vector<double> missing;
  for (const Active& active : active_) missing.push_back(-Excess(active));
  while (!active_.empty()) {
    const auto count = static_cast<Eigen::Index>(active_.size());
    Eigen::VectorXd way;
    const Eigen::VectorXd multipliers =
        normals_.SharesOfShortest(Eigen::Map<const Eigen::VectorXd>(missing.data(), count), way);
    goes.assign(active_.size(), false);
    for (std::size_t i = 0; i < active_.size(); ++i) {
      active_[i].multiplier = multipliers[static_cast<Eigen::Index>(i)];
      goes[i] = !active_[i].is_equality && active_[i].multiplier < 0;
    }
    if (std::find(goes.begin(), goes.end(), true) == goes.end()) {
      x_ += way;
      return;
    }
    RemoveAll(goes);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < goes.size(); ++i) {
      if (!goes[i]) missing[kept++] = missing[i];
    }
    missing.resize(kept);
  }
}

// Lets go of these active constraints: one by one, or, where that takes less, by adding those again
// that come after the first of them.
void NearestPointSearch::RemoveAll(const std::vector<bool>& goes) {
  const auto first = std::find(goes.begin(), goes.end(), true) - goes.begin();
  const auto count = static_cast<double>(goes.size()), size = static_cast<double>(x_.size());
  double removing = 0, adding = 0;  // multiplications
  for (auto i = static_cast<std::size_t>(first); i < goes.size(); ++i) {
    const double after = count - static_cast<double>(i);
    removing += goes[i] ? 4 * after * (size + after / 2) : 0;
    adding += goes[i] ? 0 : kShareOfAdding * 3 * size * static_cast<double>(i);
  }
  if (removing <= adding) {
    for (std::size_t i = goes.size(); i-- > 0;) {
      if (goes[i]) Remove(static_cast<Eigen::Index>(i));
    }
    return;
  }
  normals_.KeepFirst(first);
  std::vector<Active> kept(active_.begin(), active_.begin() + first);
  for (auto i = static_cast<std::size_t>(first); i < goes.size(); ++i) {
    if (goes[i]) continue;
    kept.push_back(active_[i]);
    normals_.Add(normals_.SplitOf(Normal(active_[i])));
  }
  active_ = std::move(kept);
}

// Takes up the equalities that are new. Those that were implied before are looked at like any
// other constraint.
absl::StatusOr<bool> NearestPointSearch::TakeUpEqualities() {
  for (std::size_t row = 0; row < is_held_.size(); ++row) {
    if (!is_held_[row] || !is_new_[row]) continue;
    is_new_[row] = false;
    if (IsActive(static_cast<int>(row))) continue;
    MORTISE_ASSIGN_OR_RETURN(const bool taken_up, TakeUp(EqualityAt(static_cast<int>(row))));
    if (!taken_up) {
      std::fill(is_new_.begin(), is_new_.end(), true);
      return false;
    }
  }
  return true;
}

absl::StatusOr<bool> NearestPointSearch::TakeUpWhatIsViolated() {
  while (true) {
    std::optional<Active> violated = ViolatedInequality();
    if (!violated) violated = ViolatedEquality();
    if (!violated) return true;
    MORTISE_ASSIGN_OR_RETURN(const bool taken_up, TakeUp(*violated));
    if (!taken_up) return false;
  }
}

std::optional<NearestPointSearch::Active> NearestPointSearch::ViolatedInequality() const {
  if (rows_->bounds.size() == 0) return std::nullopt;
  const Eigen::VectorXd excess = rows_->inequalities.Times(x_) - rows_->bounds;
  Eigen::Index worst = 0;
  if (excess.maxCoeff(&worst) <= kTolerance) return std::nullopt;
  return Active{static_cast<int>(worst), false, -1, 0};
}

// One that others implied, until they were let go.
std::optional<NearestPointSearch::Active> NearestPointSearch::ViolatedEquality() const {
  const Eigen::VectorXd missed = rows_->equalities.Times(x_) - values_;
  for (int row = 0; row < static_cast<int>(is_held_.size()); ++row) {
    if (!is_held_[static_cast<std::size_t>(row)] || std::abs(missed[row]) <= kTolerance) continue;
    if (!IsActive(row)) return EqualityAt(row);
  }
  return std::nullopt;
}

Eigen::VectorXd NearestPointSearch::Normal(const Active& active) const {
  const auto& rows = active.is_equality ? rows_->equalities.all : rows_->inequalities.all;
  return active.sign * rows.row(active.row).transpose();
}

// How far x is on the right side; negative on the wrong one.
double NearestPointSearch::Excess(const Active& active) const {
  const auto& rows = active.is_equality ? rows_->equalities.all : rows_->inequalities.all;
  const double bound = active.is_equality ? values_[active.row] : rows_->bounds[active.row];
  return active.sign * (rows.row(active.row).dot(x_) - bound);
}

// Normals point to where the constraint holds.
NearestPointSearch::Active NearestPointSearch::EqualityAt(int row) const {
  const double excess = rows_->equalities.all.row(row).dot(x_) - values_[row];
  return {row, true, excess > 0 ? -1.0 : 1.0, 0};
}

bool NearestPointSearch::IsActive(int equality) const {
  return std::any_of(active_.begin(), active_.end(), [&](const Active& active) {
    return active.is_equality && active.row == equality;
  });
}

// Moves x onto a constraint that it breaks, while all active ones go on holding; those that would
// pull instead of push are let go. False if that cannot be: `conflict_` then has the reason.
absl::StatusOr<bool> NearestPointSearch::TakeUp(Active added) {
  const Eigen::VectorXd normal = Normal(added);
  const Eigen::Index most = 50 * (rows_->bounds.size() + values_.size() + x_.size() + 10);
  IndependentVectors::Split split = normals_.SplitOf(normal);
  while (true) {
    if (++steps_ > most) {
      return absl::InternalError("the nearest point was not found: too many steps");
    }
    const Eigen::VectorXd& direction = split.rest;
    const Eigen::VectorXd shares = normals_.SharesOf(split);
    const bool depends = direction.norm() <= kDependent;
    const DualStep dual = LongestDualStep(shares);
    const double excess = Excess(added);
    if (depends && excess >= -kTolerance) return true;  // implied by those that hold
    if (depends && dual.blocking < 0) {
      NoteConflict(added, shares);
      return false;
    }
    const double primal = depends ? kInfinity : -excess / direction.squaredNorm();
    const double step = std::min(primal, dual.length);
    if (!std::isfinite(step)) {
      return absl::InternalError("the nearest point was not found: numbers too large");
    }
    if (!depends) x_ += step * direction;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      active_[i].multiplier -= step * shares[static_cast<Eigen::Index>(i)];
    }
    added.multiplier += step;
    if (primal <= dual.length) {
      active_.push_back(added);
      normals_.Add(split);
      return true;
    }
    Remove(dual.blocking);
    normals_.SplitAgain(normal, split);
  }
}

NearestPointSearch::DualStep NearestPointSearch::LongestDualStep(
    const Eigen::VectorXd& shares) const {
  DualStep step;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    const double share = shares[static_cast<Eigen::Index>(i)];
    if (active_[i].is_equality || share <= kTolerance) continue;
    const double length = std::max(active_[i].multiplier, 0.0) / share;
    if (length < step.length) step = {length, static_cast<Eigen::Index>(i)};
  }
  return step;
}

void NearestPointSearch::Remove(Eigen::Index index) {
  active_.erase(active_.begin() + index);
  normals_.Remove(index);
}

void NearestPointSearch::NoteConflict(const Active& added, const Eigen::VectorXd& shares) {
  conflict_ = {added};
  for (std::size_t i = 0; i < active_.size(); ++i) {
    if (std::abs(shares[static_cast<Eigen::Index>(i)]) > kDependent) {
      conflict_.push_back(active_[i]);
    }
  }
}

absl::StatusOr<Furthest> FurthestBy(
    const std::function<absl::StatusOr<Projection>(const Eigen::VectorXd&)>& project,
    const Eigen::VectorXd& direction, const Eigen::VectorXd& from) {
  constexpr double kNoGain = 1e-11;
  constexpr double kFar = 1e9;  // steps that long meet no end
  MORTISE_ASSIGN_OR_RETURN(Projection at, project(from));
  const double length = direction.norm();
  if (!at.point || length == 0) return Furthest{at.point, at.inequalities, at.equalities};
  const Eigen::VectorXd unit = direction / length;
  for (double step = 1; step < kFar; step *= 4) {
    MORTISE_ASSIGN_OR_RETURN(Projection next, project(*at.point + step * unit));
    if (!next.point) return absl::InternalError("a polyhedron lost its points");
    const double gain = unit.dot(*next.point - *at.point);
    at = std::move(next);
    if (gain <= kNoGain) return Furthest{at.point, {}, {}};
  }
  return Furthest{};
}

}  // namespace mortise::parametric
