#include "tests/bench/pareto/mixed_problems.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/pareto/archive/hypervolume.h"
#include "tests/bench/pareto/benchmark_formula.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
constexpr double kPi = std::numbers::pi;

// What a choice and a whole number make of the distance parameters of ZDT and DTLZ.
struct MixedDistance {
  static constexpr int kChoices = 6, kNumbers = 8;
  // Which third of the first parameter a choice reaches; -1: none.
  static constexpr std::array<int, kChoices> kThird = {-1, 1, -1, 0, 2, -1};
  std::size_t choice = 1;  // its parameter; the whole number comes after it

  template <typename T>
  T operator()(const Vector<T>& x) const {
    const auto k = static_cast<std::size_t>(std::lround(NumberOf(x[choice])));
    const int third = kThird[k];
    T sum = T(x[0] * 0.0);
    for (std::size_t i = choice + 2; i < x.size(); ++i) {
      const T y = T(x[i] - Best(k, i));
      sum += T(y * y);
    }
    // Those that reach none of the front start from better designs.
    T distance = T(sum * ((third < 0 ? 2.0 : 9.0) / static_cast<double>(x.size() - choice - 2)));
    const T off = T(x[choice + 1] - (1.0 + static_cast<double>((3 * k + 2) % kNumbers)));
    distance += T(off * off * 0.05);
    if (third < 0) return T(distance + 0.4);
    const double at = NumberOf(x[0]);
    if (at < third / 3.0) distance += T((x[0] * -1.0 + third / 3.0) * 3.0);
    if (at > (third + 1) / 3.0) distance += T((x[0] - (third + 1) / 3.0) * 3.0);
    return distance;
  }

  // Somewhere in the middle of the range, for each choice elsewhere.
  static double Best(std::size_t k, std::size_t i) {
    const double turns = std::numbers::phi * static_cast<double>((k + 1) * (i + 3));
    return 0.2 + 0.6 * (turns - std::floor(turns));
  }
};

struct MixedZdt {
  int number;
  MixedDistance distance{1};

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::sin;
    const T g = T(distance(x) + 1.0);
    if (number == 2) return {x[0], T(g - T(T(x[0] * x[0]) / g))};
    const T second = T(g - Root(T(x[0] * g)));
    if (number == 1) return {x[0], second};
    return {x[0], T(second - T(x[0] * T(sin(T(x[0] * (10 * kPi))))))};
  }
};

struct MixedDtlz2 {
  MixedDistance distance{2};

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::cos, std::sin;
    const T scale = T(distance(x) + 1.0);
    const T theta = T(x[0] * (kPi / 2)), phi = T(x[1] * (kPi / 2));
    const T ring = T(scale * T(cos(theta)));
    return {T(ring * T(cos(phi))), T(ring * T(sin(phi))), T(scale * T(sin(theta)))};
  }
};

// Inner and outer radius (mm), force (N), friction surfaces: mass (kg) and stopping time (s).
struct DiscBrake {
  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    const T &inner = x[0], &outer = x[1], &force = x[2], &surfaces = x[3];
    const T squares = T(outer * outer - inner * inner);
    const T cubes = T(outer * outer * outer - inner * inner * inner);
    return {T(4.9e-5 * squares * (surfaces - 1.0)),
            T(9.82e6 * squares / (force * surfaces * cubes)),
            T(inner - outer + 20.0),
            T(2.5 * (surfaces + 1.0) - 30.0),
            T(force / (3.14 * squares) - 0.4),
            T(2.22e-3 * force * cubes / (squares * squares) - 1.0),
            T(900.0 - 2.66e-2 * force * surfaces * cubes / squares)};
  }
};

