#include "tests/bench/pareto/winding_problems.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "tests/bench/pareto/benchmark_formula.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using std::numbers::pi;

constexpr int kLeastDimensions = 3;
constexpr double kReferenceOfUnits = 1.1;  // of fronts from 0 to 1

// Parameters 2, 4 … add to the second metric, 3, 5 … to the first.
struct Winding {
  bool is_line = false;  // UF7's front, a line; else UF1's, a root

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::pow, std::sin;
    const auto size = static_cast<double>(x.size());
    std::array<T, 2> sums = {T(x[0] * 0.0), T(x[0] * 0.0)};
    std::array<double, 2> counts = {0, 0};
    for (std::size_t j = 1; j < x.size(); ++j) {
      const double number = static_cast<double>(j) + 1;
      const T off = T(x[j] - T(sin(T(x[0] * (6 * pi) + number * pi / size))));
      const std::size_t metric = j % 2 == 0 ? 0 : 1;
      sums[metric] += T(off * off);
      ++counts[metric];
    }
    const T place = is_line ? T(pow(x[0], 0.2)) : x[0];
    const T across = is_line ? place : T(Root(x[0]));
    return {T(place + sums[0] * (2 / counts[0])), T(1.0 - across + sums[1] * (2 / counts[1]))};
  }
};

// WFG4's parameters are z_i of 0 to 2 i.
struct Wfg4 {
  static constexpr std::size_t kPositions = 2;

  template <typename T>
  Vector<T> operator()(const Vector<T>& z) const {
    using std::cos, std::sin;
    T position = T(z[0] * 0.0);
    T distance = T(z[0] * 0.0);
    for (std::size_t i = 0; i < z.size(); ++i) {
      const T moved = Shifted(T(z[i] / (2.0 * (static_cast<double>(i) + 1))));
      if (i < kPositions) {
        position += T(moved / static_cast<double>(kPositions));
      } else {
        distance += T(moved / static_cast<double>(z.size() - kPositions));
      }
    }
    const T angle = T(position * (pi / 2));
    return {T(distance + T(sin(angle)) * 2.0), T(distance + T(cos(angle)) * 4.0)};
  }

  // The transformation s_multi with A = 30, B = 10, C = .35.
  template <typename T>
  static T Shifted(const T& y) {
    using std::abs, std::cos;
    constexpr double kHills = 30, kSlope = 10, kBest = 0.35;
    const double side = 2 * (std::floor(kBest - NumberOf(y)) + kBest);
    const T off = T(T(abs(T(y - kBest))) / side);
    const T hills = T(cos(T((0.5 - off) * ((4 * kHills + 2) * pi))));
    return T((1.0 + hills + T(off * off) * (4 * kSlope)) / (kSlope + 2));
  }
};

BenchmarkProblem MakeWinding(bool is_line, int dimensions) {
  DesignSpace space{VectorXd::Constant(dimensions, -1), VectorXd::Ones(dimensions)};
  space.lower[0] = 0;
  constexpr double kCorner = kReferenceOfUnits * (kReferenceOfUnits - 1) + kReferenceOfUnits;
  return {.name = is_line ? "UF7" : "UF1",
          .space = space,
          .metric_count = 2,
          .evaluate = Evaluating(Winding{is_line}, 2),
          .reference = Eigen::Vector2d::Constant(kReferenceOfUnits),
          .hypervolume = kCorner - (is_line ? 1.0 / 2 : 1.0 / 3)};
}

BenchmarkProblem MakeWfg4(int dimensions) {
  DesignSpace space{VectorXd::Zero(dimensions), VectorXd(dimensions)};
  for (Index i = 0; i < dimensions; ++i) space.upper[i] = 2.0 * (static_cast<double>(i) + 1);
  const Eigen::Vector2d reference(2.2, 4.4);
  return {.name = "WFG4",
          .space = space,
          .metric_count = 2,
          .evaluate = Evaluating(Wfg4{}, 2),
          .reference = reference,
          .hypervolume = reference.prod() - pi * 2 * 4 / 4};
}

}  // namespace

absl::StatusOr<BenchmarkProblem> MakeWindingProblem(const std::string& name, int dimensions) {
  if (WindingDimensions(name) == 0) return ResourceNotFound(name);
  if (dimensions < kLeastDimensions) {
    return InvalidField("dimensions", absl::StrCat(name, " needs at least ", kLeastDimensions));
  }
  const std::string lower = absl::AsciiStrToLower(name);
  return lower == "wfg4" ? MakeWfg4(dimensions) : MakeWinding(lower == "uf7", dimensions);
}

std::vector<std::string> WindingNames() { return {"UF1", "UF7", "WFG4"}; }

int WindingDimensions(const std::string& name) {
  const std::string lower = absl::AsciiStrToLower(name);
  if (lower == "uf1" || lower == "uf7") return 30;
  return lower == "wfg4" ? 24 : 0;
}

}  // namespace mortise::pareto
