// mortise pareto benchmark: discovery on published problems, in this process. It needs no house.
#include <CLI/CLI.hpp>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "cli/field_sources.h"
#include "cli/session.h"
#include "common/base/errors.h"
#include "common/base/files.h"
#include "mortise/v1/pareto.pb.h"
#include "services/pareto/benchmark_run.h"
#include "services/pareto/front_files.h"

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
  std::filesystem::path out;
  pareto::BenchmarkVariant variant;
};

std::vector<double> Numbers(const Eigen::VectorXd& vector) {
  return {vector.begin(), vector.end()};
}

Json KnownOrNull(double value, bool known) { return known ? Json(value) : Json(nullptr); }

Json DocumentOf(const BenchmarkOptions& options, const pareto::BenchmarkProblem& problem,
                const pareto::BenchmarkResult& result) {
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
  document["own_seconds_per_evaluation"] =
      result.own_seconds / static_cast<double>(std::max<std::int64_t>(1, result.evaluations));
  document["stop_reason"] = pareto::StopReasonName(result.summary.stop_reason);
  document["reference"] = Numbers(problem.reference);
  document["hypervolume"] = result.hypervolume;
  document["true_hypervolume"] = KnownOrNull(problem.hypervolume, known);
  document["share"] = KnownOrNull(result.hypervolume / problem.hypervolume, known);
  document["cells_covered"] = result.summary.cells_covered;
  document["pieces"] = result.front.pieces.size();
  document["parameter_lower"] = Numbers(problem.space.lower);
  document["parameter_upper"] = Numbers(problem.space.upper);
  document["points"] = Json::array();
  for (const pareto::BenchmarkPoint& point : result.non_dominated) {
    Json entry;
    entry["metrics"] = Numbers(point.metrics);
    entry["parameters"] = Numbers(point.x);
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

void Print(const pareto::BenchmarkProblem& problem, const pareto::BenchmarkResult& result,
           const Output& output) {
  std::string share;
  if (problem.hypervolume > 0)
    share = absl::StrFormat(", %.4f of the true one", result.hypervolume / problem.hypervolume);
  output.Line(absl::StrFormat(
      "%s, %d parameters: %d evaluations, hypervolume %.6g%s, %d designs that none dominates, "
      "%d pieces, %.3f ms of its own an evaluation",
      problem.name, problem.space.size(), result.evaluations, result.hypervolume, share,
      result.non_dominated.size(), result.front.pieces.size(),
      1e3 * result.own_seconds /
          static_cast<double>(std::max<std::int64_t>(1, result.evaluations))));
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
  for (const std::string& name : Numbered("x", problem.space.size()))
    message.add_parameter_names(name);
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
      const pareto::BenchmarkProblem problem,
      pareto::MakeBenchmarkProblem(options.name, std::max(1, dimensions), options.variant));
  pareto::Discovery::Options discovery;
  discovery.evaluations = options.evaluations;
  discovery.seed = options.seed;
  discovery.window = options.window;
  discovery.stall_tracks = 0;  // all evaluations are to be made
  const auto result = pareto::RunBenchmark(
      problem, discovery, options.gradients, [&](const pareto::Discovery::Summary& summary) {
        output.Progress(static_cast<long>(summary.evaluations),
                        static_cast<long>(options.evaluations),
                        absl::StrFormat("hypervolume %.4f, %d cells covered", summary.hypervolume,
                                        summary.cells_covered));
      });
  output.EndProgress();
  MORTISE_RETURN_IF_ERROR(result.status());
  if (output.text()) Print(problem, *result, output);
  if (!options.out.empty())
    MORTISE_RETURN_IF_ERROR(WriteFiles(MessageOf(problem, *result), options.out, output));
  output.Document(DocumentOf(options, problem, *result));
  return absl::OkStatus();
}

}  // namespace

void AddParetoBenchmarkCommand(CLI::App& pareto, Session& session) {
  auto options = std::make_shared<BenchmarkOptions>();
  CLI::App* benchmark =
      pareto.add_subcommand("benchmark", "Measure discovery on a published problem");
  benchmark
      ->add_option("name", options->name,
                   absl::StrCat("One of ", absl::StrJoin(pareto::BenchmarkNames(), ", ")))
      ->required();
  benchmark
      ->add_option("--dims", options->dimensions, "Number of parameters; as published if not given")
      ->check(CLI::PositiveNumber);
  benchmark->add_option("--evaluations", options->evaluations, "Budget of evaluations")
      ->capture_default_str();
  benchmark->add_option("--seed", options->seed, "Same seed, same front")->capture_default_str();
  benchmark->add_option("--window", options->window, "Evaluations under way at once")
      ->capture_default_str();
  benchmark->add_flag("--gradients", options->gradients, "The problem offers its gradients");
  benchmark->add_flag("--shifted", options->variant.shifted, "No optimum on a bound");
  benchmark->add_flag("--rotated", options->variant.rotated, "No optimum along an axis");
  benchmark
      ->add_option("--instance", options->variant.instance,
                   "Which shift and rotation; for Fourier, which coefficients")
      ->capture_default_str();
  benchmark
      ->add_option("--metrics", options->variant.metrics,
                   "Number of metrics, 2 to 6, of DTLZ (3 if not given) and Fourier (2)")
      ->check(CLI::PositiveNumber);
  benchmark->add_option("--out", options->out, "Folder for front.csv, front.svg and front.png");
  benchmark->footer(
      "Example: mortise pareto benchmark ZDT3 --dims 15 --evaluations 300 --gradients");
  benchmark->callback([&session, options] {
    session.command = [options](Session&, Output& output) {
      FieldSources sources;
      sources.Add("name", "name");
      sources.Add("dimensions", "--dims");
      sources.Add("evaluations", "--evaluations");
      sources.Add("window", "--window");
      sources.Add("metrics", "--metrics");
      sources.Add("variant", options->variant.rotated ? "--rotated" : "--shifted");
      return sources.Name(Run(*options, output));
    };
  });
}

}  // namespace mortise::cli