// The kind of weld (two or four sides), material, thickness and length of the weld, width and
// thickness of the beam (inch): cost and deflection (inch) under 6000 pound at its end.
struct WeldedBeam {
  struct Material {
    double weld_cost, beam_cost, strength, modulus, shear_modulus;  // psi
  };
  static constexpr std::array<Material, 4> kMaterials = {{{0.1047, 0.0481, 30e3, 30e6, 12e6},
                                                          {0.0489, 0.0224, 8e3, 14e6, 6e6},
                                                          {0.5235, 0.2405, 5e3, 10e6, 4e6},
                                                          {0.5584, 0.2566, 8e3, 16e6, 6e6}}};

  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::sqrt;
    constexpr double kLoad = 6000, kLength = 14;
    const bool four_sides = NumberOf(x[0]) > 0.5;
    const Material& material = kMaterials[static_cast<std::size_t>(std::lround(NumberOf(x[1])))];
    const T &h = x[2], &l = x[3], &t = x[4], &b = x[5];
    const double root = std::numbers::sqrt2;
    T area = T(root * h * l);
    T polar = T(root * h * l * ((h + t) * (h + t) * 0.25 + l * l / 12.0));
    T radius = T(0.5 * sqrt(T(l * l + (h + t) * (h + t))));
    if (four_sides) {
      area = T(root * h * (l + t));
      polar += T(root * h * t * ((h + l) * (h + l) * 0.25 + t * t / 12.0));
      const T other = T(0.5 * sqrt(T(t * t + (h + l) * (h + l))));
      if (NumberOf(other) > NumberOf(radius)) radius = other;
    }
    const T direct = T(kLoad / area);
    const T turning = T(kLoad * (kLength + 0.5 * l) * radius / polar);
    const T shear = T(sqrt(T(direct * direct + turning * turning + direct * turning * l / radius)));
    const T bending = T(6 * kLoad * kLength / (t * t * b));
    const T deflection = T(4 * kLoad * std::pow(kLength, 3) / material.modulus / (t * t * t * b));
    const T buckling =
        T(4.013 * std::sqrt(material.modulus * material.shear_modulus) / (6 * kLength * kLength) *
          t * b * b * b *
          (1.0 - t * (std::sqrt(material.modulus / material.shear_modulus) / (4 * kLength))));
    const T welded = four_sides ? T(l + t) : l;
    return {
        T((1 + material.weld_cost) * welded * h * h + material.beam_cost * t * b * (kLength + l)),
        deflection,
        T(shear / (0.577 * material.strength) - 1.0),
        T(bending / material.strength - 1.0),
        T(b - h),
        T(1.0 - buckling / kLoad),
        T(deflection / 0.25 - 1.0)};
  }
};

// Teeth of the driving and the driven gears: by how much x1 x2 / (x3 x4) misses 1 / 6.931, and the
// largest gear. The square of the published problem would hide all but the worst in a hypervolume.
struct GearTrain {
  template <typename T>
  Vector<T> operator()(const Vector<T>& x) const {
    using std::abs;
    const T off = T(x[0] * x[1] / (x[2] * x[3]) - 1 / 6.931);
    T largest = x[0];
    for (const T& teeth : x) {
      if (NumberOf(teeth) > NumberOf(largest)) largest = teeth;
    }
    return {T(abs(off)), largest};
  }
};

// Every number of surfaces, over a grid of radii; with the largest force allowed, as the brake then
// stops earliest.
double DiscBrakeHypervolume(const VectorXd& reference) {
  std::vector<VectorXd> front;
  const DiscBrake formula;
  constexpr int kSteps = 200;
  for (double n = 2; n <= 11; ++n) {
    for (int i = 0; i <= kSteps; ++i) {
      for (int k = 0; k <= kSteps; ++k) {
        const double inner = 55 + 25.0 * i / kSteps;
        const double outer = inner + 20 + (110 - 20 - inner) * k / kSteps;
        const double squares = outer * outer - inner * inner;
        const double cubes = std::pow(outer, 3) - std::pow(inner, 3);
        const double force =
            std::min({3000.0, 0.4 * 3.14 * squares, squares * squares / (2.22e-3 * cubes)});
        const Vector<double> values = formula(Vector<double>{inner, outer, force, n});
        const bool feasible = force >= 1000 && values[6] <= 0;
        if (feasible) front.push_back(Eigen::Vector2d(values[0], values[1]));
      }
    }
  }
  return Hypervolume(front, reference);
}

double GearTrainHypervolume(const VectorXd& reference) {
  std::vector<VectorXd> front;
  for (int largest = 12; largest <= 60; ++largest) {
    double least = std::numeric_limits<double>::infinity();
    for (int a = 12; a <= largest; ++a) {
      for (int b = a; b <= largest; ++b) {
        for (int c = 12; c <= largest; ++c) {
          // The driven gear that makes the ratio nearest, rounded either way.
          const double wanted = 6.931 * a * b / c;
          for (const double d : {std::floor(wanted), std::ceil(wanted)}) {
            const double teeth = std::clamp(d, 12.0, static_cast<double>(largest));
            least = std::min(least, std::abs(a * b / (c * teeth) - 1 / 6.931));
          }
        }
      }
    }
    front.push_back(Eigen::Vector2d(least, largest));
  }
  return Hypervolume(front, reference);
}

// Of the published ZDT and DTLZ problems.
double PublishedHypervolume(const std::string& name, int dimensions) {
  return MakeBenchmarkProblem(name, dimensions)->hypervolume;
}

