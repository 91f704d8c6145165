#include "common/maps/packed_coefficients.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace mortise::maps {
namespace {

constexpr int kMostReach = 2;
// A grid may hold as many zeros for each coefficient before it is cut in two.
constexpr std::int64_t kMostFill = 4;

std::int32_t IndexOf(const BSpline& spline, int direction) {
  return spline.centre[direction] / SpacingOf(spline.level);
}

}  // namespace

// Sums q φ over one block. Directions are gone through by recursion; along each there are at most
// 2 · reach centres whose B-splines are not zero.
class PackedCoefficients::Sum {
 public:
  Sum(const PackedCoefficients& packed, double* values, double* gradient)
      : packed_(packed), values_(values), gradient_(gradient) {}

  void Add(const Block& block, const double* point) {
    const double* numbers = Enter(block, point);
    if (numbers == nullptr) return;
    if (gradient_ == nullptr) {
      Values(0, numbers, 1);
    } else {
      slopes_.fill(1);
      Gradients(0, numbers, 1);
    }
  }

  // Sets the factors of the centres that are not zero at the point. Returns the first one's
  // numbers, null if there are none.
  const double* Enter(const Block& block, const double* point) {
    const int reach = ReachOf(packed_.basis_);
    const double scale = std::ldexp(1.0, block.level);
    std::size_t start = block.first;
    for (int d = 0; d < packed_.dimension_; ++d) {
      const double scaled = point[d] * scale;
      const int cell = std::min(static_cast<int>(scaled), (1 << block.level) - 1);
      const int low = std::max(cell - reach + 1, block.low[d]);
      const int high = std::min(cell + reach, block.low[d] + block.count[d] - 1);
      if (low > high) return nullptr;
      count_[d] = high - low + 1;
      for (int n = 0; n < count_[d]; ++n) {
        const double offset = scaled - (low + n);
        factors_[d][n] =
            point[d] < 1 ? SplineAt(packed_.basis_, offset) : SplineAtEnd(packed_.basis_, offset);
        factors_[d][n].slope *= scale;
      }
      start += static_cast<std::size_t>(low - block.low[d]) * block.stride[d];
    }
    stride_ = block.stride.data();
    return packed_.numbers_.data() + start;
  }

  // How many centres Enter has found.
  int centres() const {
    int product = 1;
    for (int d = 0; d < packed_.dimension_; ++d) product *= count_[d];
    return product;
  }

 private:
  // Directions up to the last are gone through by calls, the last one by a loop.
  void Values(int d, const double* numbers, double weight) {
    const int count = count_[d], stride = stride_[d];
    if (d + 1 < packed_.dimension_) {
      for (int n = 0; n < count; ++n) {
        Values(d + 1, numbers + n * stride, weight * factors_[d][n].value);
      }
      return;
    }
    const int outputs = packed_.outputs_;
    for (int n = 0; n < count; ++n) {
      const double factor = weight * factors_[d][n].value;
      for (int o = 0; o < outputs; ++o) values_[o] += factor * numbers[n * stride + o];
    }
  }

  // slopes_[k] is the product of the factors so far with the slope in direction k.
  void Gradients(int d, const double* numbers, double weight) {
    if (d == packed_.dimension_) {
      for (int o = 0; o < packed_.outputs_; ++o) {
        values_[o] += weight * numbers[o];
        for (int k = 0; k < d; ++k) gradient_[o * d + k] += slopes_[k] * numbers[o];
      }
      return;
    }
    const std::array<double, kMostDirections> before = slopes_;
    for (int n = 0; n < count_[d]; ++n) {
      const SplineValue& factor = factors_[d][n];
      for (int k = 0; k < d; ++k) slopes_[k] = before[k] * factor.value;
      slopes_[d] = weight * factor.slope;
      Gradients(d + 1, numbers + n * stride_[d], weight * factor.value);
    }
    slopes_ = before;
  }

  const PackedCoefficients& packed_;
  double* values_;
  double* gradient_;
  const std::int32_t* stride_ = nullptr;
  std::array<int, kMostDirections> count_{};
  std::array<std::array<SplineValue, 2 * kMostReach>, kMostDirections> factors_{};
  std::array<double, kMostDirections> slopes_{};
};

