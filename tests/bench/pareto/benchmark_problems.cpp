// Formulas of the benchmark problems; gradients by forward differentiation of the same formulas.
#include "tests/bench/pareto/benchmark_problems.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/errors.h"
#include "common/base/random.h"
#include "services/pareto/archive/hypervolume.h"
#include "tests/bench/pareto/benchmark_formula.h"
#include "tests/bench/pareto/mixed_problems.h"
#include "tests/bench/pareto/winding_problems.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
constexpr double kPi = std::numbers::pi;
// Against (-14, 1): of a grid of 0.008, refined by random steps until six digits stood still.
constexpr double kKursaweHypervolume = 37.3494;

// Distance parameters, measured from where the best of them is.
struct Distances {
  std::size_t first = 1;  // of the parameters
  VectorXd best;          // of those
  MatrixXd rotation;      // empty: none

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    Vector<T> y;
    for (std::size_t i = first; i < x.size(); ++i) {
      y.push_back(T(x[i] - best[static_cast<Index>(i - first)]));
    }
    if (rotation.size() == 0) return y;
    Vector<T> turned;
    for (Index i = 0; i < rotation.rows(); ++i) {
      T sum = T(y[0] * rotation(i, 0));
      for (Index j = 1; j < rotation.cols(); ++j) {
        sum += T(y[static_cast<std::size_t>(j)] * rotation(i, j));
      }
      turned.push_back(sum);
    }
    return turned;
  }
};

template <typename T>
T SizeOf(const T& value) {
  using std::abs;
  return T(abs(value));
}

template <typename T>
T Sum(const Vector<T>& values) {
  T sum = values[0];
  for (std::size_t i = 1; i < values.size(); ++i) sum += values[i];
  return sum;
}

template <typename T>
T SumOfSizes(const Vector<T>& values) {
  Vector<T> sizes;
  for (const T& value : values) sizes.push_back(SizeOf(value));
  return Sum(sizes);
}

struct Zdt {
  int number;
  Distances distances;

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::cos, std::exp, std::pow, std::sin;
    const auto rest = static_cast<double>(x.size() - 1);
    const Vector<T> y = distances(x);
    if (number == 4) {
      T g = T(x[0] * 0.0 + (1 + 10 * rest));
      for (const T& each : y) g += T(each * each) - T(T(cos(T(each * (4 * kPi)))) * 10.0);
      return {x[0], T(g - Root(T(x[0] * g)))};
    }
    const T mean = T(SumOfSizes(y) / rest);
    if (number == 6) {
      const T g = T(Root(Root(mean)) * 9.0 + 1.0);
      const T wave = T(sin(T(x[0] * (6 * kPi))));
      const T f = T(T(T(exp(T(x[0] * -4.0))) * T(pow(wave, 6))) * -1.0 + 1.0);
      return {f, T(g - T(T(f * f) / g))};
    }
    const T g = T(mean * 9.0 + 1.0);
    const T ratio = T(x[0] / g);
    if (number == 1) return {x[0], T(g - T(Root(T(x[0] * g))))};
    if (number == 2) return {x[0], T(g - T(x[0] * ratio))};
    return {x[0], T(g - T(Root(T(x[0] * g))) - T(x[0] * T(sin(T(x[0] * (10 * kPi))))))};
  }
};