template <typename Formula>
BenchmarkProblem MixedProblem(const std::string& name, const std::string& published,
                              const Formula& formula, int dimensions, Index d) {
  DesignSpace space{VectorXd::Zero(dimensions), VectorXd::Ones(dimensions),
                    VectorXd::Zero(dimensions)};
  const auto choice = static_cast<Index>(formula.distance.choice);
  space.upper[choice] = MixedDistance::kChoices - 1;
  space.lower[choice + 1] = 1;
  space.upper[choice + 1] = MixedDistance::kNumbers;
  space.step[choice] = space.step[choice + 1] = 1;
  BenchmarkProblem problem{name,
                           space,
                           d,
                           0,
                           Evaluating(formula, d),
                           VectorXd::Constant(d, 1.1),
                           PublishedHypervolume(published, dimensions)};
  problem.choices = {{choice, {0, 1, 2, 3, 4, 5}}};
  return problem;
}

BenchmarkProblem MakeDiscBrake() {
  const Eigen::Vector2d reference(3, 20);
  return {"DiscBrake",
          {Eigen::Vector4d(55, 75, 1000, 2), Eigen::Vector4d(80, 110, 3000, 20),
           Eigen::Vector4d(0, 0, 0, 1)},
          2,
          5,
          Evaluating(DiscBrake{}, 2),
          reference,
          DiscBrakeHypervolume(reference)};
}

// Against (40, 0.02): of all plates and kinds, a fine grid of widths, and the shortest weld that
// holds.
constexpr double kWeldedBeamHypervolume = 0.741522;

BenchmarkProblem MakeWeldedBeam() {
  VectorXd lower(6), upper(6), step(6);
  lower << 0, 0, 0.0625, 0.1, 2, 0.0625;
  upper << 1, 3, 2, 10, 20, 2;
  step << 1, 1, 0.0625, 0, 0, 0.0625;
  BenchmarkProblem problem{"WeldedBeam",
                           {lower, upper, step},
                           2,
                           5,
                           Evaluating(WeldedBeam{}, 2),
                           Eigen::Vector2d(40, 0.02),
                           kWeldedBeamHypervolume};
  problem.choices = {{0, {0, 1}}, {1, {0, 1, 2, 3}}};
  return problem;
}

BenchmarkProblem MakeGearTrain() {
  const Eigen::Vector2d reference(0.2, 61);
  return {"GearTrain",
          {VectorXd::Constant(4, 12), VectorXd::Constant(4, 60), VectorXd::Constant(4, 1)},
          2,
          0,
          Evaluating(GearTrain{}, 2),
          reference,
          GearTrainHypervolume(reference)};
}

}  // namespace

std::vector<std::string> MixedNames() {
  return {"MixedZDT1", "MixedZDT2",  "MixedZDT3", "MixedDTLZ2",
          "DiscBrake", "WeldedBeam", "GearTrain"};
}

int MixedDimensions(const std::string& name) {
  const std::string lower = absl::AsciiStrToLower(name);
  if (lower == "mixedzdt1" || lower == "mixedzdt2" || lower == "mixedzdt3") return 10;
  if (lower == "mixeddtlz2") return 10;
  if (lower == "discbrake" || lower == "geartrain") return 4;
  return lower == "weldedbeam" ? 6 : 0;
}

absl::StatusOr<BenchmarkProblem> MakeMixedProblem(const std::string& name, int dimensions) {
  const std::string lower = absl::AsciiStrToLower(name);
  const int usual = MixedDimensions(lower);
  if (usual == 0) return absl::NotFoundError(absl::StrCat("no benchmark problem '", name, "'"));
  for (const int number : {1, 2, 3}) {
    if (lower != absl::StrCat("mixedzdt", number)) continue;
    if (dimensions < 4) return InvalidField("dimensions", "mixed ZDT problems need at least 4");
    return MixedProblem(absl::StrCat("MixedZDT", number), absl::StrCat("ZDT", number),
                        MixedZdt{number}, dimensions, 2);
  }
  if (lower == "mixeddtlz2") {
    if (dimensions < 5) return InvalidField("dimensions", "MixedDTLZ2 needs at least 5");
    return MixedProblem("MixedDTLZ2", "DTLZ2", MixedDtlz2{}, dimensions, 3);
  }
  if (dimensions != usual) return InvalidField("dimensions", absl::StrCat(name, " has ", usual));
  if (lower == "discbrake") return MakeDiscBrake();
  if (lower == "geartrain") return MakeGearTrain();
  return MakeWeldedBeam();
}

}  // namespace mortise::pareto
