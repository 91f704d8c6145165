// Formulas of the benchmark problems; gradients by forward differentiation of the same formulas.
#include "services/pareto/benchmark_problems.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/AutoDiff>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/pareto/hypervolume.h"
#include "services/pareto/random.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Dual = Eigen::AutoDiffScalar<VectorXd>;
constexpr double kPi = std::numbers::pi;

template <typename T>
using Vector = std::vector<T>;

template <typename T>
T SumFrom(const Vector<T>& x, std::size_t first) {
  T sum = x[first];
  for (std::size_t i = first + 1; i < x.size(); ++i) sum += x[i];
  return sum;
}

double Root(double value) { return std::sqrt(value); }

// The slope of the root is infinite at 0, but only along coordinates that move its argument.
Dual Root(const Dual& value) {
  if (value.value() > 0) return Dual(sqrt(value));
  Dual root(0, value.derivatives());
  for (double& slope : root.derivatives())
    if (slope != 0) slope = std::copysign(std::numeric_limits<double>::infinity(), slope);
  return root;
}

struct Zdt {
  int number;

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::cos, std::exp, std::pow, std::sin;
    const auto rest = static_cast<double>(x.size() - 1);
    if (number == 4) {
      T g = T(x[0] * 0.0 + (1 + 10 * rest));
      for (std::size_t i = 1; i < x.size(); ++i)
        g += T(x[i] * x[i]) - T(T(cos(T(x[i] * (4 * kPi)))) * 10.0);
      return {x[0], T(g - Root(T(x[0] * g)))};
    }
    if (number == 6) {
      const T g = T(T(pow(T(SumFrom(x, 1) / rest), 0.25)) * 9.0 + 1.0);
      const T wave = T(sin(T(x[0] * (6 * kPi))));
      const T f = T(T(T(exp(T(x[0] * -4.0))) * T(pow(wave, 6))) * -1.0 + 1.0);
      return {f, T(g - T(T(f * f) / g))};
    }
    const T g = T(SumFrom(x, 1) * (9 / rest) + 1.0);
    const T ratio = T(x[0] / g);
    if (number == 1) return {x[0], T(g - T(Root(T(x[0] * g))))};
    if (number == 2) return {x[0], T(g - T(x[0] * ratio))};
    return {x[0], T(g - T(Root(T(x[0] * g))) - T(x[0] * T(sin(T(x[0] * (10 * kPi))))))};
  }
};

struct Dtlz {
  int number;

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::cos, std::sin;
    T g = T(x[0] * 0.0);
    for (std::size_t i = 2; i < x.size(); ++i) {
      const T y = T(x[i] - 0.5);
      g += T(y * y);
      if (number != 2) g += T(T(T(cos(T(y * (20 * kPi)))) * -1.0) + 1.0);
    }
    if (number != 2) g = T(g * 100.0);
    const T scale = T(g + 1.0);
    if (number == 1) {
      const T half = T(scale * 0.5);
      const T a = T(half * x[0]);
      return {T(a * x[1]), T(a - T(a * x[1])), T(half - a)};
    }
    const T theta = T(x[0] * (kPi / 2));
    const T phi = T(x[1] * (kPi / 2));
    const T ring = T(scale * T(cos(theta)));
    return {T(ring * T(cos(phi))), T(ring * T(sin(phi))), T(scale * T(sin(theta)))};
  }
};

struct Kursawe {
  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::abs, std::exp, std::pow, std::sin, std::sqrt;
    T first = T(x[0] * 0.0);
    for (std::size_t i = 0; i + 1 < x.size(); ++i) {
      const T length = T(sqrt(T(T(x[i] * x[i]) + T(x[i + 1] * x[i + 1]))));
      first += T(T(exp(T(length * -0.2))) * -10.0);
    }
    T second = T(x[0] * 0.0);
    for (const T& value : x)
      second += T(pow(T(abs(value)), 0.8)) + T(T(sin(T(value * value * value))) * 5.0);
    return {first, second};
  }
};

struct Fourier {
  static constexpr int kTerms = 3;
  std::vector<MatrixXd> amplitude, phase;  // one a metric, D x K

  Fourier(int dimensions, int metrics, std::uint64_t seed) {
    Random random(seed);
    for (int j = 0; j < metrics; ++j) {
      amplitude.emplace_back(dimensions, kTerms);
      phase.emplace_back(dimensions, kTerms);
      for (double& value : amplitude.back().reshaped()) value = random.Uniform();
      for (double& value : phase.back().reshaped()) value = random.Uniform();
    }
  }

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::sin;
    Vector<T> metrics;
    for (std::size_t j = 0; j < amplitude.size(); ++j) {
      T sum = T(x[0] * 0.0);
      for (std::size_t i = 0; i < x.size(); ++i)
        for (int k = 0; k < kTerms; ++k) {
          const auto row = static_cast<Index>(i);
          sum += T(T(sin(T(x[i] * (k + 1.0) + phase[j](row, k)))) * amplitude[j](row, k));
        }
      metrics.push_back(sum);
    }
    return metrics;
  }
};