struct Dtlz {
  int number;
  std::size_t metrics;
  Distances distances;

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    if (number == 7) return Disconnected(x);
    const T scale = T(Distance(x) + 1.0);
    if (number == 1) return OnSimplex(x, T(scale * 0.5));
    return OnSphere(scale, Angles(x, scale));
  }

  template <typename T>
  T Distance(const Vector<T>& x) const {
    using std::cos, std::pow;
    T g = T(x[0] * 0.0);
    for (const T& y : distances(x)) {
      if (number == 6) {
        const T size = SizeOf(y);
        if (size > 0) g += T(pow(size, 0.1));  // at 0 the slope is infinite
        continue;
      }
      g += T(y * y);
      if (number == 1 || number == 3) g += T(T(T(cos(T(y * (20 * kPi)))) * -1.0) + 1.0);
    }
    return number == 1 || number == 3 ? T(g * 100.0) : g;
  }

  template <typename T>
  Vector<T> OnSimplex(const Vector<T>& x, const T& half) const {
    Vector<T> f(metrics, half);
    T product = half;
    for (std::size_t i = 0; i + 1 < metrics; ++i) {
      const T next = T(product * x[i]);
      f[metrics - 1 - i] = T(product - next);
      product = next;
    }
    f[0] = product;
    return f;
  }

  template <typename T>
  Vector<T> Angles(const Vector<T>& x, const T& scale) const {
    using std::pow;
    Vector<T> angles;
    for (std::size_t i = 0; i + 1 < metrics; ++i) {
      if (number == 4) {
        angles.push_back(T(T(pow(x[i], 100)) * (kPi / 2)));
      } else if (number >= 5 && i > 0) {
        // One curve as the distance vanishes.
        angles.push_back(T(T(T(T(T(scale - 1.0) * x[i]) * 2.0 + 1.0) / scale) * (kPi / 4)));
      } else {
        angles.push_back(T(x[i] * (kPi / 2)));
      }
    }
    return angles;
  }

  template <typename T>
  Vector<T> OnSphere(const T& scale, const Vector<T>& angles) const {
    using std::cos, std::sin;
    Vector<T> f(metrics, scale);
    T ring = scale;
    for (std::size_t i = 0; i + 1 < metrics; ++i) {
      f[metrics - 1 - i] = T(ring * T(sin(angles[i])));
      ring = T(ring * T(cos(angles[i])));
    }
    f[0] = ring;
    return f;
  }

  template <typename T>
  Vector<T> Disconnected(const Vector<T>& x) const {
    using std::sin;
    const Vector<T> y = distances(x);
    const T g = T(SumOfSizes(y) * (9.0 / static_cast<double>(y.size())) + 1.0);
    T last = T(T(g + 1.0) * static_cast<double>(metrics));
    Vector<T> f;
    for (std::size_t i = 0; i + 1 < metrics; ++i) {
      last -= T(x[i] * T(T(sin(T(x[i] * (3 * kPi)))) + 1.0));
      f.push_back(x[i]);
    }
    f.push_back(last);
    return f;
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
    for (const T& value : x) {
      second += T(pow(T(abs(value)), 0.8)) + T(T(sin(T(value * value * value))) * 5.0);
    }
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
      for (std::size_t i = 0; i < x.size(); ++i) {
        for (int k = 0; k < kTerms; ++k) {
          const auto row = static_cast<Index>(i);
          sum += T(T(sin(T(x[i] * (k + 1.0) + phase[j](row, k)))) * amplitude[j](row, k));
        }
      }
      metrics.push_back(sum);
    }
    return metrics;
  }
};

// Two metrics, then g1 <= 0 and g2 <= 0.
struct Bnh {
  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    const T a = x[0], b = x[1];
    return {T(4.0 * a * a + 4.0 * b * b), T((a - 5.0) * (a - 5.0) + (b - 5.0) * (b - 5.0)),
            T((a - 5.0) * (a - 5.0) + b * b - 25.0),
            T(7.7 - (a - 8.0) * (a - 8.0) - (b + 3.0) * (b + 3.0))};
  }
};

struct Srn {
  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    const T a = x[0], b = x[1];
    return {T(2.0 + (a - 2.0) * (a - 2.0) + (b - 1.0) * (b - 1.0)),
            T(9.0 * a - (b - 1.0) * (b - 1.0)), T(a * a + b * b - 225.0), T(a - 3.0 * b + 10.0)};
  }
};

struct Tnk {
  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::atan2;
    using std::cos;
    const T a = x[0], b = x[1];
    return {a, b, T(1.0 + 0.1 * cos(T(16.0 * atan2(a, b))) - a * a - b * b),
            T((a - 0.5) * (a - 0.5) + (b - 0.5) * (b - 0.5) - 0.5)};
  }
};

struct Osy {
  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    const auto square = [](const T& t) { return T(t * t); };
    T squares = T(x[0] * 0.0);
    for (const T& t : x) squares += square(t);
    return {T(-25.0 * square(x[0] - 2.0) - square(x[1] - 2.0) - square(x[2] - 1.0) -
              square(x[3] - 4.0) - square(x[4] - 1.0)),
            squares,
            T(2.0 - x[0] - x[1]),
            T(x[0] + x[1] - 6.0),
            T(x[1] - x[0] - 2.0),
            T(x[0] - 3.0 * x[1] - 2.0),
            T(square(x[2] - 3.0) + x[3] - 4.0),
            T(4.0 - square(x[4] - 3.0) - x[5])};
  }
};

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

