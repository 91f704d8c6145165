// Discovery beside its peers (pagmo_peers.h): the share of the true hypervolume that the evaluated
// designs reach, for problems, budgets and seeds. For whole tables, which take hours: `--full`.
//
// One row for each problem, variant and budget: ours in the median over the seeds, the least and
// the most, and the same of its pieces evaluated densely (piece_evaluation.h); whichever peer, of
// all algorithms and sizes of population, has the best median; and whether ours is "above" it,
// "within" .002 below it, or "below" that. Shifted and rotated problems are another instance for
// each seed. Without options it runs what a few minutes allow.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "common/base/errors.h"
#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/front/piece_evaluation.h"
#include "tests/bench/pareto/benchmark_run.h"
#include "tests/bench/services/pareto/discovery/pagmo_peers.h"

namespace mortise::pareto {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMargin = 0.002;  // that ours may be below the best peer

struct Selection {
  std::vector<std::string> problems = {"ZDT3-30", "DTLZ2-12", "Kursawe-3"};
  std::vector<std::int64_t> budgets = {1000};
  std::vector<std::string> variants = {"published", "turned"};
  std::vector<int> populations = {20, 52, 100};
  int seeds = 3;
  std::string peers_file;  // what `--peers-only --csv` has printed
  bool full = false, ours_only = false, peers_only = false, json = false, csv = false;
};

const std::vector<std::string>& AllProblems() {
  static const std::vector<std::string> kProblems = {
      "ZDT1-15",  "ZDT1-30",  "ZDT2-15",  "ZDT2-30",  "ZDT3-15",  "ZDT3-30",
      "ZDT4-10",  "ZDT4-30",  "ZDT6-30",  "DTLZ1-7",  "DTLZ2-12", "DTLZ3-12",
      "DTLZ4-12", "DTLZ5-12", "DTLZ6-12", "DTLZ7-22", "Kursawe-3"};
  return kProblems;
}

struct Row {
  std::string problem;
  int dimensions = 0;
  bool turned = false;     // shifted and rotated
  bool gradients = false;  // to ours; peers know nothing of them
  std::int64_t evaluations = 0;
  std::vector<double> dense = {};  // shares of our pieces, densely evaluated
  std::vector<double> ours = {};   // shares, one a seed
  std::vector<std::pair<Peer, std::vector<double>>> peers = {};  // the same of each peer
};

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : (values[half - 1] + values[half]) / 2;
}

const std::pair<Peer, std::vector<double>>* BestPeer(const Row& row) {
  const auto best =
      std::ranges::max_element(row.peers, {}, [](const auto& peer) { return Median(peer.second); });
  return best == row.peers.end() ? nullptr : &*best;
}

std::string PeerName(const Peer& peer) {
  return absl::StrCat(peer.algorithm, " ", peer.population);
}

std::string Verdict(const Row& row) {
  const auto* best = BestPeer(row);
  if (row.ours.empty() || best == nullptr) return "";
  const double lead = Median(row.ours) - Median(best->second);
  return lead > 0 ? "above" : lead >= -kMargin ? "within" : "below";
}

// The thesis's own budget of 300 is for problems that offer gradients.
bool OffersGradients(std::int64_t evaluations) { return evaluations < 1000; }

bool IsRun(const std::string& name, bool turned, std::int64_t evaluations) {
  const bool turns = absl::StartsWith(name, "ZDT") || absl::StartsWith(name, "DTLZ");
  if (turned && !turns) return false;
  if (!OffersGradients(evaluations)) return true;
  return !turned && (name == "ZDT1" || name == "ZDT2" || name == "ZDT3");
}

double Share(const std::vector<Eigen::VectorXd>& points, const BenchmarkProblem& problem) {
  return Hypervolume(points, problem.reference) / problem.hypervolume;
}

void RunOurs(const BenchmarkProblem& problem, std::uint64_t seed, Row& row) {
  Discovery::Options options;
  options.evaluations = row.evaluations;
  options.seed = seed;
  options.stall_tracks = 0;
  const BenchmarkResult result = *RunBenchmark(problem, options, row.gradients);
  row.ours.push_back(result.hypervolume / problem.hypervolume);
  const PieceEvaluation pieces =
      EvaluatePieces(problem.space, result.front,
                     [&](const Eigen::VectorXd& x) { return problem.evaluate(x, false); });
  row.dense.push_back(Share(pieces.metrics, problem));
}

