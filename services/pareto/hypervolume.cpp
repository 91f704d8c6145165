// Hypervolume by dimension sweep.
#include "services/pareto/hypervolume.h"

#include <algorithm>
#include <map>

namespace mortise::pareto {
namespace {

using Points = std::vector<Eigen::VectorXd>;

double Area(Points points, const Eigen::VectorXd& reference) {
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a[0] != b[0] ? a[0] < b[0] : a[1] < b[1]; });
  double area = 0;
  double top = reference[1];
  for (const auto& p : points) {
    if (p[1] >= top) continue;
    area += (reference[0] - p[0]) * (top - p[1]);
    top = p[1];
  }
  return area;
}

// A staircase of points in the plane that keeps the area it dominates while points are added.
class Staircase {
 public:
  Staircase(double right, double top) : right_(right), top_(top) {}

  void Insert(double a, double b) {
    auto next = steps_.upper_bound(a);
    if (next != steps_.begin() && std::prev(next)->second <= b) return;
    auto first = steps_.lower_bound(a);
    double ceiling = first == steps_.begin() ? top_ : std::prev(first)->second;
    double from = a;
    auto step = first;
    while (step != steps_.end() && step->second >= b) {
      area_ += (step->first - from) * (ceiling - b);
      from = step->first;
      ceiling = step->second;
      step = steps_.erase(step);
    }
    const double to = step == steps_.end() ? right_ : step->first;
    area_ += (to - from) * (ceiling - b);
    steps_[a] = b;
  }

  double area() const { return area_; }

 private:
  double right_, top_;
  double area_ = 0;
  std::map<double, double> steps_;  // first coordinate to second: one rises as the other falls
};

double Volume(Points points, const Eigen::VectorXd& reference) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a[2] < b[2]; });
  Staircase staircase(reference[0], reference[1]);
  double volume = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    staircase.Insert(points[i][0], points[i][1]);
    const double next = i + 1 < points.size() ? points[i + 1][2] : reference[2];
    volume += staircase.area() * (next - points[i][2]);
  }
  return volume;
}

double Measure(Points points, const Eigen::VectorXd& reference) {
  const Eigen::Index d = reference.size();
  if (points.empty() || d == 0) return 0;
  if (d == 1) {
    double best = reference[0];
    for (const auto& p : points) best = std::min(best, p[0]);
    return reference[0] - best;
  }
  if (d == 2) return Area(std::move(points), reference);
  if (d == 3) return Volume(std::move(points), reference);
  std::sort(points.begin(), points.end(),
            [d](const auto& a, const auto& b) { return a[d - 1] < b[d - 1]; });
  Points slab;
  double volume = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    slab.push_back(points[i].head(d - 1));
    const double next = i + 1 < points.size() ? points[i + 1][d - 1] : reference[d - 1];
    const double height = next - points[i][d - 1];
    if (height > 0) volume += height * Measure(slab, reference.head(d - 1));
  }
  return volume;
}

}  // namespace

double Hypervolume(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& reference) {
  Points inside;
  for (const auto& p : points)
    if ((p.array() < reference.array()).all()) inside.push_back(p);
  return Measure(std::move(inside), reference);
}

}  // namespace mortise::pareto
