// How much sooner eight workers finish a discovery than one, with the same window and so the same
// front, where an evaluation takes 100 ms; and where some take 2 s.
//
// BM_Workers sleeps: `ratio` of the wall times, `same` is 1 if the fronts are so bit for bit.
// BM_Schedule counts the same time without waiting for it, on more problems: `ratio`, and `busy`,
// the share of eight workers' time that they evaluate. Arguments: problem (index into
// BenchmarkNames), parameters, evaluations, window, and how many evaluations in a thousand take 2
// s.
#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <vector>

#include "common/base/random.h"
#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/discovery/discovery.h"
#include "services/pareto/discovery/discovery_run.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWorkers = 8;
constexpr double kUsual = 0.1, kSlow = 2;  // s

struct Timing {
  int slow_of_thousand = 0;

  // Of a design, the same each time.
  double Seconds(const Eigen::VectorXd& x) const {
    Random random(static_cast<std::uint64_t>(1e15 * x.sum()));
    return random.Uniform() < slow_of_thousand / 1000.0 ? kSlow : kUsual;
  }
};

std::unique_ptr<Discovery> Begin(const BenchmarkProblem& problem, std::int64_t evaluations,
                                 int window) {
  Discovery::Options options;
  options.evaluations = evaluations;
  options.window = window;
  options.stall_tracks = 0;
  return *Discovery::Create(problem.space, problem.metric_count, options);
}

class SleepingEvaluator : public Evaluator {
 public:
  SleepingEvaluator(const BenchmarkProblem& problem, const Timing& timing)
      : problem_(problem), timing_(timing) {}

  absl::StatusOr<std::vector<Evaluation>> Evaluate(
      const std::vector<Eigen::VectorXd>& designs) override {
    std::vector<Evaluation> results;
    for (const Eigen::VectorXd& x : designs) {
      std::this_thread::sleep_for(std::chrono::duration<double>(timing_.Seconds(x)));
      results.push_back(problem_.evaluate(x, false));
    }
    return results;
  }

 private:
  const BenchmarkProblem& problem_;
  const Timing timing_;
};

bool Same(const Front& a, const Front& b) {
  if (a.points.size() != b.points.size()) return false;
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    if (a.points[i].x != b.points[i].x || a.points[i].metrics != b.points[i].metrics ||
        a.points[i].piece != b.points[i].piece) {
      return false;
    }
  }
  return true;
}

BenchmarkProblem ProblemOf(const benchmark::State& state) {
  return *MakeBenchmarkProblem(BenchmarkNames()[static_cast<std::size_t>(state.range(0))],
                               static_cast<int>(state.range(1)));
}

std::string Label(const benchmark::State& state) {
  return BenchmarkNames()[static_cast<std::size_t>(state.range(0))] + "-" +
         std::to_string(state.range(1));
}

void BM_Workers(benchmark::State& state) {
  const BenchmarkProblem problem = ProblemOf(state);
  const Timing timing{static_cast<int>(state.range(4))};
  std::map<int, double> seconds;
  std::map<int, Front> fronts;
  for (auto _ : state) {
    for (const int workers : {1, kWorkers}) {
      const auto discovery = Begin(problem, state.range(2), static_cast<int>(state.range(3)));
      SleepingEvaluator evaluator(problem, timing);
      RunOptions options;
      options.lanes = workers;
      const Clock::time_point begin = Clock::now();
      if (!Run(*discovery, evaluator, options).ok()) state.SkipWithError("the run failed");
      seconds[workers] = std::chrono::duration<double>(Clock::now() - begin).count();
      fronts[workers] = discovery->front();
    }
  }
  state.counters["ratio"] = seconds[1] / seconds[kWorkers];
  state.counters["same"] = Same(fronts[1], fronts[kWorkers]) ? 1 : 0;
  state.SetLabel(Label(state));
}

// The time that a discovery takes on so many workers, if its own were nothing.
double ScheduledSeconds(const BenchmarkProblem& problem, Discovery& discovery, int workers,
                        const Timing& timing, double& busy) {
  std::multimap<double, Discovery::Proposal> under_way;  // by when they end
  double now = 0;
  while (true) {
    while (static_cast<int>(under_way.size()) < workers) {
      auto proposal = discovery.Ask();
      if (!proposal) break;
      const double seconds = timing.Seconds(proposal->x);
      busy += seconds;
      under_way.emplace(now + seconds, *std::move(proposal));
    }
    if (under_way.empty()) return now;
    const auto first = under_way.begin();
    now = first->first;
    const Discovery::Proposal proposal = first->second;
    under_way.erase(first);
    benchmark::DoNotOptimize(discovery.Tell(proposal.number, problem.evaluate(proposal.x, false)));
  }
}

void BM_Schedule(benchmark::State& state) {
  const BenchmarkProblem problem = ProblemOf(state);
  const Timing timing{static_cast<int>(state.range(4))};
  double single = 0, several = 0, busy = 0, share = 0;
  for (auto _ : state) {
    const int window = static_cast<int>(state.range(3));
    double all = 0;
    single = ScheduledSeconds(problem, *Begin(problem, state.range(2), window), 1, timing, all);
    const auto discovery = Begin(problem, state.range(2), window);
    several = ScheduledSeconds(problem, *discovery, kWorkers, timing, busy);
    std::vector<Eigen::VectorXd> points;
    for (const FrontPoint& point : discovery->front().points) points.push_back(point.metrics);
    share = Hypervolume(points, problem.reference) /
            (problem.hypervolume > 0 ? problem.hypervolume : 1);
  }
  state.counters["ratio"] = single / several;
  state.counters["busy"] = busy / (kWorkers * several);
  state.counters["share"] = share;
  state.SetLabel(Label(state));
}

void Schedules(benchmark::internal::Benchmark* bench) {
  bench->Unit(benchmark::kMillisecond)->Iterations(1);
  for (const int slow : {0, 5}) {
    for (const int window : {8, 16, 32}) {
      for (const auto& [problem, parameters, evaluations] :
           {std::tuple{0, 15, 300}, {0, 15, 1000}, {6, 12, 1000}, {12, 3, 300}, {13, 3, 300}}) {
        bench->Args({problem, parameters, evaluations, window, slow});
      }
    }
  }
}

BENCHMARK(BM_Workers)
    ->Unit(benchmark::kSecond)
    ->Iterations(1)
    ->UseRealTime()
    ->Args({0, 15, 300, 16, 0})
    ->Args({0, 15, 300, 16, 5});
BENCHMARK(BM_Schedule)->Apply(Schedules);

}  // namespace
}  // namespace mortise::pareto

BENCHMARK_MAIN();
