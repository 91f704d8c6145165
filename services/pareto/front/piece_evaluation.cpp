// Segments and triangles of design space, cut in two where performance changes most.
#include "services/pareto/front/piece_evaluation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <set>
#include <utility>

#include "services/pareto/front/front_labeling.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// How much of performance a step through design space counts for at least, so that stretches whose
// ends happen to perform alike are cut as well.
constexpr double kDesignWeight = 0.02;
constexpr double kOnSubspace = 1e-6;  // unit coordinates

// The designs of a segment (two) or a triangle (three), in unit coordinates.
using Element = std::vector<VectorXd>;

// The points of a piece, in the order of the front, beside its subspace.
struct PiecePoints {
  MatrixXd u;           // D x n, unit coordinates
  MatrixXd embedding;   // d - 1 x n
  VectorXd centre;      // D, unit coordinates
  MatrixXd directions;  // D x k, orthonormal
  MatrixXd t;           // k x n
  VectorXd offset;      // n, distances from the subspace
};

VectorXd UnitRange(const DesignSpace& space) {
  // A fixed parameter has no range; nor does any piece move along it.
  return (space.upper - space.lower).unaryExpr([](double range) { return range > 0 ? range : 1; });
}

PiecePoints PointsOf(const DesignSpace& space, const Front& front, std::size_t piece) {
  std::vector<const FrontPoint*> points;
  for (const FrontPoint& point : front.points) {
    if (point.piece == static_cast<int>(piece)) points.push_back(&point);
  }
  const auto count = static_cast<Index>(points.size());
  PiecePoints of;
  of.u.resize(space.size(), count);
  of.embedding.resize(points.empty() ? 0 : points.front()->embedding.size(), count);
  for (Index i = 0; i < count; ++i) {
    of.u.col(i) = space.ToUnit(points[static_cast<std::size_t>(i)]->x);
    of.embedding.col(i) = points[static_cast<std::size_t>(i)]->embedding;
  }
  of.centre = space.ToUnit(front.pieces[piece].origin);
  of.directions = UnitRange(space).cwiseInverse().asDiagonal() * front.pieces[piece].directions;
  const MatrixXd away = of.u.colwise() - of.centre;
  of.t = of.directions.transpose() * away;
  of.offset = (away - of.directions * of.t).colwise().norm();
  return of;
}

// From the least t to the most, and once more the neighbouring distance beyond.
void AddLine(const PiecePoints& points, const std::vector<Index>& on, std::vector<Element>& to) {
  std::set<double> values;
  for (const Index i : on) values.insert(points.t(0, i));
  if (values.size() < 2) return;
  values.insert(2 * *values.begin() - *std::next(values.begin()));
  values.insert(2 * *values.rbegin() - *std::next(values.rbegin()));
  const auto at = [&](double t) -> VectorXd { return points.centre + t * points.directions; };
  for (auto t = values.begin(); std::next(t) != values.end(); ++t) {
    to.push_back({at(*t), at(*std::next(t))});
  }
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// The corners of the convex hull, counter-clockwise (Andrew 1979).
std::vector<Eigen::Vector2d> Hull(std::vector<Eigen::Vector2d> points) {
  std::ranges::sort(points, {}, [](const auto& p) { return std::pair(p[0], p[1]); });
  std::vector<Eigen::Vector2d> hull;
  const auto add = [&](const Eigen::Vector2d& point, std::size_t least) {
    while (hull.size() > least && Cross(hull[hull.size() - 2], hull.back(), point) <= 0) {
      hull.pop_back();
    }
    hull.push_back(point);
  };
  for (const auto& point : points) add(point, 1);
  const std::size_t lower = hull.size();
  for (std::size_t i = points.size(); i-- > 1;) add(points[i - 1], lower);
  hull.pop_back();
  return hull;
}

// Triangles from the middle of the hull to its sides.
void AddHull(const PiecePoints& points, const std::vector<Index>& on, std::vector<Element>& to) {
  std::vector<Eigen::Vector2d> found;
  for (const Index i : on) found.emplace_back(points.t.col(i));
  if (found.size() < 3) return;
  std::vector<Eigen::Vector2d> hull = Hull(found);
  if (hull.size() < 3) return;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const auto& corner : hull) middle += corner / static_cast<double>(hull.size());
  double area = 0;
  for (std::size_t i = 0; i < hull.size(); ++i) {
    area += Cross(middle, hull[i], hull[(i + 1) % hull.size()]) / 2;
  }
  const double beyond = std::sqrt(area / static_cast<double>(found.size()));
  for (auto& corner : hull) corner += beyond * (corner - middle).normalized();
  const auto at = [&](const Eigen::Vector2d& t) -> VectorXd {
    return points.centre + points.directions * t;
  };
  for (std::size_t i = 0; i < hull.size(); ++i) {
    to.push_back({at(middle), at(hull[i]), at(hull[(i + 1) % hull.size()])});
  }
}

// What lies straight between neighbours that are not both on the subspace.
void AddBetween(const PiecePoints& points, std::vector<Element>& to) {
  const auto is_off = [&](Index i) {
    return points.directions.cols() == 0 || points.offset[i] > kOnSubspace;
  };
  if (points.embedding.rows() == 1) {
    for (Index i = 0; i + 1 < points.u.cols(); ++i) {
      if (is_off(i) || is_off(i + 1)) to.push_back({points.u.col(i), points.u.col(i + 1)});
    }
    return;
  }
  if (points.directions.cols() > 0 && points.offset.maxCoeff() <= kOnSubspace) return;
  std::vector<std::set<Index>> after(static_cast<std::size_t>(points.u.cols()));
  for (const auto& [i, k] : NeighboursAlong(points.embedding)) {
    after[static_cast<std::size_t>(i)].insert(k);
  }
  for (Index i = 0; i < points.u.cols(); ++i) {
    const std::set<Index>& of_i = after[static_cast<std::size_t>(i)];
    for (const Index j : of_i) {
      for (const Index k : after[static_cast<std::size_t>(j)]) {
        if (of_i.contains(k) && (is_off(i) || is_off(j) || is_off(k))) {
          to.push_back({points.u.col(i), points.u.col(j), points.u.col(k)});
        }
      }
    }
  }
}

