// Hypervolume by sweeps and by what each point dominates alone.
//
// All in depths below the reference, z = reference - y > 0: larger is better, and a point dominates
// the box from the origin to z.
#include "services/pareto/archive/hypervolume.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <type_traits>
#include <utility>

namespace mortise::pareto {
namespace {

template <std::size_t K>
using Depth = std::array<double, K>;

template <std::size_t K>
bool Covers(const Depth<K>& a, const Depth<K>& b) {
  for (std::size_t i = 0; i < K; ++i) {
    if (a[i] < b[i]) return false;
  }
  return true;
}

template <std::size_t K>
double BoxOf(const Depth<K>& z) {
  double box = 1;
  for (const double side : z) box *= side;
  return box;
}

// Adds a point to some of which none covers another. One that covers another is likely to cover the
// next, so it is looked at first.
template <std::size_t K>
void Add(const Depth<K>& z, std::vector<Depth<K>>& points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (Covers(points[i], z)) {
      std::swap(points[i], points[i / 2]);
      return;
    }
  }
  std::erase_if(points, [&](const Depth<K>& other) { return Covers(z, other); });
  points.push_back(z);
}

double Area(std::vector<Depth<2>>& points) {
  std::ranges::sort(points, std::greater<>{});
  double area = 0, top = 0;
  for (const auto& [right, height] : points) {
    if (height <= top) continue;
    area += right * (height - top);
    top = height;
  }
  return area;
}

// Points of the plane, none covering another, that keep the area they dominate while more are
// added.
class Staircase {
 public:
  void Insert(double right, double height) {
    auto last = std::ranges::lower_bound(steps_, right, {}, &Step::right);
    double floor = last == steps_.end() ? 0 : last->height;  // what is known at `right`
    if (floor >= height) return;
    auto first = last;
    if (last != steps_.end() && last->right == right) ++last;
    double to = right;
    while (first != steps_.begin() && std::prev(first)->height <= height) {
      --first;
      area_ += (to - first->right) * (height - floor);
      to = first->right;
      floor = first->height;
    }
    const double from = first == steps_.begin() ? 0 : std::prev(first)->right;
    area_ += (to - from) * (height - floor);
    if (first == last) {
      steps_.insert(first, {right, height});
    } else {
      *first = {right, height};
      steps_.erase(std::next(first), last);
    }
  }

  double area() const { return area_; }

 private:
  struct Step {
    double right, height;
  };

  double area_ = 0;
  std::vector<Step> steps_;  // to the right, each lower than the one before
};

// The part of the box of `z` that none of `points` covers, which are within it.
template <std::size_t K>
double Uncovered(const Depth<K>& z, std::vector<Depth<K>>& points);

// Reorders `points`.
template <std::size_t K>
double Volume(std::vector<Depth<K>>& points) {
  if constexpr (K == 1) {
    return points.empty() ? 0 : (*std::ranges::max_element(points))[0];
  } else if constexpr (K == 2) {
    return Area(points);
  } else if constexpr (K == 3) {
    std::ranges::sort(points, [](const auto& a, const auto& b) { return a[2] > b[2]; });
    Staircase staircase;
    double volume = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      staircase.Insert(points[i][0], points[i][1]);
      const double next = i + 1 < points.size() ? points[i + 1][2] : 0;
      volume += staircase.area() * (points[i][2] - next);
    }
    return volume;
  } else {
    // From the least in the last coordinate on: in its box, the others all reach as far in that.
    std::ranges::sort(points, [](const auto& a, const auto& b) { return a[K - 1] < b[K - 1]; });
    std::vector<Depth<K - 1>> limited;
    double volume = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      Depth<K - 1> z;
      std::copy_n(points[i].begin(), K - 1, z.begin());
      limited.clear();
      bool covered = false;
      for (std::size_t k = i + 1; k < points.size() && !covered; ++k) {
        Depth<K - 1> within;
        for (std::size_t c = 0; c + 1 < K; ++c) within[c] = std::min(z[c], points[k][c]);
        covered = within == z;
        Add<K - 1>(within, limited);
      }
      if (!covered) volume += points[i][K - 1] * Uncovered<K - 1>(z, limited);
    }
    return volume;
  }
}

template <std::size_t K>
double Uncovered(const Depth<K>& z, std::vector<Depth<K>>& points) {
  return std::max(0.0, BoxOf<K>(z) - Volume<K>(points));
}

// Below the reference; no depths where it is not.
template <std::size_t K>
bool DepthOf(const Eigen::Ref<const Eigen::VectorXd>& point, const Eigen::VectorXd& reference,
             Depth<K>& z) {
  for (std::size_t i = 0; i < K; ++i) {
    z[i] = reference[i] - point[i];
    if (!(z[i] > 0)) return false;
  }
  return true;
}

