// `mortise-pareto-benchmark`, which `mortise pareto benchmark` becomes: discovery on published
// problems, in this process. It needs no house.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/client/decimal_flags.h"
#include "cli/client/field_sources.h"
#include "cli/client/program.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/front/front_error.h"
#include "services/pareto/front/front_files.h"
#include "services/pareto/front/piece_evaluation.h"
#include "tests/bench/pareto/benchmark_run.h"

namespace mortise::cli {
namespace {

using Json = nlohmann::ordered_json;

struct BenchmarkOptions {
  std::string name;
  int dimensions = 0;  // 0: as published
  std::int64_t evaluations = 1000;
  std::uint64_t seed = 1;
  int window = 8;
  bool gradients = false;
  bool rounded = false;  // choices and whole numbers, as parameters like others
  std::string surrogate = "auto";
  std::filesystem::path out;
  bool dense = false;
  bool front_error = false;
  pareto::BenchmarkVariant variant;
};

// What the pieces of the front say between their points.
struct DenseResult {
  std::int64_t evaluations = 0;
  double hypervolume = 0;
};

DenseResult EvaluateDensely(const pareto::BenchmarkProblem& problem, const pareto::Front& front) {
  const pareto::PieceEvaluation pieces = pareto::EvaluatePieces(
      problem.space, front, [&](const Eigen::VectorXd& x) { return problem.evaluate(x, false); });
  return {pieces.evaluations, pareto::Hypervolume(pieces.metrics, problem.reference)};
}

// How far the points of the front are from the true one.
struct ErrorResult {
  static constexpr int kDecades = 9;
  std::array<int, kDecades> decades{};  // below 1e-10, from there below 1e-9, ..., 1e-3 or more
  int points = 0;                       // whose error could be measured
  int below = 0;                        // 1e-5
  double worst = 0;
};

ErrorResult MeasureErrors(const pareto::BenchmarkProblem& problem, const pareto::Front& front) {
  ErrorResult result;
  for (const double error :
       pareto::FrontErrors(problem.space, front,
                           [&](const Eigen::VectorXd& x) { return problem.evaluate(x, true); })) {
    if (std::isnan(error)) continue;
    ++result.points;
    result.below += error < 1e-5 ? 1 : 0;
    result.worst = std::max(result.worst, error);
    const double decade =
        std::floor(std::log10(std::max(error, 1e-11))) + ErrorResult::kDecades + 2;
    ++result
          .decades[static_cast<std::size_t>(std::clamp(decade, 0.0, ErrorResult::kDecades - 1.0))];
  }
  return result;
}

double ShareBelow(const ErrorResult& errors) {
  return static_cast<double>(errors.below) / std::max(1, errors.points);
}

struct Measured {
  pareto::BenchmarkResult discovery;
  std::optional<DenseResult> dense;
  std::optional<ErrorResult> errors;
};

std::vector<double> Numbers(const Eigen::VectorXd& vector) {
  return {vector.begin(), vector.end()};
}

Json KnownOrNull(double value, bool known) { return known ? Json(value) : Json(nullptr); }

pareto::Discovery::Surrogate SurrogateOf(const std::string& name) {
  if (name == "always") return pareto::Discovery::Surrogate::kAlways;
  if (name == "never") return pareto::Discovery::Surrogate::kNever;
  return pareto::Discovery::Surrogate::kAutomatic;
}

Json DocumentOf(const BenchmarkOptions& options, const pareto::BenchmarkProblem& problem,
                const Measured& measured) {
  const pareto::BenchmarkResult& result = measured.discovery;
  const bool known = problem.hypervolume > 0;
  Json document;
  document["problem"] = problem.name;
  document["dims"] = problem.space.size();
  document["seed"] = options.seed;
  document["instance"] = options.variant.instance;
  document["gradients"] = options.gradients;
  document["shifted"] = options.variant.shifted;
  document["rotated"] = options.variant.rotated;
  document["evaluations"] = result.evaluations;
  document["violating_evaluations"] = result.summary.violating;
  const pareto::SurrogateQuality& surrogate = result.summary.surrogate;
  const bool foretold = surrogate.predictions > 0;
  document["surrogate_proposals"] = surrogate.proposals;
  document["surrogate_within_two_deviations"] =
      KnownOrNull(surrogate.within_two_deviations, foretold);
  document["surrogate_median_error"] = KnownOrNull(surrogate.median_error, foretold);
  document["own_seconds_per_evaluation"] =
      result.own_seconds / static_cast<double>(std::max<std::int64_t>(1, result.evaluations));
  document["stop_reason"] = pareto::StopReasonName(result.summary.stop_reason);
  document["reference"] = Numbers(problem.reference);
  document["hypervolume"] = result.hypervolume;
  document["true_hypervolume"] = KnownOrNull(problem.hypervolume, known);
  document["share"] = KnownOrNull(result.hypervolume / problem.hypervolume, known);
  document["combinations"] = result.summary.combinations;
  document["combinations_tried"] = result.summary.combinations_tried;
  document["combinations_given_up"] = result.summary.combinations_pruned;
  if (measured.dense) {
    document["dense_evaluations"] = measured.dense->evaluations;
    document["dense_hypervolume"] = measured.dense->hypervolume;
    document["dense_share"] = KnownOrNull(measured.dense->hypervolume / problem.hypervolume, known);
  }
  if (measured.errors) {
    document["front_error_points"] = measured.errors->points;
    document["front_error_share_below_1e_5"] = ShareBelow(*measured.errors);
    document["front_error_worst"] = measured.errors->worst;
    document["front_error_decades"] = measured.errors->decades;
  }
  document["cells_covered"] = result.summary.cells_covered;
  document["pieces"] = result.front.pieces.size();
  document["parameter_lower"] = Numbers(problem.space.lower);
  document["parameter_upper"] = Numbers(problem.space.upper);
  document["points"] = Json::array();
  for (const pareto::BenchmarkPoint& point : result.non_dominated) {
    Json entry;
    entry["metrics"] = Numbers(point.metrics);
    entry["parameters"] = Numbers(point.x);
    if (problem.constraint_count > 0) entry["constraints"] = Numbers(point.constraints);
    document["points"].push_back(std::move(entry));
  }
  return document;
}

// "f1", "f2", ...
std::vector<std::string> Numbered(const char* letter, Eigen::Index count) {
  std::vector<std::string> names;
  for (Eigen::Index i = 0; i < count; ++i) names.push_back(absl::StrCat(letter, i + 1));
  return names;
}

void PrintMeasures(const pareto::BenchmarkProblem& problem, const Measured& measured,
                   const Output& output) {
  if (measured.dense) {
    std::string share;
    if (problem.hypervolume > 0) {
      share = absl::StrFormat(", %.4f of the true one",
                              measured.dense->hypervolume / problem.hypervolume);
    }
    output.Line(absl::StrFormat("Its pieces, densely: %d more evaluations, hypervolume %.6g%s",
                                measured.dense->evaluations, measured.dense->hypervolume, share));
  }
  if (measured.errors) {
    output.Line(absl::StrFormat(
        "Distance of its points from the true front: %.1f %% of %d below 1e-5, at most %.2g",
        100 * ShareBelow(*measured.errors), measured.errors->points, measured.errors->worst));
  }
}

void Print(const pareto::BenchmarkProblem& problem, const Measured& measured,
           const Output& output) {
  const pareto::BenchmarkResult& result = measured.discovery;
  std::string share;
  if (problem.hypervolume > 0) {
    share = absl::StrFormat(", %.4f of the true one", result.hypervolume / problem.hypervolume);
  }
  output.Line(absl::StrFormat(
      "%s, %d parameters: %d evaluations, hypervolume %.6g%s, %d designs that none dominates, "
      "%d pieces, %.3f ms of its own an evaluation",
      problem.name, problem.space.size(), result.evaluations, result.hypervolume, share,
      result.non_dominated.size(), result.front.pieces.size(),
      1e3 * result.own_seconds /
          static_cast<double>(std::max<std::int64_t>(1, result.evaluations))));
  PrintMeasures(problem, measured, output);
  std::vector<std::string> titles = Numbered("f", problem.metric_count);
  for (std::string& name : Numbered("x", problem.space.size())) titles.push_back(std::move(name));
  std::vector<std::vector<std::string>> rows;
  for (const pareto::BenchmarkPoint& point : result.non_dominated) {
    std::vector<std::string>& row = rows.emplace_back();
    for (const double value : point.metrics) row.push_back(absl::StrFormat("%.6g", value));
    for (const double value : point.x) row.push_back(absl::StrFormat("%.4g", value));
  }
  output.Table(titles, rows);
}

// The front as the service would give it.
v1::Front MessageOf(const pareto::BenchmarkProblem& problem,
                    const pareto::BenchmarkResult& result) {
  v1::Front message;
  message.mutable_specification()->set_subject(problem.name);
  for (const std::string& name : Numbered("x", problem.space.size())) {
    message.add_parameter_names(name);
  }
  for (const std::string& name : Numbered("f", problem.metric_count)) {
    message.add_metric_names(name);
    message.add_metric_units("");
  }
  message.mutable_parameter_minima()->Add(problem.space.lower.begin(), problem.space.lower.end());
  message.mutable_parameter_maxima()->Add(problem.space.upper.begin(), problem.space.upper.end());
  for (const pareto::FrontPoint& point : result.front.points) {
    v1::FrontPoint& to = *message.add_points();
    to.mutable_parameters()->Add(point.x.begin(), point.x.end());
    to.mutable_metrics()->Add(point.metrics.begin(), point.metrics.end());
    to.mutable_embedding()->Add(point.embedding.begin(), point.embedding.end());
    to.set_piece(point.piece);
    to.set_jump(point.jump);
  }
  return message;
}

absl::Status WriteFiles(const v1::Front& front, const std::filesystem::path& folder,
                        const Output& output) {
  MORTISE_ASSIGN_OR_RETURN(const std::string svg, pareto::FrontAsSvg(front));
  MORTISE_ASSIGN_OR_RETURN(const std::string png, pareto::FrontAsPng(front));
  const std::pair<const char*, std::string> files[] = {
      {"front.csv", pareto::FrontAsCsv(front)}, {"front.svg", svg}, {"front.png", png}};
  for (const auto& [name, bytes] : files) {
    MORTISE_RETURN_IF_ERROR(WriteFile(folder / name, bytes));
    output.Line(absl::StrCat("  ", (folder / name).string()));
  }
  return absl::OkStatus();
}

absl::Status Run(const BenchmarkOptions& options, Output& output) {
  const int dimensions = options.dimensions != 0
                             ? options.dimensions
                             : pareto::PublishedDimensions(options.name, options.variant.metrics);
  MORTISE_ASSIGN_OR_RETURN(
      pareto::BenchmarkProblem problem,
      pareto::MakeBenchmarkProblem(options.name, std::max(1, dimensions), options.variant));
  problem.rounded = options.rounded;
  if (options.front_error && (problem.constraint_count > 0 || !problem.choices.empty())) {
    return InvalidField("front_error", "is for problems without constraints and choices");
  }
  pareto::Discovery::Options discovery;
  discovery.evaluations = options.evaluations;
  discovery.seed = options.seed;
  discovery.window = options.window;
  discovery.surrogate = SurrogateOf(options.surrogate);
  discovery.stall_tracks = 0;  // all evaluations are to be made
  auto result = pareto::RunBenchmark(
      problem, discovery, options.gradients, [&](const pareto::Discovery::Summary& summary) {
        output.Progress(
            static_cast<long>(summary.evaluations), static_cast<long>(options.evaluations),
            absl::StrFormat("hypervolume %.4f, %d cells covered, %d pieces followed",
                            summary.hypervolume, summary.cells_covered, summary.pieces));
      });
  output.EndProgress();
  MORTISE_RETURN_IF_ERROR(result.status());
  Measured measured{std::move(*result), {}, {}};
  if (options.dense) measured.dense = EvaluateDensely(problem, measured.discovery.front);
  if (options.front_error) measured.errors = MeasureErrors(problem, measured.discovery.front);
  if (output.text()) Print(problem, measured, output);
  if (!options.out.empty()) {
    MORTISE_RETURN_IF_ERROR(
        WriteFiles(MessageOf(problem, measured.discovery), options.out, output));
  }
  output.Document(DocumentOf(options, problem, measured));
  return absl::OkStatus();
}

void AddOptions(CLI::App& app, BenchmarkOptions& options) {
  app.add_option("name", options.name,
                 absl::StrCat("One of ", absl::StrJoin(pareto::BenchmarkNames(), ", ")))
      ->required();
  app.add_option("--dims", options.dimensions, "Number of parameters; as published if not given")
      ->check(CLI::PositiveNumber);
  app.add_option("--evaluations", options.evaluations, "Budget of evaluations")
      ->capture_default_str();
  app.add_option("--seed", options.seed, "Same seed, same front")->capture_default_str();
  app.add_option("--window", options.window, "Evaluations under way at once")
      ->capture_default_str();
  app.add_flag("--gradients", options.gradients, "The problem offers its gradients");
  app.add_flag("--rounded", options.rounded,
               "Choices and whole numbers as parameters like others, to compare");
  app.add_option("--surrogate", options.surrogate,
                 "Whether a surrogate proposes designs: auto (as much as it earns), "
                 "always or never")
      ->check(CLI::IsMember({"auto", "always", "never"}))
      ->capture_default_str();
  app.add_flag("--dense", options.dense, "Evaluate the pieces of the front densely, uncounted");
  app.add_flag("--front-error", options.front_error,
               "Measure how far the points of the front are from the true one, uncounted");
  app.add_flag("--shifted", options.variant.shifted, "No optimum on a bound");
  app.add_flag("--rotated", options.variant.rotated, "No optimum along an axis");
  app.add_option("--instance", options.variant.instance,
                 "Which shift and rotation; for Fourier, which coefficients")
      ->capture_default_str();
  app.add_option("--metrics", options.variant.metrics,
                 "Number of metrics, 2 to 6, of DTLZ (3 if not given) and Fourier (2)")
      ->check(CLI::PositiveNumber);
  app.add_option("--out", options.out, "Folder for front.csv, front.svg and front.png");
}

FieldSources SourcesOf(const BenchmarkOptions& options) {
  FieldSources sources;
  sources.Add("name", "name");
  sources.Add("dimensions", "--dims");
  sources.Add("evaluations", "--evaluations");
  sources.Add("window", "--window");
  sources.Add("metrics", "--metrics");
  sources.Add("front_error", "--front-error");
  sources.Add("variant", options.variant.rotated ? "--rotated" : "--shifted");
  return sources;
}

}  // namespace
}  // namespace mortise::cli

int main(int argc, char** argv) {
  using namespace mortise::cli;
  CLI::App app("Measure discovery on a published problem", "mortise pareto benchmark");
  Session session;
  BenchmarkOptions options;
  app.add_flag("--json", session.json, "Print exactly one JSON document on standard output");
  AddOptions(app, options);
  RequireDecimalNumbers(app);
  app.footer("Example: mortise pareto benchmark ZDT3 --dims 15 --evaluations 300 --gradients");
  session.command = [&options](Session&, Output& output) {
    return SourcesOf(options).Name(Run(options, output));
  };
  return RunProgram(app, session, argc, argv);
}