// The published optimum of every distance parameter is `best`.
Distances MakeDistances(const DesignSpace& space, std::size_t first, double best,
                        const BenchmarkVariant& variant) {
  const Index count = space.size() - static_cast<Index>(first);
  Distances distances{first, VectorXd::Constant(count, best), {}};
  Random random(variant.instance);
  if (variant.shifted) {
    for (Index i = 0; i < count; ++i) {
      const Index at = i + static_cast<Index>(first);
      distances.best[i] =
          space.lower[at] + (0.3 + 0.4 * random.Uniform()) * (space.upper[at] - space.lower[at]);
    }
  }
  if (!variant.rotated) return distances;
  MatrixXd columns(count, count);
  for (Index i = 0; i < count; ++i) columns.col(i) = random.UnitVector(count);
  distances.rotation = columns.householderQr().householderQ() * MatrixXd::Identity(count, count);
  return distances;
}

std::string VariantName(const std::string& name, const BenchmarkVariant& variant) {
  return absl::StrCat(variant.rotated ? "rotated " : "", variant.shifted ? "shifted " : "", name);
}

BenchmarkProblem MakeZdt(int number, int dimensions, const BenchmarkVariant& variant) {
  DesignSpace space = Box(dimensions, 0, 1);
  if (number == 4) {
    space.lower.tail(dimensions - 1).setConstant(-5);
    space.upper.tail(dimensions - 1).setConstant(5);
  }
  const Zdt formula{number, MakeDistances(space, 1, 0, variant)};
  return {VariantName(absl::StrCat("ZDT", number), variant),
          space,
          2,
          0,
          Evaluating(formula, 2),
          VectorXd::Constant(2, 1.1),
          ZdtHypervolume(number)};
}

// Below the reference point, but for what is under the true front.
double DtlzHypervolume(int number, const VectorXd& reference) {
  const auto d = static_cast<int>(reference.size());
  const double r = reference[0], box = std::pow(r, d);
  const double half = 0.5 * d;
  if (number == 1) return box - std::pow(0.5, d) / std::tgamma(d + 1.0);
  if (number <= 4 || (number <= 6 && d == 2)) {  // a ball's part where all are positive
    return box - std::pow(kPi, half) / std::tgamma(half + 1) / std::pow(2.0, d);
  }
  if (number <= 6 && d == 3) {  // over slices of the third metric, f1 = f2 = sqrt((1 - f3^2) / 2)
    return r * r - r * kPi / (2 * std::sqrt(2.0)) + 1.0 / 3 + (r - 1) * r * r;
  }
  if (number <= 6) return 0;  // more than the curve is optimal
  // The last metric is 2 d - M(f1) - M(f2) - ... along the front, with M the greatest
  // f (1 + sin(3 pi f)) up to there.
  constexpr int kSteps = 100'000;
  double most = 0, integral = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double f = (i + 0.5) / kSteps;
    most = std::max(most, f * (1 + std::sin(3 * kPi * f)));
    integral += most / kSteps;
  }
  integral += (r - 1) * most;
  return std::pow(r, d - 1) * (reference[d - 1] - 2 * d) + (d - 1) * std::pow(r, d - 2) * integral;
}

absl::StatusOr<BenchmarkProblem> MakeDtlz(int number, int dimensions,
                                          const BenchmarkVariant& variant) {
  const int metrics = variant.metrics == 0 ? 3 : variant.metrics;
  if (dimensions < metrics) {
    return InvalidField("dimensions", absl::StrCat("DTLZ problems of ", metrics,
                                                   " metrics need at least ", metrics));
  }
  const DesignSpace space = Box(dimensions, 0, 1);
  VectorXd reference = VectorXd::Constant(metrics, number == 1 ? 0.55 : 1.1);
  if (number == 7) reference[metrics - 1] = 2.2 * metrics;
  const auto position = static_cast<std::size_t>(metrics - 1);
  const Dtlz formula{number, static_cast<std::size_t>(metrics),
                     MakeDistances(space, position, number >= 6 ? 0 : 0.5, variant)};
  return BenchmarkProblem{VariantName(absl::StrCat("DTLZ", number), variant),
                          space,
                          metrics,
                          0,
                          Evaluating(formula, metrics),
                          reference,
                          DtlzHypervolume(number, reference)};
}

