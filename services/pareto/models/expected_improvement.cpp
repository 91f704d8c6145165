#include "services/pareto/models/expected_improvement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/random.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kRays = 256;
constexpr double kTail = 5;  // deviations beyond which a normal is taken for sure

double Cumulative(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

double Density(double z) { return std::exp(-0.5 * z * z) / std::sqrt(2 * std::numbers::pi); }

// E[(b - Y)+] and its derivatives.
struct Shortfall {
  double value = 0, mean_slope = 0, deviation_slope = 0;
};

Shortfall ShortfallOf(double b, double mean, double deviation) {
  if (b == -kInfinity) return {};
  const double z = (b - mean) / deviation;
  const double cumulative = Cumulative(z), density = Density(z);
  return {(b - mean) * cumulative + deviation * density, -cumulative, density};
}

// Gauss-Legendre on [-1, 1]: eight nodes, of which these are the positive ones.
constexpr std::array<double, 4> kNodes = {0.1834346424956498, 0.5255324099163290,
                                          0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873,
                                            0.2223810344533745, 0.1012285362903763};

// The part of the unit sphere of R^d where all coordinates are positive.
double OrthantOfSphere(Index d) {
  const auto size = static_cast<double>(d);
  return 2 * std::pow(std::numbers::pi, size / 2) / std::tgamma(size / 2) / std::exp2(size);
}

}  // namespace

ExpectedHypervolumeImprovement::ExpectedHypervolumeImprovement(const std::vector<VectorXd>& front,
                                                               const VectorXd& reference)
    : reference_(reference) {
  std::vector<VectorXd> inside;
  for (const VectorXd& point : front) {
    if ((point.array() < reference.array()).all()) inside.push_back(point);
  }
  if (reference.size() == 1) {
    VectorXd least = reference;
    for (const VectorXd& point : inside) least = least.cwiseMin(point).eval();
    AddBox(VectorXd::Constant(1, -kInfinity), least);
  } else if (reference.size() == 2) {
    CutPlane(std::move(inside));
  } else if (reference.size() == 3) {
    CutSpace(std::move(inside));
  } else {
    CastRays(inside);
  }
}

void ExpectedHypervolumeImprovement::AddBox(const VectorXd& lower, const VectorXd& upper) {
  lower_.push_back(lower);
  upper_.push_back(upper);
}

void ExpectedHypervolumeImprovement::CutPlane(std::vector<VectorXd> front) {
  std::ranges::sort(front, [](const VectorXd& a, const VectorXd& b) {
    return a[0] != b[0] ? a[0] < b[0] : a[1] < b[1];
  });
  double left = -kInfinity, ceiling = reference_[1];
  for (const VectorXd& point : front) {
    if (point[1] >= ceiling) continue;
    AddBox(Eigen::Vector2d(left, -kInfinity), Eigen::Vector2d(point[0], ceiling));
    left = point[0];
    ceiling = point[1];
  }
  AddBox(Eigen::Vector2d(left, -kInfinity), Eigen::Vector2d(reference_[0], ceiling));
}

void ExpectedHypervolumeImprovement::CutSpace(std::vector<VectorXd> front) {
  struct Strip {
    double from, to, ceiling, begin;  // of the first, second and third metric
  };
  std::ranges::sort(front, {}, [](const VectorXd& point) { return point[2]; });
  std::vector<Strip> strips = {{-kInfinity, reference_[0], reference_[1], -kInfinity}};
  const auto close = [&](const Strip& strip, double end) {
    if (end > strip.begin) {
      AddBox(Eigen::Vector3d(strip.from, -kInfinity, strip.begin),
             Eigen::Vector3d(strip.to, strip.ceiling, end));
    }
  };
  for (const VectorXd& point : front) {
    std::vector<Strip> next;
    bool opened = false;
    for (const Strip& strip : strips) {
      if (strip.to <= point[0] || strip.ceiling <= point[1]) {
        next.push_back(strip);
        continue;
      }
      close(strip, point[2]);
      if (strip.from < point[0]) next.push_back({strip.from, point[0], strip.ceiling, point[2]});
      if (opened) {
        next.back().to = strip.to;
      } else {
        next.push_back({std::max(strip.from, point[0]), strip.to, point[1], point[2]});
      }
      opened = true;
    }
    strips = std::move(next);
  }
  for (const Strip& strip : strips) close(strip, reference_[2]);
}

