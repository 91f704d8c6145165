// Discovery with choices and whole numbers: the merged front, and what holds of the search.
#include "services/pareto/discovery/combined_discovery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <set>

#include "common/base/errors.h"
#include "services/pareto/archive/non_dominated.h"
#include "services/pareto/discovery/discovery_run.h"
#include "tests/bench/pareto/benchmark_problems.h"
#include "tests/bench/pareto/benchmark_run.h"

namespace mortise::pareto {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;
using Formula = std::function<Evaluation(const VectorXd&)>;

Evaluation Evaluated(const VectorXd& x, const VectorXd& metrics) {
  Evaluation evaluation;
  evaluation.x = x;
  evaluation.status = EvaluationStatus::kEvaluated;
  evaluation.metrics = metrics;
  return evaluation;
}

Evaluation Failed(const VectorXd& x, const std::string& reason) {
  Evaluation failed;
  failed.x = x;
  failed.reason = reason;
  return failed;
}

// A choice of three and two other parameters. Over those each has a front: the first is best where
// f1 is small, the second where it is large, the third nowhere.
DesignSpace ChoiceOfThree() {
  return {Eigen::Vector3d::Zero(), Eigen::Vector3d(2, 1, 1), Eigen::Vector3d(1, 0, 0)};
}
const std::vector<DiscreteParameter> kThree = {{0, {0, 1, 2}}};

Evaluation OfThree(const VectorXd& x) {
  const double off = 2 * std::pow(x[2] - 0.3 - 0.2 * x[0], 2), t = x[1];
  if (x[0] == 0) return Evaluated(x, Vector2d(0.6 * t + off, 0.6 + std::pow(1 - t, 2) + off));
  if (x[0] == 1) return Evaluated(x, Vector2d(0.5 + t + off, 0.6 * std::pow(1 - t, 2) + off));
  return Evaluated(x, Vector2d(1 + t + off, 2 - t + off));
}

std::unique_ptr<AskTell> Complete(std::unique_ptr<AskTell> discovery, const Formula& evaluate) {
  while (!discovery->Finished()) {
    const auto proposal = discovery->Ask();
    if (!proposal) continue;
    EXPECT_TRUE(discovery->Tell(proposal->number, evaluate(proposal->x)).ok());
  }
  return discovery;
}

Discovery::Options Budget(std::int64_t evaluations, std::uint64_t seed = 1) {
  Discovery::Options options;
  options.evaluations = evaluations;
  options.seed = seed;
  options.stall_tracks = 0;
  return options;
}

void ExpectSameFront(const Front& a, const Front& b) {
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].x, b.points[i].x);
    EXPECT_EQ(a.points[i].metrics, b.points[i].metrics);
    EXPECT_EQ(a.points[i].piece, b.points[i].piece);
  }
}

TEST(CombinedDiscovery, MergesTheFrontsOfAllCombinations) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const auto discovery =
        Complete(*MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(200, seed)), OfThree);
    EXPECT_EQ(discovery->summary().evaluations, 200);
    EXPECT_EQ(discovery->summary().combinations, 3);
    EXPECT_EQ(discovery->summary().combinations_tried, 3);
    EXPECT_EQ(discovery->summary().combinations_pruned, 1);
    const Front front = discovery->front();
    std::set<double> used;
    std::vector<std::set<double>> of_piece(front.pieces.size());
    for (const FrontPoint& point : front.points) {
      used.insert(point.x[0]);
      of_piece[static_cast<std::size_t>(point.piece)].insert(point.x[0]);
      EXPECT_EQ(OfThree(point.x).metrics, point.metrics) << "truly evaluated";
      EXPECT_LT(std::abs(point.x[2] - 0.3 - 0.2 * point.x[0]), 0.1) << "near the front";
    }
    EXPECT_EQ(used, (std::set<double>{0, 1}));
    for (const auto& values : of_piece) EXPECT_EQ(values.size(), 1u) << "of one combination";
    for (const FrontPiece& piece : front.pieces) {
      EXPECT_EQ(piece.directions.row(0).norm(), 0) << "leads to no other";
    }
    const auto change = std::ranges::adjacent_find(
        front.points, [](const auto& a, const auto& b) { return a.x[0] != b.x[0]; });
    ASSERT_NE(change, front.points.end());
    EXPECT_GE(change->jump, 0.999) << "another choice is a whole range away";
  }
}

