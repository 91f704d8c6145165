// The Fourier benchmark of the thesis (Eq. 7.7; D = 3, K = 3): how far the points of our fronts are
// from the true one (Eq. 7.8, in the manner of Figure 7-9), and how many pieces they have, beside
// fronts by brute force.
//
// A row for each instance: points of our front; the share of them below 1e-5, and the worst; our
// pieces, and how many of them are affine; the brute force's stretches of continuous designs, and
// for two metrics the straight lines that these take; and the hypervolume of our archive, and of
// our pieces evaluated densely, over that of the brute force's points.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <vector>

#include "absl/strings/str_format.h"
#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/front/front_error.h"
#include "services/pareto/front/piece_evaluation.h"
#include "tests/bench/pareto/benchmark_run.h"
#include "tests/bench/services/pareto/front/brute_force_front.h"

namespace mortise::pareto {
namespace {

struct Selection {
  int instances = 3;
  std::int64_t evaluations = 10'000;
  std::vector<int> metrics = {2, 3};
  int grid = 64;
};

// Up to the reference (1.1, ...) of the brute force's scaling.
double ScaledVolume(const std::vector<Eigen::VectorXd>& metrics, const Scaling& scaling) {
  std::vector<Eigen::VectorXd> scaled;
  for (const Eigen::VectorXd& each : metrics) scaled.push_back(scaling.Apply(each));
  return Hypervolume(scaled, Eigen::VectorXd::Constant(scaling.ideal.size(), 1.1));
}

void PrintInstance(const Selection& selection, int metrics, int instance) {
  BenchmarkVariant variant;
  variant.instance = static_cast<std::uint64_t>(instance);
  variant.metrics = metrics;
  const BenchmarkProblem problem = *MakeBenchmarkProblem("Fourier", 3, variant);
  Discovery::Options options;
  options.evaluations = selection.evaluations;
  options.seed = variant.instance;
  options.stall_tracks = 0;
  const BenchmarkResult result = *RunBenchmark(problem, options, false);
  const std::vector<double> errors =
      FrontErrors(problem.space, result.front,
                  [&](const Eigen::VectorXd& x) { return problem.evaluate(x, true); });
  const PieceEvaluation dense =
      EvaluatePieces(problem.space, result.front,
                     [&](const Eigen::VectorXd& x) { return problem.evaluate(x, false); });
  const BruteForceFront brute = FindByBruteForce(problem, selection.grid);
  const double volume = Hypervolume(brute.performance, Eigen::VectorXd::Constant(metrics, 1.1));
  const std::vector<int> stretches = StretchesOf(brute);
  std::vector<Eigen::VectorXd> archive;
  for (const BenchmarkPoint& point : result.non_dominated) archive.push_back(point.metrics);
  const auto below = std::ranges::count_if(errors, [](double error) { return error < 1e-5; });
  const auto affine = std::ranges::count_if(
      result.front.pieces, [](const FrontPiece& piece) { return piece.directions.cols() > 0; });
  std::cout << absl::StrFormat("%7d %8d %6d %9.2f%% %8.1e %7d %7d %10d %8d %9.5f %9.5f\n", metrics,
                               instance, errors.size(),
                               100.0 * static_cast<double>(below) / errors.size(),
                               std::ranges::max(errors), result.front.pieces.size(), affine,
                               stretches.empty() ? 0 : std::ranges::max(stretches) + 1,
                               CountStraightPieces(problem, brute),
                               ScaledVolume(archive, brute.scaling) / volume,
                               ScaledVolume(dense.metrics, brute.scaling) / volume)
            << std::flush;
}

}  // namespace
}  // namespace mortise::pareto

int main(int argc, char** argv) {
  mortise::pareto::Selection selection;
  CLI::App app("Fronts of the Fourier benchmark, held against what brute force finds");
  app.allow_extras();  // what `./dev bench` has for other benches
  app.add_option("--instances", selection.instances, "How many, from 1")
      ->check(CLI::PositiveNumber);
  app.add_option("--evaluations", selection.evaluations, "Budget")->check(CLI::PositiveNumber);
  app.add_option("--metrics", selection.metrics, "2 or 3, or both")->check(CLI::Range(2, 3));
  app.add_option("--grid", selection.grid, "Brute force's designs along each parameter")
      ->check(CLI::Range(8, 256));
  CLI11_PARSE(app, argc, argv);
  std::cout << "metrics instance points below1e-5    worst  pieces  affine  stretches straight "
               "  archive     dense\n";
  for (const int metrics : selection.metrics) {
    for (int instance = 1; instance <= selection.instances; ++instance) {
      mortise::pareto::PrintInstance(selection, metrics, instance);
    }
  }
  return 0;
}