// The instance of a row's problem that goes with a seed.
absl::StatusOr<BenchmarkProblem> ProblemOf(const Row& row, std::uint64_t seed) {
  return MakeBenchmarkProblem(row.problem, row.dimensions,
                              {row.turned, row.turned, row.turned ? seed : 1});
}

// Adds a seed to the rows of a problem, which differ in their evaluations.
void RunSeed(const Selection& selection, std::uint64_t seed, std::vector<Row>& rows) {
  const BenchmarkProblem problem = *ProblemOf(rows.front(), seed);
  if (!selection.ours_only && selection.peers_file.empty()) {
    const std::vector<Peer> peers = Peers(selection.populations);
    const std::int64_t most = std::ranges::max(rows, {}, &Row::evaluations).evaluations;
    for (std::size_t p = 0; p < peers.size(); ++p) {
      const std::vector<Eigen::VectorXd> answers = RunPeer(peers[p], problem, most, seed);
      for (Row& row : rows) {
        row.peers.resize(peers.size());
        const auto count = std::min(answers.size(), static_cast<std::size_t>(row.evaluations));
        row.peers[p].first = peers[p];
        row.peers[p].second.push_back(Share(
            {answers.begin(), answers.begin() + static_cast<std::ptrdiff_t>(count)}, problem));
      }
    }
  }
  if (selection.peers_only) return;
  for (Row& row : rows) RunOurs(problem, seed, row);
}

std::string KeyOf(const Row& row) {
  return absl::StrCat(row.problem, ",", row.dimensions, ",", row.turned ? "turned" : "published",
                      ",", row.evaluations, ",", row.gradients ? 1 : 0, ",");
}

// The peers of a row, as an earlier run has printed them, at as many seeds.
void ReadPeers(const Selection& selection, Row& row) {
  std::ifstream file(selection.peers_file);
  const std::string key = KeyOf(row);
  for (std::string line; std::getline(file, line);) {
    if (!absl::StartsWith(line, key)) continue;
    const std::vector<std::string> fields = absl::StrSplit(line.substr(key.size()), ',');
    const std::vector<std::string> name = absl::StrSplit(fields.front(), ' ');
    Peer peer{name.front(), 0};
    if (name.size() != 2 || !absl::SimpleAtoi(name[1], &peer.population)) continue;
    std::vector<double> shares(
        std::min(fields.size() - 1, static_cast<std::size_t>(selection.seeds)));
    for (std::size_t i = 0; i < shares.size(); ++i) {
      if (!absl::SimpleAtod(fields[i + 1], &shares[i])) shares[i] = 0;
    }
    row.peers.emplace_back(peer, shares);
  }
}

// "ZDT1-30" names a problem and its number of parameters.
std::vector<Row> RowsOf(const Selection& selection, const std::string& problem, bool turned) {
  const std::vector<std::string> parts = absl::StrSplit(problem, '-');
  int dimensions = PublishedDimensions(parts.front());
  if (parts.size() > 1 && !absl::SimpleAtoi(parts[1], &dimensions)) dimensions = 0;
  std::vector<Row> rows;
  for (const std::int64_t evaluations : selection.budgets) {
    if (IsRun(absl::AsciiStrToUpper(parts.front()), turned, evaluations)) {
      rows.push_back({.problem = parts.front(),
                      .dimensions = dimensions,
                      .turned = turned,
                      .gradients = OffersGradients(evaluations),
                      .evaluations = evaluations});
    }
  }
  return rows;
}

std::string Text(const std::vector<double>& shares) {
  if (shares.empty()) return "";
  return absl::StrFormat("%.4f (%.4f, %.4f)", Median(shares), std::ranges::min(shares),
                         std::ranges::max(shares));
}

void PrintText(const Row& row) {
  const auto* best = BestPeer(row);
  std::cout << absl::StrFormat("%-8s %3d  %-16s %6d%s  %-24s  %-24s  %-24s %-12s %s\n", row.problem,
                               row.dimensions, row.turned ? "shifted, rotated" : "published",
                               row.evaluations, row.gradients ? "g" : " ", Text(row.ours),
                               Text(row.dense), best == nullptr ? "" : Text(best->second),
                               best == nullptr ? "" : PeerName(best->first), Verdict(row));
}

void PrintCsv(const Row& row) {
  const std::string key =
      absl::StrCat(row.problem, ",", row.dimensions, ",", row.turned ? "turned" : "published", ",",
                   row.evaluations, ",", row.gradients ? 1 : 0, ",");
  const auto print = [&](const std::string& who, const std::vector<double>& shares) {
    if (!shares.empty()) std::cout << key << who << "," << absl::StrJoin(shares, ",") << "\n";
  };
  print("ours", row.ours);
  print("ours dense", row.dense);
  for (const auto& [peer, shares] : row.peers) print(PeerName(peer), shares);
}

