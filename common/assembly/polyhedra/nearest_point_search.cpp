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

}  // namespace

Eigen::VectorXd IndependentVectors::SharesIn(const Eigen::VectorXd& vector,
                                             Eigen::VectorXd& rest) const {
  Eigen::VectorXd along;
  rest = RestOf(vector, along);
  if (count_ == 0) return Eigen::VectorXd(0);
  return r_.topLeftCorner(count_, count_).triangularView<Eigen::Upper>().solve(along);
}

Eigen::VectorXd IndependentVectors::SharesOf(const Eigen::VectorXd& products,
                                             Eigen::VectorXd& shortest) const {
  const auto r = r_.topLeftCorner(count_, count_);
  const Eigen::VectorXd along = r.transpose().triangularView<Eigen::Lower>().solve(products);
  shortest = q_.leftCols(count_) * along;
  return r.triangularView<Eigen::Upper>().solve(along);
}

void IndependentVectors::Add(const Eigen::VectorXd& vector) {
  Reserve(count_ + 1);
  Eigen::VectorXd along;
  const Eigen::VectorXd rest = RestOf(vector, along);
  const double length = rest.norm();
  q_.col(count_) = rest / length;
  r_.col(count_).setZero();
  r_.col(count_).head(count_) = along;
  r_(count_, count_) = length;
  ++count_;
}

void IndependentVectors::Remove(Eigen::Index index) {
  for (Eigen::Index column = index; column + 1 < count_; ++column) {
    r_.col(column) = r_.col(column + 1).eval();
  }
  --count_;
  // What now stands below the diagonal is turned into it.
  for (Eigen::Index row = index; row < count_; ++row) {
    Eigen::JacobiRotation<double> turn;
    turn.makeGivens(r_(row, row), r_(row + 1, row));
    r_.middleCols(row, count_ - row).applyOnTheLeft(row, row + 1, turn.adjoint());
    q_.applyOnTheRight(row, row + 1, turn);
  }
}

// Twice, as once leaves rounding of vectors that are nearly dependent.
Eigen::VectorXd IndependentVectors::RestOf(const Eigen::VectorXd& vector,
                                           Eigen::VectorXd& along) const {
  const auto q = q_.leftCols(count_);
  along = q.transpose() * vector;
  Eigen::VectorXd rest = vector - q * along;
  const Eigen::VectorXd again = q.transpose() * rest;
  rest -= q * again;
  along += again;
  return rest;
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

NearestPointSearch::NearestPointSearch(const Polyhedron& polyhedron)
    : is_held_(static_cast<std::size_t>(polyhedron.equalities.rows()), true), is_new_(is_held_) {
  const Eigen::VectorXd scale = polyhedron.inequalities.rowwise().norm();
  const Eigen::VectorXd equality_scale = polyhedron.equalities.rowwise().norm();
  rows_ = std::make_shared<const Rows>(
      Rows{scale.cwiseInverse().asDiagonal() * polyhedron.inequalities,
           equality_scale.cwiseInverse().asDiagonal() * polyhedron.equalities,
           polyhedron.bounds.cwiseQuotient(scale), equality_scale});
  values_ = polyhedron.values.cwiseQuotient(equality_scale);
}

void NearestPointSearch::Hold(int equality, double value) {
  const auto index = static_cast<std::size_t>(equality);
  values_[equality] = value / rows_->equality_scale[equality];
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
  return static_cast<std::size_t>(rows_->inequalities.size() + rows_->equalities.size()) *
         sizeof(double);
}

// Begins with the active constraints of the last search that are held still: x goes to the nearest
// point on them. Without those that keep it there against its will, what is left is a beginning.
void NearestPointSearch::LetGoOfWhatPulls() {
  for (std::size_t i = active_.size(); i-- > 0;) {
    if (active_[i].is_equality && !is_held_[static_cast<std::size_t>(active_[i].row)]) {
      Remove(static_cast<Eigen::Index>(i));
    }
  }
  const Eigen::VectorXd from = x_;
  while (!active_.empty()) {
    x_ = from;
    Eigen::VectorXd missing(static_cast<Eigen::Index>(active_.size()));
    for (std::size_t i = 0; i < active_.size(); ++i) {
      missing[static_cast<Eigen::Index>(i)] = -Excess(active_[i]);
    }
    Eigen::VectorXd way;
    const Eigen::VectorXd multipliers = normals_.SharesOf(missing, way);
    x_ += way;
    Eigen::Index most = -1;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      const auto index = static_cast<Eigen::Index>(i);
      active_[i].multiplier = multipliers[index];
      const bool pulls = !active_[i].is_equality && multipliers[index] < 0;
      if (pulls && (most < 0 || multipliers[index] < multipliers[most])) most = index;
    }
    if (most < 0) return;
    Remove(most);
  }
  x_ = from;
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
  Eigen::Index worst = 0;
  if (rows_->inequalities.rows() == 0 ||
      (rows_->inequalities * x_ - rows_->bounds).maxCoeff(&worst) <= kTolerance) {
    return std::nullopt;
  }
  return Active{static_cast<int>(worst), false, -1, 0};
}

// One that others implied, until they were let go.
std::optional<NearestPointSearch::Active> NearestPointSearch::ViolatedEquality() const {
  for (int row = 0; row < static_cast<int>(is_held_.size()); ++row) {
    if (!is_held_[static_cast<std::size_t>(row)]) continue;
    const Active equality = EqualityAt(row);
    if (Excess(equality) < -kTolerance && !IsActive(row)) return equality;
  }
  return std::nullopt;
}

Eigen::VectorXd NearestPointSearch::Normal(const Active& active) const {
  const auto& rows = active.is_equality ? rows_->equalities : rows_->inequalities;
  return active.sign * rows.row(active.row).transpose();
}

// How far x is on the right side; negative on the wrong one.
double NearestPointSearch::Excess(const Active& active) const {
  const auto& rows = active.is_equality ? rows_->equalities : rows_->inequalities;
  const double bound = active.is_equality ? values_[active.row] : rows_->bounds[active.row];
  return active.sign * (rows.row(active.row).dot(x_) - bound);
}

// Normals point to where the constraint holds.
NearestPointSearch::Active NearestPointSearch::EqualityAt(int row) const {
  const double excess = rows_->equalities.row(row).dot(x_) - values_[row];
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
  const Eigen::Index most =
      50 * (rows_->inequalities.rows() + rows_->equalities.rows() + x_.size() + 10);
  while (true) {
    if (++steps_ > most) {
      return absl::InternalError("the nearest point was not found: too many steps");
    }
    Eigen::VectorXd direction;
    const Eigen::VectorXd shares = normals_.SharesIn(normal, direction);
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
      normals_.Add(normal);
      return true;
    }
    Remove(dual.blocking);
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