TEST(CombinedDiscovery, KeepsWhatIsNonDominatedOfTheUnion) {
  const auto discovery = Complete(*MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(150)), OfThree);
  const Archive& archive = discovery->archive();
  ASSERT_EQ(archive.size(), 150u);
  std::vector<VectorXd> all;
  for (std::size_t entry = 0; entry < archive.size(); ++entry) {
    all.push_back(archive[entry].metrics);
  }
  std::vector<std::size_t> kept = archive.non_dominated();
  std::ranges::sort(kept);
  EXPECT_EQ(kept, NonDominated(all));
  const VectorXd range = archive.CurrentScaling().range;
  for (const FrontPoint& point : discovery->front().points) {
    for (const std::size_t entry : kept) {
      EXPECT_LT((point.metrics - all[entry]).cwiseQuotient(range).minCoeff(), 0.01);
    }
  }
}

TEST(CombinedDiscovery, OfOneCombinationIsADiscovery) {
  DesignSpace fixed = ChoiceOfThree();
  fixed.lower[0] = fixed.upper[0] = 1;
  const auto combined =
      Complete(*MakeDiscovery(ChoiceOfThree(), {{0, {1}}}, 2, Budget(120)), OfThree);
  const auto single = Complete(*Discovery::Create(fixed, 2, Budget(120)), OfThree);
  ASSERT_EQ(combined->archive().size(), single->archive().size());
  ExpectSameFront(combined->front(), single->front());
}

// Answers come late and out of order; the same designs are proposed.
TEST(CombinedDiscovery, DependsOnAnswersOnly) {
  const auto straight = Complete(*MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(150)), OfThree);
  const auto discovery = *MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(150));
  std::vector<AskTell::Proposal> under_way;
  Random random(9);
  std::size_t most = 0;
  while (!discovery->Finished()) {
    const auto proposal = discovery->Ask();
    if (proposal) under_way.push_back(*proposal);
    most = std::max(most, under_way.size());
    if (under_way.empty() || (proposal && random.Uniform() < 0.7)) continue;
    const std::size_t k = random.Index(under_way.size());
    ASSERT_TRUE(discovery->Tell(under_way[k].number, OfThree(under_way[k].x)).ok());
    under_way.erase(under_way.begin() + static_cast<std::ptrdiff_t>(k));
  }
  EXPECT_GT(most, 4u) << "several at once";
  ExpectSameFront(straight->front(), discovery->front());
}

class EvaluatorOfThree : public Evaluator {
 public:
  absl::StatusOr<std::vector<Evaluation>> Evaluate(const std::vector<VectorXd>& designs) override {
    std::vector<Evaluation> results;
    for (const VectorXd& x : designs) results.push_back(OfThree(x));
    return results;
  }
};

TEST(CombinedDiscovery, IsResumedFromItsAnswersOnAnyNumberOfWorkers) {
  EvaluatorOfThree evaluator;
  std::map<std::int64_t, Evaluation> known;
  const auto first = *MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(120));
  RunOptions options;
  options.lanes = 4;
  options.checkpoint = [&](const auto& batch) {
    if (known.size() < 60) known.insert(batch.begin(), batch.end());
    return absl::OkStatus();
  };
  ASSERT_TRUE(pareto::Run(*first, evaluator, options).ok());
  const auto second = *MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(120));
  ASSERT_TRUE(pareto::Run(*second, evaluator, {}, known).ok());
  ExpectSameFront(first->front(), second->front());
}

TEST(CombinedDiscovery, EnumeratesWhereEverythingIsDiscrete) {
  const DesignSpace space{Vector2d(0, 1), Vector2d(5, 9), Vector2d(1, 1)};
  const std::vector<DiscreteParameter> all = WithWholeNumbers(space, {{0, {0, 1, 3, 5}}}, 100);
  std::map<std::vector<double>, int> times;
  const auto evaluate = [&](const VectorXd& x) {
    ++times[{x.begin(), x.end()}];
    return Evaluated(x, Vector2d(std::abs(x[0] - x[1]), x[0] + x[1]));
  };
  for (const std::int64_t budget : {36, 100}) {
    times.clear();
    const auto discovery = Complete(*MakeDiscovery(space, all, 2, Budget(budget)), evaluate);
    EXPECT_EQ(discovery->summary().stop_reason, AskTell::StopReason::kConverged);
    EXPECT_EQ(times.size(), 36u);
    for (const auto& [x, count] : times) EXPECT_EQ(count, 1);
    // (0, 1) has the least sum, (1, 1) the least difference.
    const Front front = discovery->front();
    ASSERT_EQ(front.points.size(), 2u);
    EXPECT_EQ(front.points[0].metrics.sum() + front.points[1].metrics.sum(), 4);
  }
}

