#include "common/assembly/polyhedra/polyhedron_extents.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "common/assembly/polyhedra/linear_programme.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

constexpr double kParallel = 1e-9;  // between unit rows
constexpr double kReached = 1e-9;   // of a unit row's distance: what linear programmes hold to
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// For each row the one that stands for all that are parallel to it. Parallel unit rows lie in the
// same place along any line, so that only neighbours on one are compared.
std::vector<int> Representatives(const Eigen::MatrixXd& unit_rows) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  Eigen::VectorXd line(unit_rows.cols());
  for (double& component : line) component = normal(random);
  const Eigen::VectorXd places = unit_rows * line.normalized();
  std::vector<int> order(static_cast<std::size_t>(unit_rows.rows()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return places[a] < places[b]; });
  std::vector<int> representatives(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    int& representative = representatives[static_cast<std::size_t>(order[i])];
    representative = order[i];
    for (std::size_t k = i; k-- > 0 && places[order[i]] - places[order[k]] <= kParallel;) {
      if (representatives[static_cast<std::size_t>(order[k])] != order[k]) continue;
      if ((unit_rows.row(order[i]) - unit_rows.row(order[k])).norm() > kParallel) continue;
      representative = order[k];
      break;
    }
  }
  return representatives;
}

// Directions of which none are parallel, and what is known of how far the polyhedron goes.
class ExtentSearch {
 public:
  ExtentSearch(LinearProgramme& programme, Eigen::MatrixXd directions, Eigen::VectorXd limits)
      : programme_(programme),
        directions_(std::move(directions)),
        limits_(std::move(limits)),
        values_(static_cast<std::size_t>(limits_.size())) {}

  absl::StatusOr<Eigen::VectorXd> Run() {
    MORTISE_RETURN_IF_ERROR(ReachLimitsTogether());
    for (Eigen::Index i = 0; i < directions_.rows(); ++i) {
      if (!IsOpen(i)) continue;
      MORTISE_ASSIGN_OR_RETURN(const auto furthest,
                               programme_.Furthest(directions_.row(i).transpose()));
      if (furthest) SettleReached(*furthest);
      if (!IsOpen(i)) continue;
      values_[static_cast<std::size_t>(i)] =
          furthest ? directions_.row(i).dot(*furthest) : kInfinity;
    }
    Eigen::VectorXd values(directions_.rows());
    for (Eigen::Index i = 0; i < values.size(); ++i) {
      values[i] = *values_[static_cast<std::size_t>(i)];
    }
    return values;
  }

 private:
  bool IsOpen(Eigen::Index i) const { return !values_[static_cast<std::size_t>(i)].has_value(); }

  // Until a corner that is as far as can be along all limits not yet reached reaches none of them.
  absl::Status ReachLimitsTogether() {
    while (true) {
      Eigen::VectorXd together = Eigen::VectorXd::Zero(directions_.cols());
      for (Eigen::Index i = 0; i < directions_.rows(); ++i) {
        if (IsOpen(i) && limits_[i] < kInfinity) together += directions_.row(i).transpose();
      }
      if (together.isZero(0)) return absl::OkStatus();
      MORTISE_ASSIGN_OR_RETURN(const auto furthest, programme_.Furthest(together));
      if (!furthest || !SettleReached(*furthest)) return absl::OkStatus();
    }
  }

  // Whether there were any.
  bool SettleReached(const Eigen::VectorXd& point) {
    const Eigen::VectorXd reached = directions_ * point;
    bool any = false;
    for (Eigen::Index i = 0; i < reached.size(); ++i) {
      if (!IsOpen(i) || !(reached[i] >= limits_[i] - kReached)) continue;
      values_[static_cast<std::size_t>(i)] = limits_[i];
      any = true;
    }
    return any;
  }

  LinearProgramme& programme_;
  Eigen::MatrixXd directions_;  // unit rows
  Eigen::VectorXd limits_;      // none: infinite
  std::vector<std::optional<double>> values_;
};

// How far the polyhedron goes along each direction, a unit row; so are the inequalities.
absl::StatusOr<Eigen::VectorXd> Furthest(LinearProgramme& programme,
                                         const Eigen::MatrixXd& inequalities,
                                         const Eigen::VectorXd& bounds,
                                         const Eigen::MatrixXd& directions) {
  const Eigen::Index limits = inequalities.rows();
  Eigen::MatrixXd rows(limits + directions.rows(), inequalities.cols());
  rows << inequalities, directions;
  const std::vector<int> representatives = Representatives(rows);
  Eigen::VectorXd limit = Eigen::VectorXd::Constant(rows.rows(), kInfinity);
  for (Eigen::Index i = 0; i < limits; ++i) {
    double& tightest = limit[representatives[static_cast<std::size_t>(i)]];
    tightest = std::min(tightest, bounds[i]);
  }
  const std::vector<int> asked(representatives.begin() + limits, representatives.end());
  const std::set<int> once(asked.begin(), asked.end());
  const std::vector<int> order(once.begin(), once.end());
  ExtentSearch search(programme, rows(order, Eigen::all), limit(order));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd found, search.Run());
  Eigen::VectorXd values(directions.rows());
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const auto place = std::lower_bound(order.begin(), order.end(), asked[i]) - order.begin();
    values[static_cast<Eigen::Index>(i)] = found[place];
  }
  return values;
}

}  // namespace

absl::StatusOr<Extents> ExtentsAlong(const Eigen::MatrixXd& inequalities,
                                     const Eigen::VectorXd& bounds,
                                     const Eigen::MatrixXd& directions) {
  MORTISE_ASSIGN_OR_RETURN(LinearProgramme programme,
                           LinearProgramme::Create(inequalities, bounds));
  const Eigen::VectorXd lengths = directions.rowwise().norm();
  if (directions.cols() != inequalities.cols() || !directions.allFinite() ||
      (lengths.array() == 0).any()) {
    return InvalidField("directions", "must be finite rows as long as inequalities, none zero");
  }
  const Eigen::VectorXd scales = inequalities.rowwise().norm();
  const Eigen::MatrixXd limits = inequalities.array().colwise() / scales.array();
  const Eigen::VectorXd distances = bounds.cwiseQuotient(scales);
  const Eigen::MatrixXd ahead = directions.array().colwise() / lengths.array();
  MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd to, Furthest(programme, limits, distances, ahead));
  MORTISE_ASSIGN_OR_RETURN(const Eigen::VectorXd fro,
                           Furthest(programme, limits, distances, -ahead));
  return Extents{-fro.cwiseProduct(lengths), to.cwiseProduct(lengths)};
}

}  // namespace mortise::parametric
