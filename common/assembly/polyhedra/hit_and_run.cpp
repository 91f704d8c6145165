#include "common/assembly/polyhedra/hit_and_run.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "common/assembly/polyhedra/linear_programme.h"
#include "common/assembly/polyhedra/polyhedron.h"
#include "common/assembly/polyhedra/polyhedron_factors.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

// Of the longest extent: no room at all. Not less, or the rounding of a covariance would look like
// room.
constexpr double kFlat = 1e-7;
constexpr double kParallel = 1e-11;  // between unit vectors: only rounding tells them apart
constexpr double kTouching = 1e-15;  // of an inequality's room: none
constexpr int kRoundings = 2;

// For a covariance: more points than variables, and enough where those are few.
Eigen::Index SweepsToRound(Eigen::Index variables) { return 64 + 2 * variables; }

// Between two samples, until the second no longer tells of the first. Of a box that lies anyhow
// among n directions a line leads about 1/√n of the way, so a walk through it takes n sweeps at
// worst.
int SweepsBetween(Eigen::Index variables) { return 8 + static_cast<int>(variables / 2); }

// The directions along which points are spread by themselves, as unit columns; those without room
// are left out, where the points' deviation is at most `flat`.
Eigen::MatrixXd PrincipalAxes(const Eigen::MatrixXd& points, double flat) {
  const Eigen::MatrixXd centered = points.colwise() - points.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centered * centered.transpose() /
                                                              static_cast<double>(points.cols()));
  const Eigen::VectorXd lengths = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  Eigen::Index narrow = 0;
  while (narrow < lengths.size() && lengths[narrow] <= flat) ++narrow;
  return solver.eigenvectors().rightCols(lengths.size() - narrow);
}

class Walk {
 public:
  Walk(const Polyhedron& polyhedron, const Eigen::VectorXd& start, std::uint64_t seed)
      : inequalities_(polyhedron.inequalities.rowwise().normalized()),
        bounds_(polyhedron.bounds.cwiseQuotient(polyhedron.inequalities.rowwise().norm())),
        random_(seed),
        x_(start) {
    Refresh();
  }

  // Unit columns.
  void SetDirections(Eigen::MatrixXd directions) {
    directions_ = std::move(directions);
    rates_ = inequalities_ * directions_;
    rates_ = (rates_.array().abs() <= kParallel).select(0, rates_);
  }

  const Eigen::VectorXd& at() const { return x_; }

  // Along each direction once, in random order; all together cost as much as one line that lies
  // anyhow. Rounding adds up in what is left of the inequalities, so it is computed anew.
  void Sweep() {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(directions_.cols()));
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), random_);
    for (const Eigen::Index direction : order) {
      // Each inequality ends the line where its room is used up; the first to do so has the
      // largest share of room used up for each metre.
      used_up_ = rates_.col(direction).cwiseQuotient(left_);
      const double to = 1 / used_up_.maxCoeff();
      const double from = 1 / used_up_.minCoeff();
      if (!std::isfinite(to) || !std::isfinite(from)) continue;  // rounding hides its ends
      const double length = from + uniform_(random_) * (to - from);
      x_ += length * directions_.col(direction);
      left_ = (left_ - length * rates_.col(direction)).cwiseMax(kTouching);
    }
    Refresh();
  }

 private:
  void Refresh() { left_ = (bounds_ - inequalities_ * x_).cwiseMax(kTouching); }

  const Eigen::MatrixXd inequalities_;  // rows of unit length
  const Eigen::VectorXd bounds_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> uniform_;
  Eigen::MatrixXd directions_;
  Eigen::MatrixXd rates_;  // inequalities_ · directions_
  Eigen::VectorXd x_;
  Eigen::VectorXd left_;  // bounds_ - inequalities_ · x
  Eigen::VectorXd used_up_;
};

double LongestExtent(const Eigen::MatrixXd& points) {
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
}

// The furthest points along each of the directions, both ways.
absl::StatusOr<Eigen::MatrixXd> EndsAlong(const Eigen::MatrixXd& directions,
                                          LinearProgramme& programme) {
  Eigen::MatrixXd ends(directions.rows(), 2 * directions.cols());
  for (Eigen::Index i = 0; i < ends.cols(); ++i) {
    MORTISE_ASSIGN_OR_RETURN(const auto end,
                             programme.Furthest((i % 2 == 0 ? 1 : -1) * directions.col(i / 2)));
    if (!end) {
      return PreconditionFailed("POLYHEDRON_UNBOUNDED", "the polyhedron goes on without end");
    }
    ends.col(i) = *end;
  }
  return ends;
}