TEST(CombinedDiscovery, FindsGoodOnesAmongMoreCombinationsThanEvaluations) {
  // The first two of ten choices are traded, the others have a best value each.
  const DesignSpace space{VectorXd::Zero(10), VectorXd::Constant(10, 5), VectorXd::Ones(10)};
  std::vector<DiscreteParameter> discrete;
  for (Eigen::Index i = 0; i < 10; ++i) discrete.push_back({i, {0, 1, 2, 3, 4, 5}});
  const auto evaluate = [](const VectorXd& x) {
    double off = 0;
    for (int i = 2; i < 10; ++i) off += std::fmod(x[i] * 5 + i, 6);
    return Evaluated(x, Vector2d(x[0] + x[1] + off, 10 - x[0] - x[1] + off));
  };
  const auto discovery = Complete(*MakeDiscovery(space, discrete, 2, Budget(600)), evaluate);
  EXPECT_EQ(discovery->summary().combinations, 60'466'176);
  EXPECT_EQ(discovery->summary().evaluations, 600);
  const Front front = discovery->front();
  EXPECT_EQ(front.points.size(), 11u) << "every sum of the first two";
  for (const FrontPoint& point : front.points) EXPECT_EQ(point.metrics.sum(), 10);
}

TEST(CombinedDiscovery, CountsFailuresOfACombinationAndGivesItUp) {
  const auto evaluate = [](const VectorXd& x) {
    return x[0] == 1 ? Failed(x, "NO_STRENGTH") : OfThree(x);
  };
  const auto discovery =
      Complete(*MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(200)), evaluate);
  const AskTell::Summary summary = discovery->summary();
  ASSERT_EQ(summary.failures.size(), 1u);
  EXPECT_EQ(summary.failures[0].reason, "NO_STRENGTH");
  EXPECT_EQ(summary.failures[0].count, summary.failed);
  EXPECT_GE(summary.failed, 3);
  EXPECT_LT(summary.failed, 60) << "no more than what it takes to see";
  EXPECT_GE(summary.combinations_pruned, 1);
  for (const FrontPoint& point : discovery->front().points) EXPECT_NE(point.x[0], 1);
}

TEST(CombinedDiscovery, EndsWhereAllCombinationsFail) {
  const auto evaluate = [](const VectorXd& x) { return Failed(x, "NOTHING_WORKS"); };
  const auto discovery = Complete(*MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(60)), evaluate);
  EXPECT_EQ(discovery->summary().failed, 60);
  EXPECT_EQ(discovery->summary().evaluations, 60);
  EXPECT_TRUE(discovery->front().points.empty());
}

TEST(CombinedDiscovery, KeepsToConstraintsOfSomeCombinationsOnly) {
  // The first never meets it, the others where their first parameter is large.
  const auto evaluate = [](const VectorXd& x) {
    Evaluation evaluation = OfThree(x);
    evaluation.constraints = VectorXd::Constant(1, x[0] == 0 ? 0.5 : 0.6 - x[1]);
    return evaluation;
  };
  Discovery::Options options = Budget(200);
  options.constraints = 1;
  const auto discovery = Complete(*MakeDiscovery(ChoiceOfThree(), kThree, 2, options), evaluate);
  const Front front = discovery->front();
  ASSERT_GT(front.points.size(), 3u);
  double least = 1;
  for (const FrontPoint& point : front.points) {
    EXPECT_EQ(point.x[0], 1);
    EXPECT_GE(point.x[1], 0.6);
    least = std::min(least, point.x[1]);
  }
  EXPECT_LT(least, 0.62);
  EXPECT_GT(discovery->summary().violating, 0);
}

