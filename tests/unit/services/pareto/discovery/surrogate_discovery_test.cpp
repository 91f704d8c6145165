// Discovery where evaluations are scarce and a surrogate proposes most of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <vector>

#include "services/pareto/archive/hypervolume.h"
#include "services/pareto/discovery/discovery.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;
using Evaluate = std::function<Evaluation(const VectorXd&)>;

// Answers up to `held` proposals at once, the last first.
std::unique_ptr<Discovery> Complete(const BenchmarkProblem& problem, Discovery::Options options,
                                    const Evaluate& evaluate, std::size_t held = 1) {
  options.constraints = problem.constraint_count;
  auto discovery = *Discovery::Create(problem.space, problem.metric_count, options);
  std::vector<Discovery::Proposal> waiting;
  while (!discovery->Finished()) {
    std::optional<Discovery::Proposal> proposal;
    if (waiting.size() < held) proposal = discovery->Ask();
    if (proposal) {
      waiting.push_back(*std::move(proposal));
      continue;
    }
    while (!waiting.empty()) {
      const Discovery::Proposal last = waiting.back();
      waiting.pop_back();
      EXPECT_TRUE(discovery->Tell(last.number, evaluate(last.x)).ok());
    }
  }
  return discovery;
}

Evaluate Plainly(const BenchmarkProblem& problem, bool gradients = false) {
  return [&problem, gradients](const VectorXd& x) { return problem.evaluate(x, gradients); };
}

double Share(const Discovery& discovery, const BenchmarkProblem& problem) {
  std::vector<VectorXd> points;
  for (const FrontPoint& point : discovery.front().points) points.push_back(point.metrics);
  return Hypervolume(points, problem.reference) / problem.hypervolume;
}

TEST(SurrogateDiscoveryTest, FindsMostOfAFrontWithVeryFewEvaluations) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 5);
  Discovery::Options options;
  options.evaluations = 45;
  const auto discovery = Complete(problem, options, Plainly(problem));
  EXPECT_GT(Share(*discovery, problem), 0.94);
  const SurrogateQuality quality = discovery->summary().surrogate;
  EXPECT_GT(quality.proposals, 8);
  EXPECT_EQ(quality.predictions, 2 * quality.proposals);
  EXPECT_GT(quality.within_two_deviations, 0.7);
}

TEST(SurrogateDiscoveryTest, KeepsToConstraints) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("SRN", 2);
  Discovery::Options options;
  options.evaluations = 60;
  const auto discovery = Complete(problem, options, Plainly(problem));
  EXPECT_GT(Share(*discovery, problem), 0.93);
  for (const FrontPoint& point : discovery->front().points) {
    EXPECT_LE(point.constraints.maxCoeff(), 0);
  }
}

TEST(SurrogateDiscoveryTest, LearnsWhichDesignsFail) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 3);
  Discovery::Options options;
  options.evaluations = 45;
  const auto discovery = Complete(problem, options, [&](const VectorXd& x) {
    Evaluation evaluation = problem.evaluate(x, false);
    if (x[0] > 0.5) evaluation.status = EvaluationStatus::kFailed;  // half of the front
    return evaluation;
  });
  EXPECT_GT(discovery->summary().failed, 0);
  EXPECT_LT(discovery->summary().failed, 22);
  EXPECT_GT(Share(*discovery, problem), 0.5);
}

TEST(SurrogateDiscoveryTest, IsTheSameInWhateverOrderAnswersCome) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT2", 4);
  Discovery::Options options;
  options.evaluations = 30;
  options.window = 6;
  const auto one = Complete(problem, options, Plainly(problem), 1);
  const auto six = Complete(problem, options, Plainly(problem), 6);
  ASSERT_EQ(one->archive().size(), six->archive().size());
  for (std::size_t entry = 0; entry < one->archive().size(); ++entry) {
    EXPECT_EQ(one->archive()[entry].u, six->archive()[entry].u);
  }
  EXPECT_EQ(one->summary().surrogate.median_error, six->summary().surrogate.median_error);
}

TEST(SurrogateDiscoveryTest, TakesPartUnlessThereAreGradientsOrItIsAskedNotTo) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem("ZDT1", 3);
  const auto proposals = [&](std::int64_t evaluations, Discovery::Surrogate surrogate,
                             bool gradients) {
    Discovery::Options options;
    options.evaluations = evaluations;
    options.surrogate = surrogate;
    return Complete(problem, options, Plainly(problem, gradients))->summary().surrogate.proposals;
  };
  using Surrogate = Discovery::Surrogate;
  EXPECT_GT(proposals(20, Surrogate::kAutomatic, false), 0);
  EXPECT_EQ(proposals(20, Surrogate::kAutomatic, true), 0);
  EXPECT_GT(proposals(20, Surrogate::kAlways, true), 0);
  EXPECT_EQ(proposals(20, Surrogate::kNever, false), 0);
  EXPECT_GT(proposals(400, Surrogate::kAutomatic, false), 0);
}

}  // namespace
}  // namespace mortise::pareto
