#include "common/fem/linear/tridiagonal.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace mortise::simulator {
namespace {

// How many eigenvalues lie below x: the negative pivots of the matrix less x (Sturm's sequence).
std::size_t CountBelow(const std::vector<double>& diagonal, const std::vector<double>& side,
                       double x, double tiny) {
  std::size_t count = 0;
  double pivot = 1;
  for (std::size_t k = 0; k < diagonal.size(); ++k) {
    const double coupling = k > 0 ? side[k - 1] * side[k - 1] / pivot : 0;
    pivot = diagonal[k] - x - coupling;
    if (std::abs(pivot) < tiny) pivot = -tiny;
    count += pivot < 0;
  }
  return count;
}

// The smallest x below which there are at least `count` eigenvalues.
double Bisect(const std::vector<double>& diagonal, const std::vector<double>& side, double low,
              double high, std::size_t count) {
  const double tiny = 1e-300 + 1e-30 * (high - low);
  for (int round = 0; round < 60; ++round) {
    const double middle = 0.5 * (low + high);
    (CountBelow(diagonal, side, middle, tiny) >= count ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

Spectrum FindSpectrum(const std::vector<double>& diagonal, const std::vector<double>& side) {
  // Gershgorin's circles hold all eigenvalues.
  double low = diagonal[0], high = diagonal[0];
  for (std::size_t k = 0; k < diagonal.size(); ++k) {
    const double radius =
        (k > 0 ? std::abs(side[k - 1]) : 0) + (k + 1 < diagonal.size() ? std::abs(side[k]) : 0);
    low = std::min(low, diagonal[k] - radius);
    high = std::max(high, diagonal[k] + radius);
  }
  return {Bisect(diagonal, side, low, high, 1), Bisect(diagonal, side, low, high, diagonal.size())};
}

}  // namespace mortise::simulator