Json DocumentOf(const Row& row) {
  Json document{{"problem", row.problem},
                {"dims", row.dimensions},
                {"shifted_and_rotated", row.turned},
                {"gradients", row.gradients},
                {"evaluations", row.evaluations},
                {"shares", row.ours},
                {"dense_shares", row.dense},
                {"peers", Json::array()},
                {"verdict", Verdict(row)}};
  for (const auto& [peer, shares] : row.peers) {
    document["peers"].push_back(
        {{"algorithm", peer.algorithm}, {"population", peer.population}, {"shares", shares}});
  }
  return document;
}

absl::Status Run(const Selection& selection) {
  Json document = Json::array();
  std::map<std::string, int> verdicts;
  if (!selection.csv && !selection.json) {
    std::cout << absl::StrFormat("%-12s  %-16s %7s  %-24s  %-24s  %s\n", "problem", "variant",
                                 "budget", "ours", "ours, densely", "best peer");
  }
  if (selection.csv) std::cout << "problem,dims,variant,evaluations,gradients,who,shares\n";
  for (const std::string& variant : selection.variants) {
    for (const std::string& problem : selection.problems) {
      std::vector<Row> rows = RowsOf(selection, problem, variant == "turned");
      if (rows.empty()) continue;
      MORTISE_RETURN_IF_ERROR(ProblemOf(rows.front(), 1).status());
      for (int seed = 1; seed <= selection.seeds; ++seed) {
        RunSeed(selection, static_cast<std::uint64_t>(seed), rows);
      }
      for (Row& row : rows) {
        if (!selection.peers_file.empty()) ReadPeers(selection, row);
        ++verdicts[Verdict(row)];
        if (selection.json) {
          document.push_back(DocumentOf(row));
        } else {
          selection.csv ? PrintCsv(row) : PrintText(row);
        }
      }
      std::cout << std::flush;
    }
  }
  if (selection.json) std::cout << document.dump(2) << "\n";
  if (!selection.json && !selection.csv && !selection.ours_only && !selection.peers_only) {
    std::cout << absl::StrFormat("above %d, within %.3f %d, below %d\n", verdicts["above"], kMargin,
                                 verdicts["within"], verdicts["below"]);
  }
  return absl::OkStatus();
}

}  // namespace
}  // namespace mortise::pareto

int main(int argc, char** argv) {
  mortise::pareto::Selection selection;
  CLI::App app("Discovery beside pagmo's NSGA-II, MOEA/D, NSPSO and MACO");
  app.allow_extras();  // what `./dev bench` has for other benches
  app.add_flag("--full", selection.full, "Every problem and budget, at 11 seeds; takes hours");
  auto* problems = app.add_option("--problem", selection.problems, "Such as ZDT1-30; several");
  auto* budgets = app.add_option("--evaluations", selection.budgets,
                                 "Budgets; below 1,000 with gradients, of ZDT1 to 3 only");
  auto* seeds =
      app.add_option("--seeds", selection.seeds, "How many, from 1")->check(CLI::PositiveNumber);
  app.add_option("--variant", selection.variants, "published, or turned: shifted and rotated")
      ->check(CLI::IsMember({"published", "turned"}));
  app.add_option("--population", selection.populations, "Of the peers, multiples of 4")
      ->check(CLI::Range(8, 100000))
      ->check([](const std::string& size) {
        return std::stoi(size) % 4 == 0 ? "" : size + " is no multiple of 4";
      });
  app.add_option("--peers-from", selection.peers_file,
                 "What `--peers-only --csv` has printed, instead of running them again")
      ->check(CLI::ExistingFile);
  app.add_flag("--ours-only", selection.ours_only);
  app.add_flag("--peers-only", selection.peers_only);
  app.add_flag("--json", selection.json, "One document at the end, with the share of each seed");
  app.add_flag("--csv", selection.csv,
               "A line for each peer and ours, with the share of each seed");
  CLI11_PARSE(app, argc, argv);
  if (selection.full) {
    if (problems->empty()) selection.problems = mortise::pareto::AllProblems();
    if (budgets->empty()) selection.budgets = {300, 1000, 3000, 6000, 10000, 30000};
    if (seeds->empty()) selection.seeds = 11;
  }
  const absl::Status status = mortise::pareto::Run(selection);
  if (!status.ok()) std::cerr << status.message() << "\n";
  return status.ok() ? 0 : 1;
}
