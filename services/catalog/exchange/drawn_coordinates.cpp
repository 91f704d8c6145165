#include "services/catalog/exchange/drawn_coordinates.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace mortise::catalog {
namespace {

constexpr double kNoise = 1e-7;  // m; what CAD kernels take for equal
constexpr int kMaxDecimals = 12;
// Of the last decimal's unit: one number in a hundred is as near to one of so few by chance.
constexpr double kByChance = 0.005;

// The number of fewest decimals within `slack(decimals)` of `value`.
template <typename Slack>
double RoundestWithin(double value, const Slack& slack) {
  double scale = 1;
  for (int decimals = 0; decimals <= kMaxDecimals; ++decimals, scale *= 10) {
    const double rounded = std::round(value * scale) / scale;
    if (std::abs(rounded - value) <= slack(1 / scale)) return rounded == 0 ? 0 : rounded;
  }
  return value;
}

}  // namespace

double RoundestNear(double value, double slack) {
  return RoundestWithin(value, [slack](double) { return slack; });
}

std::vector<double> SnapCoordinates(const std::vector<double>& coordinates, double tolerance) {
  std::vector<std::size_t> order(coordinates.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return coordinates[a] < coordinates[b]; });
  std::vector<double> snapped(coordinates.size());
  for (std::size_t begin = 0; begin < order.size();) {
    const double first = coordinates[order[begin]];
    std::size_t end = begin;
    while (end < order.size() && coordinates[order[end]] - first <= tolerance) ++end;
    const double half = (coordinates[order[end - 1]] - first) / 2;
    const double value = RoundestWithin(first + half, [&](double unit) {
      return half + std::min({kNoise, tolerance / 2, kByChance * unit});
    });
    for (; begin < end; ++begin) snapped[order[begin]] = value;
  }
  return snapped;
}

}  // namespace mortise::catalog