template <typename Formula>
std::function<Evaluation(const VectorXd&, bool)> Evaluating(Formula formula) {
  return [formula](const VectorXd& x, bool gradients) {
    Evaluation evaluation;
    evaluation.x = x;
    evaluation.status = EvaluationStatus::kFeasible;
    if (!gradients) {
      const auto metrics = formula(Vector<double>(x.begin(), x.end()));
      evaluation.metrics = VectorXd::Map(metrics.data(), static_cast<Index>(metrics.size()));
      return evaluation;
    }
    Vector<Dual> duals;
    for (Index i = 0; i < x.size(); ++i) duals.emplace_back(x[i], x.size(), i);
    const Vector<Dual> metrics = formula(duals);
    const auto d = static_cast<Index>(metrics.size());
    evaluation.metrics.resize(d);
    evaluation.jacobian.resize(d, x.size());
    for (Index j = 0; j < d; ++j) {
      evaluation.metrics[j] = metrics[static_cast<std::size_t>(j)].value();
      evaluation.jacobian.row(j) = metrics[static_cast<std::size_t>(j)].derivatives().transpose();
    }
    return evaluation;
  };
}

DesignSpace Box(int dimensions, double lower, double upper) {
  return {VectorXd::Constant(dimensions, lower), VectorXd::Constant(dimensions, upper)};
}

double ZdtHypervolume(int number) {
  constexpr double kReference = 1.1;
  const double corner = (kReference - 1) * kReference;
  if (number == 1 || number == 4) return kReference - 1.0 / 3 + corner;
  if (number == 2) return kReference - 2.0 / 3 + corner;
  if (number == 6) {
    const double a = 0.2807753191;  // least f1
    return (kReference - 1) * (1 - a) + (1 - a * a * a) / 3 + corner;
  }
  std::vector<VectorXd> front;
  for (int i = 0; i <= 200'000; ++i) {
    const double f = i / 200'000.0;
    front.push_back(Eigen::Vector2d(f, 1 - std::sqrt(f) - f * std::sin(10 * kPi * f)));
  }
  return Hypervolume(front, VectorXd::Constant(2, kReference));
}

BenchmarkProblem MakeZdt(int number, int dimensions) {
  BenchmarkProblem problem{
      absl::StrCat("ZDT", number), Box(dimensions, 0, 1),      2,
      Evaluating(Zdt{number}),     VectorXd::Constant(2, 1.1), ZdtHypervolume(number)};
  if (number == 4) {
    problem.space.lower.tail(dimensions - 1).setConstant(-5);
    problem.space.upper.tail(dimensions - 1).setConstant(5);
  }
  return problem;
}

BenchmarkProblem MakeDtlz(int number, int dimensions) {
  const double reference = number == 1 ? 0.55 : 1.1;
  const double below = number == 1 ? 0.125 / 6 : kPi / 6;  // under the true front
  return {absl::StrCat("DTLZ", number),
          Box(dimensions, 0, 1),
          3,
          Evaluating(Dtlz{number}),
          VectorXd::Constant(3, reference),
          reference * reference * reference - below};
}

}  // namespace

std::vector<std::string> BenchmarkNames() {
  return {"ZDT1", "ZDT2", "ZDT3", "ZDT4", "ZDT6", "DTLZ1", "DTLZ2", "DTLZ3", "Kursawe", "Fourier"};
}

absl::StatusOr<BenchmarkProblem> MakeBenchmarkProblem(const std::string& name, int dimensions,
                                                      std::uint64_t seed) {
  const std::string lower = absl::AsciiStrToLower(name);
  if (dimensions < 1 || dimensions > 512)
    return InvalidField("dimensions", "must lie between 1 and 512");
  for (const int number : {1, 2, 3, 4, 6}) {
    if (lower != absl::StrCat("zdt", number)) continue;
    if (dimensions < 2) return InvalidField("dimensions", "ZDT problems need at least 2");
    return MakeZdt(number, dimensions);
  }
  for (const int number : {1, 2, 3}) {
    if (lower != absl::StrCat("dtlz", number)) continue;
    if (dimensions < 3) return InvalidField("dimensions", "DTLZ problems need at least 3");
    return MakeDtlz(number, dimensions);
  }
  if (lower == "kursawe") {
    if (dimensions != 3) return InvalidField("dimensions", "Kursawe's problem has 3");
    return BenchmarkProblem{
        "Kursawe", Box(3, -5, 5), 2, Evaluating(Kursawe{}), Eigen::Vector2d(-14, 1), 0};
  }
  if (lower == "fourier")
    return BenchmarkProblem{"Fourier",
                            Box(dimensions, 0, 2 * kPi),
                            2,
                            Evaluating(Fourier(dimensions, 2, seed)),
                            Eigen::Vector2d(2.0 * dimensions, 2.0 * dimensions),
                            0};
  return InvalidField("name", absl::StrCat("no benchmark problem '", name, "'"));
}

}  // namespace mortise::pareto
