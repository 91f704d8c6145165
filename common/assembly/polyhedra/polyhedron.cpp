#include "common/assembly/polyhedra/polyhedron.h"

#include <Eigen/Jacobi>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/assembly/polyhedra/linear_programme.h"
#include "common/assembly/polyhedra/polyhedron_factors.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr double kTolerance = 1e-10;  // distance, for rows of unit length
constexpr double kDependent = 1e-9;   // length of what is left of a unit normal among others
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A constraint that holds with equality: normal · x = offset, pushed along `normal` by
// `multiplier`.
struct Active {
  int row = 0;
  bool is_equality = false;
  double sign = 1;  // of the row in `normal`
  double multiplier = 0;
};

// How far one may go until the multiplier of an inequality is used up.
struct DualStep {
  double length = kInfinity;
  Eigen::Index blocking = -1;  // index into the active ones
};

// Linearly independent vectors as Q · R with orthonormal columns of Q, one vector more or less at a
// time: O(n k) for k vectors of n numbers.
class IndependentVectors {
 public:
  explicit IndependentVectors(Eigen::Index size) : q_(size, 0), r_(0, 0) {}

  // `vector` as a combination of these, in least squares, and what is left of it.
  Eigen::VectorXd SharesIn(const Eigen::VectorXd& vector, Eigen::VectorXd& rest) const {
    Eigen::VectorXd along;
    rest = RestOf(vector, along);
    if (count_ == 0) return Eigen::VectorXd(0);
    return r_.topLeftCorner(count_, count_).triangularView<Eigen::Upper>().solve(along);
  }