// The directions in which points do not differ, as orthonormal columns.
Eigen::MatrixXd LevelDirections(const Eigen::MatrixXd& points, double flat) {
  const Eigen::MatrixXd spread = PrincipalAxes(points, flat);
  if (spread.cols() == 0) return Eigen::MatrixXd::Identity(points.rows(), points.rows());
  const Eigen::HouseholderQR<Eigen::MatrixXd> decomposition(spread);
  const Eigen::MatrixXd all = decomposition.householderQ();
  return all.rightCols(points.rows() - spread.cols());
}

// Points of the polyhedron that differ in as many directions as it has room in: the furthest along
// every axis, which may all lie in one plane across it, then the furthest out of what they span,
// until nothing is out of it.
absl::StatusOr<Eigen::MatrixXd> EndsOf(const Polyhedron& polyhedron) {
  const Eigen::Index variables = polyhedron.inequalities.cols();
  MORTISE_ASSIGN_OR_RETURN(LinearProgramme programme,
                           LinearProgramme::Create(polyhedron.inequalities, polyhedron.bounds));
  MORTISE_ASSIGN_OR_RETURN(Eigen::MatrixXd ends,
                           EndsAlong(Eigen::MatrixXd::Identity(variables, variables), programme));
  const double flat = kFlat * LongestExtent(ends);
  while (true) {
    const Eigen::MatrixXd level = LevelDirections(ends, flat);
    if (level.cols() == 0) return ends;
    MORTISE_ASSIGN_OR_RETURN(const Eigen::MatrixXd out, EndsAlong(level, programme));
    Eigen::MatrixXd more(variables, ends.cols() + out.cols());
    more << ends, out;
    ends = std::move(more);
    if (LevelDirections(ends, flat).cols() == level.cols()) return ends;
  }
}

// `count` points of one factor, as columns.
Eigen::MatrixXd SampleFactor(const Polyhedron& factor, const Eigen::MatrixXd& ends, double flat,
                             int count, std::uint64_t seed) {
  const Eigen::Index variables = factor.inequalities.cols();
  Walk walk(factor, ends.rowwise().mean(), seed);
  walk.SetDirections(PrincipalAxes(ends, flat));
  for (int rounding = 0; rounding < kRoundings; ++rounding) {
    Eigen::MatrixXd path(variables, SweepsToRound(variables));
    for (Eigen::Index sweep = 0; sweep < path.cols(); ++sweep) {
      walk.Sweep();
      path.col(sweep) = walk.at();
    }
    walk.SetDirections(PrincipalAxes(path, flat));
  }
  Eigen::MatrixXd samples(variables, count);
  for (int i = 0; i < count; ++i) {
    for (int sweep = 0; sweep < SweepsBetween(variables); ++sweep) walk.Sweep();
    samples.col(i) = walk.at();
  }
  return samples;
}

}  // namespace

absl::StatusOr<std::vector<Eigen::VectorXd>> SamplePolyhedron(const Eigen::MatrixXd& inequalities,
                                                              const Eigen::VectorXd& bounds,
                                                              int count, std::uint64_t seed) {
  const Eigen::Index variables = inequalities.cols();
  std::vector<Eigen::VectorXd> samples(static_cast<std::size_t>(count),
                                       Eigen::VectorXd::Zero(variables));
  const Polyhedron whole{inequalities, bounds, Eigen::MatrixXd(0, variables), Eigen::VectorXd(0)};
  const std::vector<PolyhedronFactor> factors = FactorsOf(whole);
  std::vector<Eigen::MatrixXd> ends;
  double longest = 0;
  for (const PolyhedronFactor& factor : factors) {
    MORTISE_ASSIGN_OR_RETURN(Eigen::MatrixXd of_factor, EndsOf(PolyhedronOf(whole, factor)));
    longest = std::max(longest, LongestExtent(of_factor));
    ends.push_back(std::move(of_factor));
  }
  std::mt19937_64 seeds(seed);
  for (std::size_t f = 0; f < factors.size(); ++f) {
    const Eigen::MatrixXd of_factor =
        SampleFactor(PolyhedronOf(whole, factors[f]), ends[f], kFlat * longest, count, seeds());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      SetEntries(of_factor.col(static_cast<Eigen::Index>(i)), factors[f], samples[i]);
    }
  }
  return samples;
}

}  // namespace mortise::parametric
