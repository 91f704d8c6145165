// Finds nearest points of one polyhedron again and again, while the values of its equalities and
// the points change a little: each search begins with the constraints that held in the last one.
//
// The method is the dual active-set method of Goldfarb and Idnani (1983), of which polyhedron.h
// says why. It needs a point that is nearest among those on some constraints, each of which pushes.
// Of the last search's constraints those stay that still push; the rest are let go, one after the
// other, and what is violated is taken up as from nothing. So the point that is found is the same,
// to the tolerance, however the search began.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "common/assembly/polyhedra/polyhedron.h"

namespace mortise::parametric {

// Linearly independent vectors as Q · R with orthonormal columns of Q, one vector more or less at a
// time: O(n k) for k vectors of n numbers, less for vectors with few that are not 0.
class IndependentVectors {
 public:
  explicit IndependentVectors(Eigen::Index size = 0) : q_(size, 0), r_(0, 0) {}

  // A vector as what lies along the columns of Q, and what is left of it.
  struct Split {
    Eigen::VectorXd along, rest;
  };
  Split SplitOf(const Eigen::VectorXd& vector) const;

  // Splits the same vector again after one of these was removed, and none added since: O(n) where
  // the vector has few entries that are not 0.
  void SplitAgain(const Eigen::VectorXd& vector, Split& split) const;

  // Returns what was split as a combination of the vectors, in least squares.
  Eigen::VectorXd SharesOf(const Split& split) const;

  // Returns the shortest vector whose products with these are `products`, as a combination of them;
  // it is written to `shortest`.
  Eigen::VectorXd SharesOfShortest(const Eigen::VectorXd& products,
                                   Eigen::VectorXd& shortest) const;

  // Adds the vector that was split, and not since then.
  void Add(const Split& split);
  void Remove(Eigen::Index index);

  // Removes all but the first `count`. O(1).
  void KeepFirst(Eigen::Index count) { count_ = count; }

 private:
  void Reserve(Eigen::Index count);

  Eigen::MatrixXd q_, r_;  // of which the first count_ columns are used
  Eigen::Index count_ = 0;
};

// Copies share the rows of the polyhedron.
class NearestPointSearch {
 public:
  // All equalities are held. The polyhedron must be as ProjectOnto wants it.
  explicit NearestPointSearch(const Polyhedron& polyhedron);

  // Holds an equality at a value from now on, or no longer.
  void Hold(int equality, double value);
  void Release(int equality);

  // Returns the point nearest to x that meets the inequalities and the equalities that are held, as
  // ProjectOnto does. It takes O((m + k) n) for each constraint that is taken up or let go, and
  // O(m n) where none is.
  absl::StatusOr<Projection> NearestTo(const Eigen::VectorXd& x);

  // Returns the bytes that the rows take, which copies share.
  std::size_t MemoryUse() const;

 private:
  // A constraint that holds with equality: normal · x = offset, pushed along `normal` by
  // `multiplier`.
  struct Active {
    int row = 0;
    bool is_equality = false;
    double sign = 1;  // of the row in `normal`
    double multiplier = 0;
  };

  // How far one may go until the multiplier of an inequality is used up.
  struct DualStep;

  Eigen::VectorXd Normal(const Active& active) const;
  double Excess(const Active& active) const;
  Active EqualityAt(int row) const;
  bool IsActive(int equality) const;
  absl::StatusOr<bool> TakeUpEqualities();
  absl::StatusOr<bool> TakeUpWhatIsViolated();
  std::optional<Active> ViolatedInequality() const;
  std::optional<Active> ViolatedEquality() const;
  absl::StatusOr<bool> TakeUp(Active added);
  void LetGoOfWhatPulls();
  DualStep LongestDualStep(const Eigen::VectorXd& shares) const;
  void Remove(Eigen::Index index);
  void RemoveAll(const std::vector<bool>& goes);
  void NoteConflict(const Active& added, const Eigen::VectorXd& shares);

  // Rows of unit length, and the same again without what is 0 if that is most of it.
  struct UnitRows {
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> all;
    std::optional<Eigen::SparseMatrix<double, Eigen::RowMajor>> sparse;
    Eigen::VectorXd scale;  // by which each was divided

    explicit UnitRows(const Eigen::MatrixXd& rows);
    Eigen::VectorXd Times(const Eigen::VectorXd& x) const;
  };

  // What never changes.
  struct Rows {
    UnitRows inequalities, equalities;
    Eigen::VectorXd bounds;
  };

  std::shared_ptr<const Rows> rows_;
  Eigen::VectorXd values_;
  std::vector<bool> is_held_;  // by equality
  std::vector<bool> is_new_;   // by equality: held since the last search
  Eigen::VectorXd x_;
  std::vector<Active> active_;
  IndependentVectors normals_;  // of active_
  std::vector<Active> conflict_;
  Eigen::Index steps_ = 0;
};

// Returns the furthest point along a direction of the polyhedron that `project` projects onto, as
// FurthestAlong (polyhedron.h) does.
absl::StatusOr<Furthest> FurthestBy(
    const std::function<absl::StatusOr<Projection>(const Eigen::VectorXd&)>& project,
    const Eigen::VectorXd& direction, const Eigen::VectorXd& from);

}  // namespace mortise::parametric