PackedCoefficients::PackedCoefficients(const RefinementTree& tree,
                                       const Eigen::MatrixXd& coefficients)
    : dimension_(tree.dimension()),
      outputs_(static_cast<int>(coefficients.rows())),
      basis_(tree.basis()),
      ranges_(tree.elements().node_count()) {
  const SplineSet& splines = tree.splines();
  std::vector<Placed> placed;
  for (int number = 0; number < splines.count(); ++number) {
    const BSpline& spline = splines.At(number);
    if (!spline.active) continue;
    for (const int element : tree.elements().Overlapping(splines.SupportOf(spline))) {
      placed.push_back({element, spline.level, number});
    }
  }
  std::sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return std::tie(a.element, a.level, a.spline) < std::tie(b.element, b.level, b.spline);
  });
  for (std::size_t n = 0; n < placed.size();) {
    Range& range = ranges_[placed[n].element];
    if (range.first == range.end) range.first = static_cast<int>(blocks_.size());
    std::vector<int> group;
    const auto [element, level, first] = placed[n];
    for (; n < placed.size() && placed[n].element == element && placed[n].level == level; ++n) {
      group.push_back(placed[n].spline);
    }
    Pack(tree, coefficients, std::move(group));
    range.end = static_cast<int>(blocks_.size());
  }
}

// Lays the group out as a grid; where that would hold too many zeros, halves it first.
void PackedCoefficients::Pack(const RefinementTree& tree, const Eigen::MatrixXd& coefficients,
                              std::vector<int> group) {
  const SplineSet& splines = tree.splines();
  Block block;
  block.level = splines.At(group.front()).level;
  std::int64_t volume = 1;
  int longest = 0;
  for (int d = 0; d < dimension_; ++d) {
    const auto [least, most] = std::minmax_element(group.begin(), group.end(), [&](int a, int b) {
      return IndexOf(splines.At(a), d) < IndexOf(splines.At(b), d);
    });
    block.low[d] = IndexOf(splines.At(*least), d);
    block.count[d] = IndexOf(splines.At(*most), d) - block.low[d] + 1;
    volume *= block.count[d];
    if (block.count[d] > block.count[longest]) longest = d;
  }
  if (volume > 64 + kMostFill * static_cast<std::int64_t>(group.size())) {
    const std::int32_t middle = block.low[longest] + block.count[longest] / 2;
    const auto upper = std::stable_partition(group.begin(), group.end(), [&](int number) {
      return IndexOf(splines.At(number), longest) < middle;
    });
    Pack(tree, coefficients, std::vector<int>(group.begin(), upper));
    Pack(tree, coefficients, std::vector<int>(upper, group.end()));
    return;
  }
  std::int32_t stride = outputs_;
  for (int d = dimension_ - 1; d >= 0; --d) {
    block.stride[d] = stride;
    stride *= block.count[d];
  }
  block.first = numbers_.size();
  numbers_.resize(numbers_.size() + static_cast<std::size_t>(stride), 0.0);
  for (const int number : group) {
    std::size_t at = block.first;
    for (int d = 0; d < dimension_; ++d) {
      at +=
          static_cast<std::size_t>(IndexOf(splines.At(number), d) - block.low[d]) * block.stride[d];
    }
    for (int o = 0; o < outputs_; ++o) numbers_[at + o] = coefficients(o, number);
  }
  blocks_.push_back(block);
}

void PackedCoefficients::Evaluate(int element, const double* point, double* values,
                                  double* gradient) const {
  std::fill(values, values + outputs_, 0.0);
  if (gradient != nullptr) std::fill(gradient, gradient + outputs_ * dimension_, 0.0);
  Sum sum(*this, values, gradient);
  const Range& range = ranges_[element];
  for (int b = range.first; b < range.end; ++b) sum.Add(blocks_[b], point);
}

std::size_t PackedCoefficients::bytes() const {
  return numbers_.size() * sizeof(double) + blocks_.size() * sizeof(Block) +
         ranges_.size() * sizeof(Range);
}

std::size_t PackedCoefficients::BytesRead(int element, const double* point) const {
  std::size_t bytes = 0;
  Sum sum(*this, nullptr, nullptr);
  for (int b = ranges_[element].first; b < ranges_[element].end; ++b) {
    bytes += sizeof(Block);
    if (sum.Enter(blocks_[b], point) != nullptr) {
      bytes += sizeof(double) * static_cast<std::size_t>(sum.centres() * outputs_);
    }
  }
  return bytes;
}

}  // namespace mortise::maps