template <std::size_t K>
double VolumeOf(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& reference) {
  std::vector<Depth<K>> inside;
  Depth<K> z;
  for (const Eigen::VectorXd& point : points) {
    if (DepthOf<K>(point, reference, z)) inside.push_back(z);
  }
  return Volume<K>(inside);
}

template <std::size_t K>
double ContributionOf(const Eigen::VectorXd& point, const Eigen::Ref<const Eigen::MatrixXd>& points,
                      const Eigen::VectorXd& reference, std::size_t most) {
  Depth<K> z, other;
  if (!DepthOf<K>(point, reference, z)) return 0;
  std::vector<Depth<K>> limited;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (!DepthOf<K>(points.col(k), reference, other)) continue;
    for (std::size_t i = 0; i < K; ++i) other[i] = std::min(z[i], other[i]);
    if (other == z) return 0;
    Add<K>(other, limited);
  }
  if (most > 0 && limited.size() > most) {
    std::ranges::sort(limited, [](const Depth<K>& a, const Depth<K>& b) {
      const double first = BoxOf<K>(a), second = BoxOf<K>(b);
      return first != second ? first > second : a > b;
    });
    limited.resize(most);
  }
  return Uncovered<K>(z, limited);
}

// Calls `measure` with the number of metrics as a constant.
template <typename Measure>
double WithMetrics(Eigen::Index d, const Measure& measure) {
  switch (d) {
    case 1:
      return measure(std::integral_constant<std::size_t, 1>{});
    case 2:
      return measure(std::integral_constant<std::size_t, 2>{});
    case 3:
      return measure(std::integral_constant<std::size_t, 3>{});
    case 4:
      return measure(std::integral_constant<std::size_t, 4>{});
    case 5:
      return measure(std::integral_constant<std::size_t, 5>{});
    case 6:
      return measure(std::integral_constant<std::size_t, 6>{});
    default:
      return 0;
  }
}

// The n-th of a sequence of places that fill the unit cube evenly: multiples, modulo 1, of powers
// of the inverse of the root of x^(d + 1) = x + 1 (Kronecker's sequence; for d = 1 the golden
// ratio).
Eigen::VectorXd SequenceSteps(Eigen::Index d) {
  double root = 2;
  for (int i = 0; i < 60; ++i) root = std::pow(1 + root, 1.0 / static_cast<double>(d + 1));
  Eigen::VectorXd steps(d);
  for (Eigen::Index i = 0; i < d; ++i) steps[i] = std::pow(root, -static_cast<double>(i + 1));
  return steps;
}

}  // namespace

double Hypervolume(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& reference) {
  return WithMetrics(reference.size(), [&](auto d) { return VolumeOf<d()>(points, reference); });
}

double HypervolumeContribution(const Eigen::VectorXd& point,
                               const Eigen::Ref<const Eigen::MatrixXd>& points,
                               const Eigen::VectorXd& reference, std::size_t most) {
  return WithMetrics(reference.size(),
                     [&](auto d) { return ContributionOf<d()>(point, points, reference, most); });
}

double SampledHypervolume(const std::vector<Eigen::VectorXd>& points,
                          const Eigen::VectorXd& reference, int samples) {
  return WithMetrics(reference.size(), [&](auto d) {
    constexpr std::size_t K = d();
    std::vector<Depth<K>> inside;
    Depth<K> z, corner{};
    for (const Eigen::VectorXd& point : points) {
      if (!DepthOf<K>(point, reference, z)) continue;
      inside.push_back(z);
      for (std::size_t i = 0; i < K; ++i) corner[i] = std::max(corner[i], z[i]);
    }
    // Those that dominate most first, so that what is dominated is soon found to be.
    std::ranges::sort(inside, std::greater<>{}, BoxOf<K>);
    const Eigen::VectorXd steps = SequenceSteps(K);
    std::int64_t dominated = 0;
    for (int n = 0; n < samples; ++n) {
      for (std::size_t i = 0; i < K; ++i) {
        const double place = 0.5 + (n + 1) * steps[i];
        z[i] = corner[i] * (place - std::floor(place));
      }
      dominated += std::ranges::any_of(inside, [&](const Depth<K>& p) { return Covers<K>(p, z); });
    }
    return BoxOf<K>(corner) * static_cast<double>(dominated) / samples;
  });
}

double QuickHypervolume(const std::vector<Eigen::VectorXd>& points,
                        const Eigen::VectorXd& reference, int samples) {
  // How long a pair of points takes in units of half a sample's comparison with a point, as
  // measured.
  constexpr std::array<double, kMaxMetrics + 1> kEffort = {0, 0, 0, 0, 16, 80, 800};
  const double effort = kEffort[static_cast<std::size_t>(std::min(reference.size(), kMaxMetrics))];
  return static_cast<double>(points.size()) * effort <= samples
             ? Hypervolume(points, reference)
             : SampledHypervolume(points, reference, samples);
}

}  // namespace mortise::pareto
