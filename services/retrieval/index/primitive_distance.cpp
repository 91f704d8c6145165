// Sums of four interleaved parts.
#include "services/retrieval/index/primitive_distance.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace mortise::retrieval {
namespace {

using Eigen::Array4d;
using Eigen::Array4f;
using Eigen::Map;

constexpr double kLittle = 0.05;  // of a square: with less left, floats' rounding would show

double Sum(const Array4d& parts) { return (parts[0] + parts[1]) + (parts[2] + parts[3]); }

// offset = x - center, and its square.
double Subtract(const double* x, const float* center, std::int64_t size, double* offset) {
  Array4d sums = Array4d::Zero();
  std::int64_t i = 0;
  for (; i + 4 <= size; i += 4) {
    const Array4d difference =
        Map<const Array4d>(x + i) - Map<const Array4f>(center + i).cast<double>();
    Map<Array4d>(offset + i) = difference;
    sums += difference * difference;
  }
  double rest = 0;
  for (; i < size; ++i) {
    offset[i] = x[i] - static_cast<double>(center[i]);
    rest += offset[i] * offset[i];
  }
  return Sum(sums) + rest;
}

double Dot(const double* offset, const float* axis, std::int64_t size) {
  Array4d sums = Array4d::Zero();
  std::int64_t i = 0;
  for (; i + 4 <= size; i += 4) {
    sums += Map<const Array4d>(offset + i) * Map<const Array4f>(axis + i).cast<double>();
  }
  double rest = 0;
  for (; i < size; ++i) rest += offset[i] * static_cast<double>(axis[i]);
  return Sum(sums) + rest;
}

// The square of what is left of `offset` without its parts along the axes. The difference of the
// squares would lose that to rounding where x lies nearly in the tangent space.
double SquareBeside(const IndexArrays& arrays, const PrimitiveEntry& primitive, double* offset) {
  const std::int64_t size = arrays.sizes.dimension;
  const float* axis = arrays.vectors.data() + primitive.vectors;
  for (std::int32_t k = 0; k < primitive.axes; ++k) {
    axis += size;
    const double part = Dot(offset, axis, size);
    for (std::int64_t i = 0; i < size; ++i) offset[i] -= part * static_cast<double>(axis[i]);
  }
  double square = 0;
  for (std::int64_t i = 0; i < size; ++i) square += offset[i] * offset[i];
  return square;
}

}  // namespace

double DistanceFrom(const IndexArrays& arrays, const PrimitiveEntry& primitive, const double* x,
                    double* offset) {
  const std::int64_t size = arrays.sizes.dimension;
  const float* vector = arrays.vectors.data() + primitive.vectors;
  const double* radii = arrays.radii.data() + primitive.radii;
  const double square = Subtract(x, vector, size, offset);
  if (primitive.axes == 0) return std::sqrt(square);
  double along = 0, scaled = 0;
  for (std::int32_t i = 0; i < primitive.axes; ++i) {
    vector += size;
    const double part = Dot(offset, vector, size);
    along += part * part;
    scaled += (part / radii[i]) * (part / radii[i]);
  }
  const double beyond = scaled <= 1 ? 0 : 1 - 1 / std::sqrt(scaled);
  const double difference = square - along;
  const double beside =
      difference > kLittle * square ? difference : SquareBeside(arrays, primitive, offset);
  return std::sqrt(beside + beyond * beyond * along);
}

BoxOffset OffsetFromBox(const IndexArrays& arrays, const PrimitiveEntry& primitive, const double* x,
                        double* offset, double* within) {
  const std::int64_t size = arrays.sizes.dimension;
  const float* vector = arrays.vectors.data() + primitive.vectors;
  const double* radii = arrays.radii.data() + primitive.radii;
  const double square = Subtract(x, vector, size, offset);
  double box_square = square;
  for (std::int32_t i = 0; i < primitive.axes; ++i) {
    vector += size;
    const double along = Dot(offset, vector, size);
    within[i] = std::clamp(along, -radii[i], radii[i]);
    box_square -= along * along - (along - within[i]) * (along - within[i]);
  }
  return {square, box_square};
}

}  // namespace mortise::retrieval