absl::StatusOr<BenchmarkProblem> MakeFourier(int dimensions, const BenchmarkVariant& variant) {
  const int metrics = variant.metrics == 0 ? 2 : variant.metrics;
  return BenchmarkProblem{"Fourier",
                          Box(dimensions, 0, 2 * kPi),
                          metrics,
                          0,
                          Evaluating(Fourier(dimensions, metrics, variant.instance), metrics),
                          VectorXd::Constant(metrics, 2.0 * dimensions),
                          0};
}

// The hypervolume of a front of two metrics that consists of curves of designs.
template <typename Formula>
double HypervolumeOf(const std::vector<std::function<Vector<double>(double)>>& curves,
                     const Formula& formula, const VectorXd& reference) {
  constexpr int kSteps = 30'000;
  std::vector<VectorXd> front;
  for (const auto& curve : curves) {
    for (int i = 0; i <= kSteps; ++i) {
      const Vector<double> values = formula(curve(static_cast<double>(i) / kSteps));
      const bool feasible =
          std::all_of(values.begin() + 2, values.end(), [](double g) { return g <= 1e-9; });
      if (feasible) front.push_back(Eigen::Vector2d(values[0], values[1]));
    }
  }
  return Hypervolume(front, reference);
}

BenchmarkProblem MakeBnh() {
  const Eigen::Vector2d reference(140, 50);
  const double hypervolume = HypervolumeOf({[](double t) {
                                              return Vector<double>{3 * t, 3 * t};
                                            },
                                            [](double t) {
                                              return Vector<double>{3 + 2 * t, 3};
                                            }},
                                           Bnh{}, reference);
  return {"BNH",
          {Eigen::Vector2d::Zero(), Eigen::Vector2d(5, 3)},
          2,
          2,
          Evaluating(Bnh{}, 2),
          reference,
          hypervolume};
}

// Along the second constraint from where f1 is least, between both constraints where x1 = -2.5, and
// along the first to where f2 is least.
BenchmarkProblem MakeSrn() {
  const Eigen::Vector2d reference(250, 50);
  const double top = std::sqrt(225 - 2.5 * 2.5);
  const double hypervolume = HypervolumeOf({[](double t) {
                                              const double x = 1.1 - 3.6 * t;
                                              return Vector<double>{x, (x + 10) / 3};
                                            },
                                            [top](double t) {
                                              return Vector<double>{-2.5, 2.5 + t * (top - 2.5)};
                                            },
                                            [](double t) {
                                              const double x = -2.5 - 3 * t;
                                              return Vector<double>{x, std::sqrt(225 - x * x)};
                                            }},
                                           Srn{}, reference);
  return {"SRN", Box(2, -20, 20), 2, 2, Evaluating(Srn{}, 2), reference, hypervolume};
}

// Along the boundary of the first constraint, r^2 = 1 + cos(16 angle) / 10.
BenchmarkProblem MakeTnk() {
  const Eigen::Vector2d reference(1.2, 1.2);
  const double hypervolume = HypervolumeOf(
      {[](double t) {
        const double angle = t * kPi / 2, r = std::sqrt(1 + 0.1 * std::cos(16 * angle));
        return Vector<double>{r * std::sin(angle), r * std::cos(angle)};
      }},
      Tnk{}, reference);
  return {"TNK", Box(2, 0, kPi), 2, 2, Evaluating(Tnk{}, 2), reference, hypervolume};
}

// Five stretches, each with one parameter between what constraints and bounds allow (Deb 2001);
// those of the third and fifth parameter over all of their ranges.
BenchmarkProblem MakeOsy() {
  const Eigen::Vector2d reference(0, 80);
  const double hypervolume =
      HypervolumeOf({[](double t) { return Vector<double>{5, 1, 1 + 4 * t, 0, 5, 0}; },
                     [](double t) { return Vector<double>{5, 1, 1 + 4 * t, 0, 1, 0}; },
                     [](double t) { return Vector<double>{2 + 3 * t, t, 1, 0, 1, 0}; },
                     [](double t) { return Vector<double>{0, 2, 1 + 4 * t, 0, 1, 0}; },
                     [](double t) { return Vector<double>{2 * t, 2 - 2 * t, 1, 0, 1, 0}; }},
                    Osy{}, reference);
  VectorXd lower(6), upper(6);
  lower << 0, 0, 1, 0, 1, 0;
  upper << 10, 10, 5, 6, 5, 10;
  return {"OSY", {lower, upper}, 2, 6, Evaluating(Osy{}, 2), reference, hypervolume};
}

}  // namespace