std::vector<Element> ElementsOf(const PiecePoints& points, double tolerance) {
  std::vector<Element> elements;
  std::vector<Index> on;
  for (Index i = 0; i < points.u.cols(); ++i) {
    if (points.offset[i] <= tolerance) on.push_back(i);
  }
  if (points.directions.cols() == 1) AddLine(points, on, elements);
  if (points.directions.cols() == 2) AddHull(points, on, elements);
  AddBetween(points, elements);
  return elements;
}

// Evaluates the corners of elements, and cuts elements in two.
class Refinement {
 public:
  Refinement(const DesignSpace& space, const Front& front,
             const std::function<Evaluation(const VectorXd&)>& evaluate,
             const PieceEvaluationOptions& options)
      : space_(space), scaling_(front.scaling), evaluate_(evaluate), options_(options) {
    for (const FrontPoint& point : front.points) {
      result_.metrics.push_back(point.metrics);
      front_.push_back(scaling_.Apply(point.metrics));
    }
  }

  void Add(const Element& element) {
    Cut cut;
    for (const VectorXd& u : element) {
      const auto [known, is_new] = shared_.try_emplace(std::vector<double>(u.begin(), u.end()), 0);
      if (is_new) known->second = CornerAt(u);
      cut.corners.push_back(known->second);
    }
    Offer(std::move(cut));
  }

  PieceEvaluation Run() {
    while (!queue_.empty() && result_.evaluations < options_.designs) {
      const Cut cut = queue_.top();
      queue_.pop();
      const std::size_t a = cut.corners[cut.first], b = cut.corners[cut.second];
      const auto [known, is_new] = middles_.try_emplace(std::minmax(a, b), 0);
      if (is_new) known->second = CornerAt(0.5 * (corners_[a].u + corners_[b].u));
      for (const std::size_t replaced : {cut.first, cut.second}) {
        Cut half = cut;
        half.corners[replaced] = known->second;
        Offer(std::move(half));
      }
    }
    return std::move(result_);
  }

 private:
  struct Corner {
    VectorXd u;
    VectorXd performance;  // scaled; empty where the evaluation failed
  };

  // An element with its longest edge.
  struct Cut {
    std::vector<std::size_t> corners;
    std::size_t first = 0, second = 0;  // positions in `corners`
    double length = 0;

    bool operator<(const Cut& other) const { return length < other.length; }
  };

  std::size_t CornerAt(const VectorXd& u) {
    const Evaluation evaluation = evaluate_(space_.FromUnit(u));
    ++result_.evaluations;
    Corner& corner = corners_.emplace_back(Corner{u, {}});
    if (evaluation.status == EvaluationStatus::kEvaluated && evaluation.metrics.allFinite()) {
      corner.performance = scaling_.Apply(evaluation.metrics);
      if ((evaluation.constraints.array() <= 0).all()) {
        result_.metrics.push_back(evaluation.metrics);
      }
    }
    return corners_.size() - 1;
  }

  void Offer(Cut cut) {
    cut.length = 0;
    for (std::size_t i = 0; i < cut.corners.size(); ++i) {
      for (std::size_t k = i + 1; k < cut.corners.size(); ++k) {
        const Corner& a = corners_[cut.corners[i]];
        const Corner& b = corners_[cut.corners[k]];
        if (a.performance.size() == 0 || b.performance.size() == 0) return;
        const double length =
            std::max((a.performance - b.performance).norm(), kDesignWeight * (a.u - b.u).norm());
        if (length <= cut.length) continue;
        cut.length = length;
        cut.first = i;
        cut.second = k;
      }
    }
    if (cut.length > options_.spacing && !PlainlyDominated(cut)) queue_.push(std::move(cut));
  }

  // Whether a point of the front is better than anything that performs much like the corners.
  bool PlainlyDominated(const Cut& cut) const {
    VectorXd best = corners_[cut.corners.front()].performance;
    for (const std::size_t i : cut.corners) best = best.cwiseMin(corners_[i].performance).eval();
    best.array() -= cut.length;
    return std::ranges::any_of(
        front_, [&](const VectorXd& point) { return (point.array() <= best.array()).all(); });
  }

  const DesignSpace& space_;
  const Scaling& scaling_;
  const std::function<Evaluation(const VectorXd&)>& evaluate_;
  PieceEvaluationOptions options_;
  PieceEvaluation result_;
  std::vector<VectorXd> front_;  // scaled performance of its points
  std::vector<Corner> corners_;
  std::map<std::vector<double>, std::size_t> shared_;  // corners of elements added, by design
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> middles_;
  std::priority_queue<Cut> queue_;
};

}  // namespace

PieceEvaluation EvaluatePieces(const DesignSpace& space, const Front& front,
                               const std::function<Evaluation(const VectorXd&)>& evaluate,
                               const PieceEvaluationOptions& options) {
  Refinement refinement(space, front, evaluate, options);
  for (std::size_t piece = 0; piece < front.pieces.size(); ++piece) {
    for (const Element& element : ElementsOf(PointsOf(space, front, piece), options.tolerance)) {
      refinement.Add(element);
    }
  }
  return refinement.Run();
}

}  // namespace mortise::pareto
