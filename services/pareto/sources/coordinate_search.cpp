#include "services/pareto/sources/coordinate_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mortise::pareto {
namespace {

constexpr double kFirstStep = 0.01;  // of the parameter's range
constexpr double kNextStep = 0.2;    // of the step before
constexpr double kMinStep = 1e-4;
constexpr double kFurthest = 2;  // steps from the best that a parabola is believed
constexpr double kNearness = 6;  // values nearby are as near as 2^-6 of the range

}  // namespace

CoordinateSearch::CoordinateSearch(const Archive& archive, const Scaling& scaling,
                                   const LocalOptimization::Target& target, std::size_t start,
                                   Eigen::Index parameter, int values, Random& random)
    : scaling_(scaling), z_(target.z), start_(archive[start].u), parameter_(parameter) {
  best_ = {start_[parameter], DistanceOf(archive, start)};
  for (int i = 0; i < values; ++i) {
    // By turns anywhere, a bound first, and at an exponentially scaled distance.
    const double side = random.Uniform() < 0.5 ? -1 : 1;
    const double near = best_.value + side * std::exp2(-kNearness * random.Uniform());
    const double drawn = random.Uniform();
    const double anywhere = i == 0 ? std::round(drawn) : (i / 2 + drawn) / ((values + 1) / 2);
    queue_.push_back(i % 2 == 0 ? anywhere : std::clamp(near, 0.0, 1.0));
  }
  improved_ = values == 0;
  if (values == 0) Follow();
}

double CoordinateSearch::DistanceOf(const Archive& archive, std::size_t entry) const {
  if (!archive[entry].feasible) return std::numeric_limits<double>::infinity();
  return (scaling_.Apply(archive[entry].metrics) - z_).norm();
}

std::optional<Eigen::VectorXd> CoordinateSearch::Ask(Archive&) {
  if (queue_.empty()) return std::nullopt;
  Eigen::VectorXd u = start_;
  u[parameter_] = queue_.front();
  queue_.pop_front();
  ++outstanding_;
  return u;
}

void CoordinateSearch::Tell(Archive& archive, std::size_t entry) {
  --outstanding_;
  const Tried tried{archive[entry].u[parameter_], DistanceOf(archive, entry)};
  around_.push_back(tried);
  if (tried.distance < best_.distance) {
    best_ = tried;
    improved_ = true;
  }
  if (queue_.empty() && outstanding_ == 0) Follow();
}

// Where the parabola through three points is least; nothing if it is not convex.
std::optional<double> CoordinateSearch::Vertex() const {
  const Tried &a = around_[0], &b = around_[1], &c = around_[2];
  if (a.value == b.value || b.value == c.value || a.value == c.value) return std::nullopt;
  const double ab = (b.distance - a.distance) / (b.value - a.value);
  const double ac = (c.distance - a.distance) / (c.value - a.value);
  const double curvature = (ac - ab) / (c.value - b.value);
  if (!(curvature > 0) || !std::isfinite(curvature)) return std::nullopt;
  const double vertex = 0.5 * (a.value + b.value - ab / curvature);
  return std::clamp(vertex, std::max(best_.value - kFurthest * step_, 0.0),
                    std::min(best_.value + kFurthest * step_, 1.0));
}

// The two points beside the best, then the vertex of the parabola through the three.
void CoordinateSearch::Follow() {
  if (!improved_) return;
  if (around_.size() == 3 && step_ > 0) {
    const std::optional<double> vertex = Vertex();
    around_.clear();
    if (vertex && *vertex != best_.value) {
      queue_.push_back(*vertex);
      return;
    }
  }
  step_ = step_ == 0 ? kFirstStep : kNextStep * step_;
  if (step_ < kMinStep) return;
  around_ = {best_};
  for (const double side : {-step_, step_}) {
    queue_.push_back(std::clamp(best_.value + side, 0.0, 1.0));
  }
}

}  // namespace mortise::pareto