void ExpectedHypervolumeImprovement::CastRays(const std::vector<VectorXd>& front) {
  Random random(1);
  for (int k = 0; k < kRays; ++k) {
    rays_.push_back(random.UnitVector(reference_.size()).cwiseAbs().cwiseMax(1e-9));
    double most = 0;
    for (const VectorXd& point : front) {
      most = std::max(most, (reference_ - point).cwiseQuotient(rays_.back()).minCoeff());
    }
    dominated_.push_back(most);
  }
}

ExpectedHypervolumeImprovement::Value ExpectedHypervolumeImprovement::OverBoxes(
    const VectorXd& means, const VectorXd& deviations) const {
  const Index d = reference_.size();
  Value value{0, VectorXd::Zero(d), VectorXd::Zero(d)};
  std::array<Shortfall, 3> sides;
  for (std::size_t box = 0; box < lower_.size(); ++box) {
    double product = 1;
    for (Index k = 0; k < d && product > 0; ++k) {
      const Shortfall high = ShortfallOf(upper_[box][k], means[k], deviations[k]);
      const Shortfall low = ShortfallOf(lower_[box][k], means[k], deviations[k]);
      sides[static_cast<std::size_t>(k)] = {std::max(0.0, high.value - low.value),
                                            high.mean_slope - low.mean_slope,
                                            high.deviation_slope - low.deviation_slope};
      product *= sides[static_cast<std::size_t>(k)].value;
    }
    if (!(product > 0)) continue;
    value.expected += product;
    for (Index k = 0; k < d; ++k) {
      const Shortfall& side = sides[static_cast<std::size_t>(k)];
      value.mean_gradient[k] += product / side.value * side.mean_slope;
      value.deviation_gradient[k] += product / side.value * side.deviation_slope;
    }
  }
  return value;
}

ExpectedHypervolumeImprovement::Value ExpectedHypervolumeImprovement::AlongRays(
    const VectorXd& means, const VectorXd& deviations) const {
  const Index d = reference_.size();
  Value value{0, VectorXd::Zero(d), VectorXd::Zero(d)};
  const VectorXd farthest = reference_ - means + kTail * deviations;
  const double share = OrthantOfSphere(d) / kRays;
  VectorXd z(d), below(d);
  for (std::size_t ray = 0; ray < rays_.size(); ++ray) {
    const double begin = dominated_[ray], end = farthest.cwiseQuotient(rays_[ray]).minCoeff();
    if (end <= begin) continue;
    for (std::size_t node = 0; node < 2 * kNodes.size(); ++node) {
      const double at = node % 2 == 0 ? kNodes[node / 2] : -kNodes[node / 2];
      const double t = 0.5 * (begin + end + at * (end - begin));
      z = (reference_ - t * rays_[ray] - means).cwiseQuotient(deviations);
      for (Index k = 0; k < d; ++k) below[k] = Cumulative(z[k]);
      const double weight = share * 0.5 * (end - begin) * kWeights[node / 2] *
                            std::pow(t, static_cast<double>(d - 1)) * below.prod();
      if (!(weight > 0)) continue;
      value.expected += weight;
      for (Index k = 0; k < d; ++k) {
        const double slope = weight * Density(z[k]) / below[k] / deviations[k];
        value.mean_gradient[k] -= slope;
        value.deviation_gradient[k] -= slope * z[k];
      }
    }
  }
  return value;
}

ExpectedHypervolumeImprovement::Value ExpectedHypervolumeImprovement::WithGradient(
    const VectorXd& means, const VectorXd& deviations) const {
  return reference_.size() <= 3 ? OverBoxes(means, deviations) : AlongRays(means, deviations);
}

double ExpectedHypervolumeImprovement::Expected(const VectorXd& means,
                                                const VectorXd& deviations) const {
  return WithGradient(means, deviations).expected;
}

}  // namespace mortise::pareto
