#include "common/parametric/hit_and_run.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "common/base/errors.h"
#include "common/parametric/polyhedron.h"

namespace mortise::parametric {
namespace {

// Of the longest extent: no room at all. Not less, or the rounding of a covariance would look like
// room.
constexpr double kFlat = 1e-7;
constexpr double kParallel = 1e-11;  // between unit vectors: only rounding tells them apart
constexpr int kRoundings = 2;

// Where a line through the polyhedron leaves it.
struct Chord {
  double from = -std::numeric_limits<double>::infinity();
  double to = std::numeric_limits<double>::infinity();
};

// What is left of inequalities of unit length, and how fast the direction uses it up.
Chord ChordOf(const Eigen::VectorXd& left, const Eigen::VectorXd& rate) {
  Chord chord;
  for (Eigen::Index i = 0; i < left.size(); ++i) {
    if (rate[i] > kParallel) {
      chord.to = std::min(chord.to, std::max(left[i], 0.0) / rate[i]);
    } else if (rate[i] < -kParallel) {
      chord.from = std::max(chord.from, std::max(left[i], 0.0) / rate[i]);
    }
  }
  return chord;
}

// Columns whose combinations with standard normal weights are spread as the points are, directions
// without room left out.
Eigen::MatrixXd SpreadOf(const Eigen::MatrixXd& points) {
  const Eigen::MatrixXd centered = points.colwise() - points.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(centered * centered.transpose() /
                                                              static_cast<double>(points.cols()));
  const Eigen::VectorXd lengths = solver.eigenvalues().cwiseMax(0).cwiseSqrt();
  Eigen::Index flat = 0;
  while (flat < lengths.size() && lengths[flat] <= kFlat * lengths[lengths.size() - 1]) ++flat;
  const Eigen::Index wide = lengths.size() - flat;
  return solver.eigenvectors().rightCols(wide) * lengths.tail(wide).asDiagonal();
}

class Walk {
 public:
  Walk(const Eigen::MatrixXd& inequalities, const Eigen::VectorXd& bounds, std::uint64_t seed)
      : inequalities_(inequalities.rowwise().normalized()),
        bounds_(bounds.array() / inequalities.rowwise().norm().array()),
        random_(seed) {}

  void Begin(const Eigen::VectorXd& start) {
    x_ = start;
    left_ = bounds_ - inequalities_ * x_;
  }

  void SetSpread(Eigen::MatrixXd spread) { spread_ = std::move(spread); }

  const Eigen::VectorXd& at() const { return x_; }

  void Step() {
    if (spread_.cols() == 0) return;  // a single point
    Eigen::VectorXd weights(spread_.cols());
    for (double& weight : weights) weight = normal_(random_);
    const Eigen::VectorXd direction = (spread_ * weights).normalized();
    const Eigen::VectorXd rate = inequalities_ * direction;
    const Chord chord = ChordOf(left_, rate);
    const double length = chord.from + uniform_(random_) * (chord.to - chord.from);
    x_ += length * direction;
    left_ -= length * rate;
  }

  // Rounding adds up; now and then it must go.
  void Refresh() { left_ = bounds_ - inequalities_ * x_; }

 private:
  const Eigen::MatrixXd inequalities_;  // rows of unit length
  const Eigen::VectorXd bounds_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> uniform_;
  Eigen::MatrixXd spread_;
  Eigen::VectorXd x_;
  Eigen::VectorXd left_;  // bounds - inequalities · x
};

// The furthest points along every axis, both ways.
absl::StatusOr<Eigen::MatrixXd> EndsOf(const Polyhedron& polyhedron, const Eigen::VectorXd& start) {
  const Eigen::Index variables = start.size();
  Eigen::MatrixXd ends(variables, 2 * variables);
  for (Eigen::Index i = 0; i < 2 * variables; ++i) {
    const Eigen::VectorXd axis = (i % 2 == 0 ? 1 : -1) * Eigen::VectorXd::Unit(variables, i / 2);
    MORTISE_ASSIGN_OR_RETURN(const Furthest end, FurthestAlong(polyhedron, axis, start));
    if (!end.point) {
      return PreconditionFailed("POLYHEDRON_UNBOUNDED", "the polyhedron goes on without end");
    }
    ends.col(i) = *end.point;
  }
  return ends;
}

}  // namespace

absl::StatusOr<std::vector<Eigen::VectorXd>> SamplePolyhedron(const Eigen::MatrixXd& inequalities,
                                                              const Eigen::VectorXd& bounds,
                                                              const Eigen::VectorXd& start,
                                                              int count, std::uint64_t seed) {
  const Eigen::Index variables = start.size();
  if (variables == 0) {
    return std::vector<Eigen::VectorXd>(static_cast<std::size_t>(count), start);
  }
  const Polyhedron polyhedron{inequalities, bounds, Eigen::MatrixXd(0, variables),
                              Eigen::VectorXd(0)};
  MORTISE_ASSIGN_OR_RETURN(const Eigen::MatrixXd ends, EndsOf(polyhedron, start));
  Walk walk(inequalities, bounds, seed);
  walk.Begin(ends.rowwise().mean());
  walk.SetSpread(SpreadOf(ends));
  for (int rounding = 0; rounding < kRoundings; ++rounding) {
    Eigen::MatrixXd path(variables, 64 * variables);
    for (Eigen::Index step = 0; step < path.cols(); ++step) {
      walk.Step();
      path.col(step) = walk.at();
    }
    walk.Refresh();
    walk.SetSpread(SpreadOf(path));
  }
  std::vector<Eigen::VectorXd> samples;
  for (int i = 0; i < count; ++i) {
    for (Eigen::Index step = 0; step < 4 * variables + 8; ++step) walk.Step();
    walk.Refresh();
    samples.push_back(walk.at());
  }
  return samples;
}

}  // namespace mortise::parametric