std::vector<std::string> BenchmarkNames() {
  std::vector<std::string> names = {"ZDT1",    "ZDT2",    "ZDT3",  "ZDT4",  "ZDT6",  "DTLZ1",
                                    "DTLZ2",   "DTLZ3",   "DTLZ4", "DTLZ5", "DTLZ6", "DTLZ7",
                                    "Kursawe", "Fourier", "BNH",   "SRN",   "TNK",   "OSY"};
  for (const std::string& winding : WindingNames()) names.push_back(winding);
  for (const std::string& mixed : MixedNames()) names.push_back(mixed);
  return names;
}

int PublishedDimensions(const std::string& name, int metrics) {
  const std::string lower = absl::AsciiStrToLower(name);
  const int position = (metrics == 0 ? 3 : metrics) - 1;  // parameters of DTLZ
  if (lower == "zdt4" || lower == "zdt6") return 10;
  if (lower.starts_with("zdt")) return 30;
  if (lower == "dtlz1") return position + 5;
  if (lower == "dtlz7") return position + 20;
  if (lower.starts_with("dtlz")) return position + 10;
  if (lower == "bnh" || lower == "srn" || lower == "tnk") return 2;
  if (lower == "osy") return 6;
  if (WindingDimensions(lower) > 0) return WindingDimensions(lower);
  return lower == "kursawe" || lower == "fourier" ? 3 : MixedDimensions(lower);
}

absl::StatusOr<BenchmarkProblem> MakeBenchmarkProblem(const std::string& name, int dimensions,
                                                      const BenchmarkVariant& variant) {
  const std::string lower = absl::AsciiStrToLower(name);
  if (dimensions < 1 || dimensions > 512) {
    return InvalidField("dimensions", "must lie between 1 and 512");
  }
  if (variant.metrics != 0 && lower != "fourier" && !lower.starts_with("dtlz")) {
    return InvalidField("metrics", "can be chosen for DTLZ and Fourier problems only");
  }
  if (variant.metrics != 0 && (variant.metrics < 2 || variant.metrics > kMaxMetrics)) {
    return InvalidField("metrics", absl::StrCat("must lie between 2 and ", kMaxMetrics));
  }
  for (const int number : {1, 2, 3, 4, 6}) {
    if (lower != absl::StrCat("zdt", number)) continue;
    if (dimensions < 2) return InvalidField("dimensions", "ZDT problems need at least 2");
    return MakeZdt(number, dimensions, variant);
  }
  for (int number = 1; number <= 7; ++number) {
    if (lower != absl::StrCat("dtlz", number)) continue;
    return MakeDtlz(number, dimensions, variant);
  }
  if (PublishedDimensions(lower) == 0 || lower.starts_with("zdt") || lower.starts_with("dtlz")) {
    return InvalidField("name", absl::StrCat("no benchmark problem '", name, "'; there are ",
                                             absl::StrJoin(BenchmarkNames(), ", ")));
  }
  if (variant.shifted || variant.rotated) {
    return InvalidField("variant", "only ZDT and DTLZ problems can be shifted or rotated");
  }
  if (lower == "fourier") return MakeFourier(dimensions, variant);
  if (WindingDimensions(lower) > 0) return MakeWindingProblem(name, dimensions);
  if (MixedDimensions(lower) > 0) return MakeMixedProblem(name, dimensions);
  if (dimensions != PublishedDimensions(lower)) {
    return InvalidField("dimensions", absl::StrCat(name, " has ", PublishedDimensions(lower)));
  }
  if (lower == "bnh") return MakeBnh();
  if (lower == "srn") return MakeSrn();
  if (lower == "tnk") return MakeTnk();
  if (lower == "osy") return MakeOsy();
  return BenchmarkProblem{
      "Kursawe",          Box(3, -5, 5), 2, 0, Evaluating(Kursawe{}, 2), Eigen::Vector2d(-14, 1),
      kKursaweHypervolume};
}

}  // namespace mortise::pareto