TEST(CombinedDiscovery, BeginsWithTheDesignsGiven) {
  Discovery::Options options = Budget(60);
  options.initial_designs.resize(3, 3);
  options.initial_designs.col(0) = Eigen::Vector3d(1, 0.2, 0.5);
  options.initial_designs.col(1) = Eigen::Vector3d(0, 0.7, 0.3);
  options.initial_designs.col(2) = Eigen::Vector3d(1, 0.9, 0.1);
  std::vector<VectorXd> asked;
  const auto discovery =
      Complete(*MakeDiscovery(ChoiceOfThree(), kThree, 2, options), [&](const VectorXd& x) {
        asked.push_back(x);
        return OfThree(x);
      });
  EXPECT_EQ(discovery->summary().evaluations, 60);
  EXPECT_EQ(discovery->summary().combinations_tried, 3);
  for (Eigen::Index i = 0; i < 3; ++i) {
    EXPECT_EQ(asked[static_cast<std::size_t>(i)], options.initial_designs.col(i));
  }

  // Where there is one design of each combination, none is evaluated twice.
  const DesignSpace whole{Vector2d(0, 0), Vector2d(2, 3), Vector2d(1, 1)};
  options.initial_designs = Vector2d(1, 2);
  std::set<std::vector<double>> designs;
  const auto all = Complete(*MakeDiscovery(whole, {{0, {0, 1, 2}}, {1, {0, 1, 2, 3}}}, 2, options),
                            [&](const VectorXd& x) {
                              EXPECT_TRUE(designs.empty() ? x == Vector2d(1, 2) : true);
                              designs.emplace(x.begin(), x.end());
                              return Evaluated(x, Vector2d(x[0], x[1] - x[0]));
                            });
  EXPECT_EQ(designs.size(), 12u);
  EXPECT_EQ(all->summary().evaluations, 12);

  options.initial_designs = Eigen::Vector3d(1, 0.2, 0.5);
  const auto refused = MakeDiscovery(ChoiceOfThree(), {{0, {0, 2}}}, 2, options);
  EXPECT_EQ(DetailOf(refused.status()).field, "initial_designs[0]") << refused.status();
}

TEST(CombinedDiscovery, StopsWithWhatItHas) {
  const auto discovery = *MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(200));
  for (int k = 0; k < 50; ++k) {
    const auto proposal = discovery->Ask();
    ASSERT_TRUE(proposal);
    ASSERT_TRUE(discovery->Tell(proposal->number, OfThree(proposal->x)).ok());
  }
  discovery->Stop(AskTell::StopReason::kCancelled, "enough");
  EXPECT_TRUE(discovery->Finished());
  EXPECT_FALSE(discovery->Ask());
  EXPECT_EQ(discovery->summary().evaluations, 50);
  EXPECT_FALSE(discovery->front().points.empty());
}

TEST(CombinedDiscovery, RefusesBadInput) {
  const auto field = [](const std::vector<DiscreteParameter>& discrete,
                        const Discovery::Options& options) {
    return DetailOf(MakeDiscovery(ChoiceOfThree(), discrete, 2, options).status()).field;
  };
  EXPECT_EQ(field({{0, {0, 5}}}, Budget(100)), "discrete[0].values");
  EXPECT_EQ(field({{7, {0}}}, Budget(100)), "discrete[0].parameter");
  EXPECT_EQ(field(kThree, Budget(0)), "evaluations");
  const auto discovery = *MakeDiscovery(ChoiceOfThree(), kThree, 2, Budget(100));
  const auto proposal = *discovery->Ask();
  EXPECT_FALSE(discovery->Tell(7, OfThree(proposal.x)).ok());
  EXPECT_FALSE(discovery->Tell(0, OfThree(proposal.x + VectorXd::Constant(3, 0.1))).ok());
  EXPECT_FALSE(discovery->Tell(0, Evaluated(proposal.x, VectorXd::Zero(3))).ok());
  EXPECT_TRUE(discovery->Tell(0, OfThree(proposal.x)).ok());
  EXPECT_FALSE(discovery->Tell(0, OfThree(proposal.x)).ok()) << "told before";
}

double Share(const std::string& name, std::int64_t evaluations, std::uint64_t seed) {
  const BenchmarkProblem problem = *MakeBenchmarkProblem(name, PublishedDimensions(name));
  return RunBenchmark(problem, Budget(evaluations, seed), false)->hypervolume / problem.hypervolume;
}

TEST(CombinedDiscovery, FindsPublishedFronts) {
  EXPECT_GT(Share("WeldedBeam", 500, 1), 0.95);
  EXPECT_GT(Share("MixedZDT1", 2000, 1), 0.9);
}

}  // namespace
}  // namespace mortise::pareto
