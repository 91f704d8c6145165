// What a map costs and how exact it is: functions of three and six parameters at 60 to 780 points
// (probes counted), beside multi-linear interpolation of the same samples and the published figures
// of Tasmanian's adaptive sparse grids; and how fast one is evaluated.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <vector>

#include "common/base/random.h"
#include "common/maps/interpolation_map.h"
#include "common/maps/map_sampling.h"

namespace mortise::maps {
namespace {

struct Function {
  const char* name;
  int dimension;
  double (*value)(const Eigen::VectorXd&);
  // Largest errors of Tasmanian's grids at points near 60, 100, 260, 780, as published with their
  // numbers of points; empty where there are none.
  const char* linear_peer[4];
  const char* cubic_peer[4];
};

double A(const Eigen::VectorXd& x) {
  return std::sin(2 * x[0] + .5) * std::exp(-x[1]) + .5 * std::cos(3 * x[2] + x[0] * x[1]);
}

double B(const Eigen::VectorXd& x) {
  return .02 /
         (.02 + std::pow(x[0] - .3, 2) + std::pow(x[1] - .6, 2) + .3 * std::pow(x[2] - .5, 2));
}

double Kink(const Eigen::VectorXd& x) { return std::abs(x[0] + .7 * x[1] + .5 * x[2] - 1.1); }

double Six(const Eigen::VectorXd& x) {
  return std::exp(-x[0]) * std::sin(2 * x[1] + .5) + .3 * x[2] * x[2] +
         .5 / (1 + 2 * x[3] + x[4] * x[4]) + .2 * std::cos(3 * x[5] + x[0] * x[2]);
}

const Function kFunctions[] = {
    {"A",
     3,
     A,
     {".061 (61)", ".013 (123)", ".006 (254)", ".0007 (968)"},
     {".026 (65)", ".003 (105)", ".0002 (329)", ""}},
    {"B", 3, B, {"", ".44 (135)", ".074 (276)", ".034 (633)"}, {"", "", "", ""}},
    {"kink", 3, Kink, {"", "", "", ""}, {"", "", "", ""}},
    {"six", 6, Six, {"", "", "", ""}, {"", "", "", ""}},
};

constexpr int kBudgets[] = {60, 100, 260, 780};
constexpr int kPoints = 5000;

MapContent Sample(const Function& function, Basis basis, int budget, int round_points = 1) {
  MapSamplingOptions options;
  options.basis = basis;
  options.budget = std::max(budget, (1 << function.dimension) + 2);
  options.round_points = round_points;
  auto sampling = *MapSampling::Create(function.dimension, 1, options);
  while (!sampling.Done()) {
    for (const AskedPoint& asked : sampling.Ask(1000)) {
      const Eigen::VectorXd value = Eigen::VectorXd::Constant(1, function.value(asked.position));
      if (!sampling.Tell(asked.number, value).ok()) std::abort();
    }
  }
  return *sampling.Content();
}

// Multi-linear interpolation of the corners of the element that the point lies in.
double MultiLinear(const RefinementTree& tree, const MapContent& content, int element,
                   const Eigen::VectorXd& point) {
  const LatticeBox& box = tree.LatticeBoxOf(element);
  const int dimension = tree.dimension();
  double sum = 0;
  for (int corner = 0; corner < 1 << dimension; ++corner) {
    LatticePoint position{};
    double weight = 1;
    for (int d = 0; d < dimension; ++d) {
      const double along = (point[d] - ToUnit(box.low[d])) / ToUnit(box.high[d] - box.low[d]);
      const bool upper = (corner >> d & 1) != 0;
      position[d] = upper ? box.high[d] : box.low[d];
      weight *= upper ? along : 1 - along;
    }
    sum += weight * content.values(0, tree.elements().FindSample(position));
  }
  return sum;
}

struct Accuracy {
  double largest = 0, mean = 0;
  double linear_largest = 0, linear_mean = 0;  // of multi-linear
  double jump = 0, linear_jump = 0;            // across faces
  double within = 0;                           // share of points within the stated error
};

// Jumps are looked for across the faces of all elements.
void MeasureJumps(const InterpolationMap& map, double range, Accuracy& accuracy) {
  Random random(7);
  const RefinementTree& tree = map.tree();
  for (const int element : tree.Elements()) {
    const ElementBox box = tree.BoxOf(element);
    for (int d = 0; d < tree.dimension(); ++d) {
      if (box.low[d] == 0) continue;
      for (int n = 0; n < 8; ++n) {
        Eigen::VectorXd point(tree.dimension());
        for (int k = 0; k < tree.dimension(); ++k) {
          point[k] = box.low[k] + random.Uniform() * (box.high[k] - box.low[k]);
        }
        point[d] = box.low[d];
        Eigen::VectorXd below = point;
        below[d] = std::nextafter(point[d], 0.0);
        const int other = tree.Locate(below);
        const double jump = std::abs(map.Evaluate(point).values(0) - map.Evaluate(below).values(0));
        const double linear = std::abs(MultiLinear(tree, map.content(), element, point) -
                                       MultiLinear(tree, map.content(), other, point));
        accuracy.jump = std::max(accuracy.jump, jump / range);
        accuracy.linear_jump = std::max(accuracy.linear_jump, linear / range);
      }
    }
  }
}

Accuracy Measure(const Function& function, const InterpolationMap& map) {
  Random random(2026);
  Accuracy accuracy;
  std::vector<double> truth, errors, linear;
  int within = 0;
  for (int n = 0; n < kPoints; ++n) {
    Eigen::VectorXd point(function.dimension);
    for (double& coordinate : point) coordinate = random.Uniform();
    truth.push_back(function.value(point));
    const MapValues values = map.Evaluate(point);
    errors.push_back(std::abs(values.values(0) - truth.back()));
    if (errors.back() <= values.errors(0)) ++within;
    const int element = map.tree().Locate(point);
    linear.push_back(
        std::abs(MultiLinear(map.tree(), map.content(), element, point) - truth.back()));
  }
  const auto [least, most] = std::minmax_element(truth.begin(), truth.end());
  const double range = *most - *least;
  for (int n = 0; n < kPoints; ++n) {
    accuracy.largest = std::max(accuracy.largest, errors[n] / range);
    accuracy.linear_largest = std::max(accuracy.linear_largest, linear[n] / range);
    accuracy.mean += errors[n] / range / kPoints;
    accuracy.linear_mean += linear[n] / range / kPoints;
  }
  accuracy.within = static_cast<double>(within) / kPoints;
  MeasureJumps(map, range, accuracy);
  return accuracy;
}

void PrintAccuracy(Basis basis) {
  std::printf("%s\n", basis == Basis::kLinear ? "linear" : "cubic");
  std::printf("Errors over the range, largest (mean), at %d seeded points\n", kPoints);
  std::printf("%-5s %6s %7s %8s  %-17s %-17s %-17s %-18s %s\n", "f", "points", "samples",
              "elements", "map", "multi-linear", "jumps", "within stated", "Tasmanian");
  for (const Function& function : kFunctions) {
    if (basis == Basis::kCubic && function.dimension > 5) continue;
    for (int n = 0; n < 4; ++n) {
      const auto begin = std::chrono::steady_clock::now();
      const MapContent content = Sample(function, basis, kBudgets[n]);
      const auto map = *InterpolationMap::Create(content);
      const double seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      const Accuracy accuracy = Measure(function, map);
      std::printf("%-5s %6d %7d %8d  %.4f (%.5f)  %.4f (%.5f)  %.0e / %.0e  %.2f  %s  %.1f s\n",
                  function.name, kBudgets[n], map.tree().sample_count(), map.tree().element_count(),
                  accuracy.largest, accuracy.mean, accuracy.linear_largest, accuracy.linear_mean,
                  accuracy.jump, accuracy.linear_jump, accuracy.within,
                  (basis == Basis::kLinear ? function.linear_peer : function.cubic_peer)[n],
                  seconds);
    }
  }
}

double Seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double Four(const Eigen::VectorXd& x) {
  return std::sin(3 * x[0] + x[1]) / (.3 + x[2] * x[2]) + std::exp(-3 * x[3]) * x[1];
}

// Points a second on one core, beside a loop that reads as many bytes from memory in a row as the
// points, their answers and the coefficients that each needs are.
void PrintSpeed(Basis basis, int budget) {
  const Function function = {"four", 4, Four, {}, {}};
  const auto map = *InterpolationMap::Create(Sample(function, basis, budget, 16));
  constexpr int kMany = 200000;
  Eigen::MatrixXd points(4, kMany);
  Random random(11);
  for (Eigen::Index n = 0; n < points.size(); ++n) points.data()[n] = random.Uniform();
  double sum = 0;
  const double values = Seconds([&] { sum += map.Evaluate(points).values.sum(); });
  const double gradients = Seconds([&] { sum += map.Evaluate(points, true).gradients.sum(); });
  const double bytes = static_cast<double>(map.BytesRead(points)) + kMany * (4 + 2) * 8.0;
  const std::vector<double> memory(1 << 24, 1.0);
  const double reading = Seconds([&] {
    for (const double number : memory) sum += number;
  });
  const double floor = bytes * reading / (8.0 * static_cast<double>(memory.size()));
  std::printf(
      "%s, K = 4, %d samples, %zu kB packed: %.2f million points a second (%.0f ns), with "
      "gradients %.2f; "
      "%.0f bytes a point take %.0f ns to read in a row: ratio %.1f (%g)\n",
      basis == Basis::kLinear ? "linear" : "cubic", map.tree().sample_count(),
      map.packed_bytes() / 1024, kMany / values / 1e6, values / kMany * 1e9,
      kMany / gradients / 1e6, bytes / kMany, floor / kMany * 1e9, values / floor, sum);
}

}  // namespace
}  // namespace mortise::maps

int main() {
  mortise::maps::PrintAccuracy(mortise::maps::Basis::kLinear);
  mortise::maps::PrintAccuracy(mortise::maps::Basis::kCubic);
  mortise::maps::PrintSpeed(mortise::maps::Basis::kLinear, 1000);
  mortise::maps::PrintSpeed(mortise::maps::Basis::kCubic, 1000);
}
