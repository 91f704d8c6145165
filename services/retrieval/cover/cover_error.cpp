// Fresh samples against primitives, and places on primitives against the manifold.
#include "services/retrieval/cover/cover_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/base/errors.h"
#include "common/base/random.h"
#include "services/retrieval/cover/constrained_step.h"
#include "services/retrieval/cover/differences.h"
#include "services/retrieval/cover/parallel_evaluator.h"

namespace mortise::retrieval {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr int kSteps = 12;
constexpr int kHalvings = 4;
constexpr double kSettled = 1e-3;  // of a distance: a step that gains less is the last

struct Known {
  VectorXd parameters;
  VectorXd value;
  int structure = 0;
};

absl::StatusOr<std::vector<Known>> KnownPoints(const Manifold& manifold,
                                               const ErrorSampling& sampling) {
  MORTISE_ASSIGN_OR_RETURN(const auto points, manifold.Sample(sampling.count, sampling.seed));
  ParallelEvaluator evaluator(manifold, sampling.threads);
  const auto values = evaluator.Evaluate(points);
  std::vector<Known> known;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (values[i].ok()) known.push_back({points[i], *values[i], manifold.Structure(points[i])});
  }
  return known;
}

// Looks for the point of the manifold nearest to one target.
class NearestSearch {
 public:
  NearestSearch(const Manifold& manifold, const VectorXd& extents, const VectorXd& target,
                int structure)
      : evaluator_(manifold, 1), extents_(extents), target_(target), structure_(structure) {}

  double DistanceFrom(Known start) {
    double distance = (target_ - start.value).norm();
    for (int step = 0; step < kSteps; ++step) {
      const double before = distance;
      if (!Step(&start, &distance) || distance > (1 - kSettled) * before) break;
    }
    return distance;
  }

 private:
  // One step, as long as it gets nearer; false if it does not.
  bool Step(Known* at, double* distance) {
    const Manifold& manifold = evaluator_.manifold();
    const auto derivatives = CentralDifferences(evaluator_, at->parameters, at->value,
                                                DifferenceSteps(extents_, manifold.noise()));
    if (!derivatives.ok()) return false;
    const auto step = ConstrainedStep(manifold.constraints(), at->parameters, derivatives->first,
                                      extents_, target_ - at->value);
    if (!step.ok()) return false;
    VectorXd change = *step;
    for (int halving = 0; halving < kHalvings; ++halving, change /= 2) {
      const auto next = PointAt(at->parameters + change);
      if (!next || (target_ - next->value).norm() >= *distance) continue;
      *at = *next;
      *distance = (target_ - at->value).norm();
      return true;
    }
    return false;
  }

  // The point of the manifold at these parameters; nothing if there is none of the structure.
  std::optional<Known> PointAt(const VectorXd& point) {
    const auto values = evaluator_.Evaluate({point});
    if (!values[0].ok() || evaluator_.manifold().Structure(point) != structure_) {
      return std::nullopt;
    }
    return Known{point, *values[0], structure_};
  }

  ParallelEvaluator evaluator_;
  const VectorXd& extents_;
  const VectorXd& target_;
  int structure_;
};

const Known* NearestKnown(const std::vector<Known>& known, const VectorXd& x, int structure) {
  const Known* nearest = nullptr;
  double least = std::numeric_limits<double>::infinity();
  for (const Known& each : known) {
    const double distance = (each.value - x).norm();
    if (each.structure != structure || distance >= least) continue;
    least = distance;
    nearest = &each;
  }
  return nearest;
}

VectorXd RandomPlace(const Primitive& primitive, Random* random) {
  const Index axes = primitive.axes.cols();
  const double part = std::pow(random->Uniform(), 1.0 / static_cast<double>(axes));
  return primitive.center +
         primitive.axes * (part * primitive.radii.cwiseProduct(random->UnitVector(axes)));
}

}  // namespace

absl::StatusOr<std::vector<double>> CoverageErrors(const Manifold& manifold,
                                                   const std::vector<Primitive>& primitives,
                                                   const ErrorSampling& sampling) {
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Known> known, KnownPoints(manifold, sampling));
  std::vector<double> errors(known.size(), std::numeric_limits<double>::infinity());
  ParallelFor(static_cast<int>(known.size()), sampling.threads, [&](int i) {
    const Known& point = known[static_cast<std::size_t>(i)];
    double& error = errors[static_cast<std::size_t>(i)];
    for (const Primitive& primitive : primitives) {
      if (primitive.structure == point.structure && DistanceBound(primitive, point.value) < error) {
        error = std::min(error, Distance(primitive, point.value));
      }
    }
  });
  std::sort(errors.begin(), errors.end());
  return errors;
}

absl::StatusOr<std::vector<double>> FittingErrors(const Manifold& manifold,
                                                  const std::vector<Primitive>& primitives,
                                                  const ErrorSampling& sampling) {
  std::vector<const Primitive*> tangents;
  for (const Primitive& primitive : primitives) {
    if (primitive.axes.cols() > 0) tangents.push_back(&primitive);
  }
  if (tangents.empty()) return std::vector<double>{};
  MORTISE_ASSIGN_OR_RETURN(const VectorXd extents, ExtentsOf(manifold.constraints()));
  MORTISE_ASSIGN_OR_RETURN(const std::vector<Known> known, KnownPoints(manifold, sampling));
  std::vector<double> errors(static_cast<std::size_t>(sampling.count));
  ParallelFor(sampling.count, sampling.threads, [&](int i) {
    Random random(sampling.seed + static_cast<std::uint64_t>(i));
    const auto at =
        static_cast<std::size_t>(random.Uniform() * static_cast<double>(tangents.size()));
    const Primitive& primitive = *tangents[at];
    const VectorXd place = RandomPlace(primitive, &random);
    NearestSearch search(manifold, extents, place, primitive.structure);
    double& error = errors[static_cast<std::size_t>(i)];
    error = search.DistanceFrom({primitive.parameters, primitive.center, primitive.structure});
    if (const Known* start = NearestKnown(known, place, primitive.structure)) {
      error = std::min(error, search.DistanceFrom(*start));
    }
  });
  std::sort(errors.begin(), errors.end());
  return errors;
}

double Quantile(const std::vector<double>& errors, double part) {
  if (errors.empty()) return 0;
  const double rank = std::ceil(part * static_cast<double>(errors.size()));
  const auto at = static_cast<std::size_t>(std::max(1.0, rank)) - 1;
  return errors[std::min(at, errors.size() - 1)];
}

}  // namespace mortise::retrieval