  void Add(const Eigen::VectorXd& vector) {
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

  void Remove(Eigen::Index index) {
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

 private:
  // Twice, as once leaves rounding of vectors that are nearly dependent.
  Eigen::VectorXd RestOf(const Eigen::VectorXd& vector, Eigen::VectorXd& along) const {
    const auto q = q_.leftCols(count_);
    along = q.transpose() * vector;
    Eigen::VectorXd rest = vector - q * along;
    const Eigen::VectorXd again = q.transpose() * rest;
    rest -= q * again;
    along += again;
    return rest;
  }

  void Reserve(Eigen::Index count) {
    if (count <= q_.cols()) return;
    const Eigen::Index capacity = std::max<Eigen::Index>(8, 2 * q_.cols());
    q_.conservativeResize(Eigen::NoChange, capacity);
    r_.conservativeResize(capacity, capacity);
  }

  Eigen::MatrixXd q_, r_;  // of which the first count_ columns are used
  Eigen::Index count_ = 0;
};

class DualActiveSet {
 public:
  DualActiveSet(const Polyhedron& polyhedron, const Eigen::VectorXd& x) : x_(x) {
    inequality_scale_ = polyhedron.inequalities.rowwise().norm();
    equality_scale_ = polyhedron.equalities.rowwise().norm();
    inequalities_ = inequality_scale_.cwiseInverse().asDiagonal() * polyhedron.inequalities;
    bounds_ = polyhedron.bounds.cwiseQuotient(inequality_scale_);
    equalities_ = equality_scale_.cwiseInverse().asDiagonal() * polyhedron.equalities;
    values_ = polyhedron.values.cwiseQuotient(equality_scale_);
  }

  absl::StatusOr<Projection> Run() {
    for (Eigen::Index row = 0; row < equalities_.rows(); ++row) {
      const double excess = equalities_.row(row).dot(x_) - values_[row];
      // Normals point to where the constraint holds.
      Active equality{static_cast<int>(row), true, excess > 0 ? -1.0 : 1.0, 0};
      MORTISE_ASSIGN_OR_RETURN(const bool taken_up, TakeUp(equality));
      if (!taken_up) return Conflict();
    }
    while (true) {
      Eigen::Index worst = 0;
      if (inequalities_.rows() == 0 ||
          (inequalities_ * x_ - bounds_).maxCoeff(&worst) <= kTolerance) {
        return Found();
      }
      MORTISE_ASSIGN_OR_RETURN(const bool taken_up,
                               TakeUp({static_cast<int>(worst), false, -1, 0}));
      if (!taken_up) return Conflict();
    }
  }

 private:
  Eigen::VectorXd Normal(const Active& active) const {
    const auto& rows = active.is_equality ? equalities_ : inequalities_;
    return active.sign * rows.row(active.row).transpose();
  }

  // How far x is on the wrong side; 0 or negative.
  double Excess(const Active& active) const {
    const double bound = active.is_equality ? values_[active.row] : bounds_[active.row];
    return Normal(active).dot(x_) - active.sign * bound;
  }

  // Moves x onto a constraint that it breaks, while all active ones go on holding; those that would
  // pull instead of push are let go. False if that cannot be: `conflict_` then has the reason.
  absl::StatusOr<bool> TakeUp(Active added) {
    const Eigen::VectorXd normal = Normal(added);
    while (true) {
      if (++steps_ > 50 * (inequalities_.rows() + equalities_.rows() + x_.size() + 10)) {
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
        Add(added, normal);
        return true;
      }
      Remove(dual.blocking);
    }
  }

  DualStep LongestDualStep(const Eigen::VectorXd& shares) const {
    DualStep step;
    for (std::size_t i = 0; i < active_.size(); ++i) {
      const double share = shares[static_cast<Eigen::Index>(i)];
      if (active_[i].is_equality || share <= kTolerance) continue;
      const double length = std::max(active_[i].multiplier, 0.0) / share;
      if (length < step.length) step = {length, static_cast<Eigen::Index>(i)};
    }
    return step;
  }

  void Add(const Active& active, const Eigen::VectorXd& normal) {
    active_.push_back(active);
    normals_.Add(normal);
  }

  void Remove(Eigen::Index index) {
    active_.erase(active_.begin() + index);
    normals_.Remove(index);
  }

  void NoteConflict(const Active& added, const Eigen::VectorXd& shares) {
    conflict_ = {added};
    for (std::size_t i = 0; i < active_.size(); ++i) {
      if (std::abs(shares[static_cast<Eigen::Index>(i)]) > kDependent) {
        conflict_.push_back(active_[i]);
      }
    }
  }

  static void Report(const std::vector<Active>& constraints, Projection& projection) {
    for (const Active& constraint : constraints) {
      (constraint.is_equality ? projection.equalities : projection.inequalities)
          .push_back(constraint.row);
    }
    std::sort(projection.inequalities.begin(), projection.inequalities.end());
    std::sort(projection.equalities.begin(), projection.equalities.end());
  }

  Projection Found() const {
    Projection projection;
    projection.point = x_;
    Report(active_, projection);
    return projection;
  }

  Projection Conflict() const {
    Projection projection;
    Report(conflict_, projection);
    return projection;
  }

  Eigen::VectorXd x_;
  Eigen::VectorXd inequality_scale_, equality_scale_;
  Eigen::MatrixXd inequalities_, equalities_;  // rows of unit length
  Eigen::VectorXd bounds_, values_;
  std::vector<Active> active_;
  IndependentVectors normals_{x_.size()};  // of active_
  std::vector<Active> conflict_;
  Eigen::Index steps_ = 0;
};

absl::Status Check(const Polyhedron& polyhedron, const Eigen::VectorXd& x) {
  const auto fits = [&](const Eigen::MatrixXd& rows, const Eigen::VectorXd& ends) {
    return rows.rows() == ends.size() && (rows.rows() == 0 || rows.cols() == x.size());
  };
  if (!fits(polyhedron.inequalities, polyhedron.bounds) ||
      !fits(polyhedron.equalities, polyhedron.values)) {
    return InvalidField("polyhedron", "its sizes do not agree");
  }
  const bool is_finite = polyhedron.inequalities.allFinite() && polyhedron.bounds.allFinite() &&
                         polyhedron.equalities.allFinite() && polyhedron.values.allFinite();
  if (!is_finite || !x.allFinite()) return InvalidField("polyhedron", "must be finite");
  const auto has_zero_row = [](const Eigen::MatrixXd& rows) {
    return rows.rows() > 0 && rows.rowwise().norm().minCoeff() == 0;
  };
  if (has_zero_row(polyhedron.inequalities) || has_zero_row(polyhedron.equalities)) {
    return InvalidField("polyhedron", "has a row of zeros");
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Projection> ProjectOnto(const Polyhedron& polyhedron, const Eigen::VectorXd& x) {
  MORTISE_RETURN_IF_ERROR(Check(polyhedron, x));
  Projection projection;
  projection.point = x;
  for (const PolyhedronFactor& factor : FactorsOf(polyhedron)) {
    if (factor.inequalities.empty() && factor.equalities.empty()) continue;
    MORTISE_ASSIGN_OR_RETURN(
        const Projection part,
        DualActiveSet(PolyhedronOf(polyhedron, factor), EntriesOf(x, factor)).Run());
    if (!part.point) projection = Projection{};
    for (const int row : part.inequalities) {
      projection.inequalities.push_back(factor.inequalities[static_cast<std::size_t>(row)]);
    }
    for (const int row : part.equalities) {
      projection.equalities.push_back(factor.equalities[static_cast<std::size_t>(row)]);
    }
    if (!part.point) return projection;
    SetEntries(*part.point, factor, *projection.point);
  }
  std::sort(projection.inequalities.begin(), projection.inequalities.end());
  std::sort(projection.equalities.begin(), projection.equalities.end());
  return projection;
}

absl::StatusOr<Furthest> FurthestAlong(const Polyhedron& polyhedron,
                                       const Eigen::VectorXd& direction,
                                       const Eigen::VectorXd& from) {
  constexpr double kNoGain = 1e-11;
  constexpr double kFar = 1e9;  // steps that long meet no end
  MORTISE_ASSIGN_OR_RETURN(Projection at, ProjectOnto(polyhedron, from));
  const double length = direction.norm();
  if (!at.point || length == 0) return Furthest{at.point, at.inequalities, at.equalities};
  const Eigen::VectorXd unit = direction / length;
  for (double step = 1; step < kFar; step *= 4) {
    MORTISE_ASSIGN_OR_RETURN(Projection next, ProjectOnto(polyhedron, *at.point + step * unit));
    if (!next.point) return absl::InternalError("a polyhedron lost its points");
    const double gain = unit.dot(*next.point - *at.point);
    at = std::move(next);
    if (gain <= kNoGain) return Furthest{at.point, {}, {}};
  }
  return Furthest{};
}

// Of the cone of such directions, what lies in a box about 0: it has a corner other than 0 unless
// it is 0 alone, and what grows along neither a random direction nor against it is 0.
absl::StatusOr<std::optional<Eigen::VectorXd>> UnboundedDirection(
    const Eigen::MatrixXd& inequalities) {
  if (inequalities.cols() == 0) return std::optional<Eigen::VectorXd>();
  MORTISE_ASSIGN_OR_RETURN(
      LinearProgramme cone,
      LinearProgramme::Create(inequalities, Eigen::VectorXd::Zero(inequalities.rows()), 1));
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Eigen::VectorXd direction(inequalities.cols());
  for (double& component : direction) component = normal(random);
  for (const double sign : {1.0, -1.0}) {
    MORTISE_ASSIGN_OR_RETURN(const auto corner, cone.Furthest(sign * direction));
    // A corner is 0 but for rounding, or reaches the box.
    if (corner && corner->lpNorm<Eigen::Infinity>() > 0.5) {
      return std::optional<Eigen::VectorXd>(corner->normalized());
    }
  }
  return std::optional<Eigen::VectorXd>();
}

}  // namespace mortise::parametric
