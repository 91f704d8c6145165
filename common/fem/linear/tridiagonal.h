// Finds the ends of the spectrum of symmetric tridiagonal matrices, as Lanczos' method makes them.
#pragma once

#include <vector>

namespace mortise::simulator {

struct Spectrum {
  double least = 0, most = 0;
};

// Returns the least and the largest eigenvalue of the matrix with this diagonal (n > 0 numbers) and
// numbers beside it (n − 1), to about 12 digits of the largest.
Spectrum FindSpectrum(const std::vector<double>& diagonal, const std::vector<double>& side);

}  // namespace mortise::simulator
