// Fronts reach as far as what has been evaluated: for any archive, buffer and pieces, and at the
// end of every kind of discovery.
#include "services/pareto/archive/front_places.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <set>

#include "common/base/errors.h"
#include "common/base/random.h"
#include "services/pareto/archive/embedding.h"
#include "services/pareto/discovery/combined_discovery.h"
#include "services/pareto/discovery/discovery_run.h"
#include "services/pareto/discovery/robust_evaluator.h"
#include "services/pareto/front/front_exploration.h"
#include "tests/bench/pareto/benchmark_problems.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

constexpr double kDeltaB = 0.01;

MatrixXd MetricsOf(const Front& front) {
  MatrixXd metrics(front.points.empty() ? 0 : front.points[0].metrics.size(),
                   static_cast<Index>(front.points.size()));
  for (std::size_t i = 0; i < front.points.size(); ++i) {
    metrics.col(static_cast<Index>(i)) = front.points[i].metrics;
  }
  return metrics;
}

// The front, to be asked.
FrontExploration Exploration(const Front& front) {
  FrontPoints points;
  points.metrics = MetricsOf(front);
  const Index count = points.metrics.cols(), d = points.metrics.rows();
  points.parameters.resize(front.points[0].x.size(), count);
  points.embedding.resize(d - 1, count);
  for (Index i = 0; i < count; ++i) {
    const FrontPoint& point = front.points[static_cast<std::size_t>(i)];
    points.parameters.col(i) = point.x;
    points.embedding.col(i) = point.embedding;
    points.piece.push_back(point.piece);
  }
  points.signs = VectorXd::Ones(d);
  points.ranges = VectorXd::Ones(points.parameters.rows());
  return FrontExploration(std::move(points));
}

// Limits of one metric, at any value between its best and its worst, keep something.
void ExpectLimitsKeepSomething(const FrontExploration& front, const VectorXd& best,
                               const VectorXd& worst) {
  for (Index metric = 0; metric < best.size(); ++metric) {
    for (int step = 0; step <= 20; ++step) {
      const double value =
          step == 20 ? worst[metric] : best[metric] + step * (worst[metric] - best[metric]) / 20;
      EXPECT_FALSE(front.Within({{true, metric, {}, value}}).points.empty())
          << metric << " <= " << value;
      EXPECT_FALSE(front.Within({{true, metric, value, {}}}).points.empty())
          << metric << " >= " << value;
    }
  }
}

void ExpectReachesAsFar(const Archive& archive, const Front& front) {
  ASSERT_FALSE(archive.non_dominated().empty());
  const MatrixXd evaluated = archive.non_dominated_metrics(), found = MetricsOf(front);
  const VectorXd best = evaluated.rowwise().minCoeff(), worst = evaluated.rowwise().maxCoeff();
  EXPECT_EQ(found.rowwise().minCoeff(), best);
  EXPECT_EQ(found.rowwise().maxCoeff(), worst);
  std::set<std::size_t> entries;
  for (const FrontPoint& point : front.points) {
    EXPECT_TRUE(entries.insert(point.entry).second);
    EXPECT_TRUE(archive[point.entry].feasible);
    EXPECT_EQ(point.metrics, archive[point.entry].metrics);
    EXPECT_FALSE(archive.ClearlyDominated(point.metrics, front.scaling, kDeltaB));
  }
  ExpectLimitsKeepSomething(Exploration(front), best, worst);
}

// A trade-off on the front sum of y_k^(1/power) = 1, a little behind it.
VectorXd OnFront(Random& random, Index d, double power) {
  VectorXd shares = random.UnitVector(d).cwiseAbs2();
  if (random.Uniform() < 0.2) shares = random.UnitVector(d).cwiseAbs2().cwiseProduct(shares);
  shares /= shares.sum();
  return shares.array().pow(power) + 0.02 * random.Uniform();
}

struct Shape {
  Index d;
  double power;  // above 1: hollow towards the ideal, below: bulging away from it
  int cells;
  std::size_t cell_limit;
};

TEST(FrontPlaces, ReachTheBestAndTheWorstOfEachMetricInAnyArchive) {
  for (const Shape& shape : std::vector<Shape>{{2, 2, 1000, 0},
                                               {2, 1, 10, 0},
                                               {2, 0.5, 100, 0},
                                               {3, 3, 100, 0},
                                               {3, 1, 10, 0},
                                               {4, 2, 64, 50},
                                               {5, 2, 64, 50},
                                               {6, 3, 64, 50}}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      Random random(seed);
      Archive archive;
      for (int i = 0; i < 400; ++i) {
        ArchiveEntry entry;
        entry.evaluated = random.Uniform() > 0.1;
        entry.u = VectorXd::NullaryExpr(3, [&] { return random.Uniform(); });
        if (entry.evaluated) {
          entry.metrics = 5 + 100 * OnFront(random, shape.d, shape.power).array();
        }
        entry.constraints = VectorXd::Constant(1, random.Uniform() - 0.8);
        archive.Add(entry);
      }
      PerformanceBuffer buffer(
          {.cells_per_angle = shape.cells, .cell_limit = shape.cell_limit, .tolerance = kDeltaB},
          shape.d);
      buffer.Rebuild(archive, archive.CurrentScaling());
      std::vector<AffinePiece> pieces;
      for (int p = 0; p < 4; ++p) {
        pieces.push_back({0, VectorXd::NullaryExpr(3, [&] { return random.Uniform(); }),
                          MatrixXd(random.UnitVector(3))});
      }
      SCOPED_TRACE(testing::Message()
                   << shape.d << " metrics, power " << shape.power << ", seed " << seed);
      const DesignSpace space{VectorXd::Zero(3), VectorXd::Ones(3)};
      ExpectReachesAsFar(archive, BuildFront(space, archive, buffer, pieces));
    }
  }
}

// Every trade-off has the first of a place near it, on nearly the same ray.
TEST(FrontPlaces, CoverEveryTradeOff) {
  for (const Index d : {2, 3, 4}) {
    Random random(7);
    Archive archive;
    for (int i = 0; i < 600; ++i) {
      archive.Add({VectorXd::Constant(1, random.Uniform()), true, OnFront(random, d, 2.5), {}, {}});
    }
    PerformanceBuffer buffer({.cells_per_angle = d == 2 ? 1000 : 20}, d);
    buffer.Rebuild(archive, archive.CurrentScaling());
    const std::vector<FrontPlace> places = PlacesOfFront(archive, buffer);
    std::set<std::size_t> taken;
    for (const FrontPlace& place : places) {
      for (const auto& candidate : place.candidates) {
        EXPECT_TRUE(taken.insert(candidate.entry).second);
      }
    }
    const double width = std::numbers::pi / 2 / buffer.cells_per_angle() * std::sqrt(d - 1.0);
    for (const std::size_t entry : archive.non_dominated()) {
      const VectorXd scaled = buffer.scaling().Apply(archive[entry].metrics);
      const bool covered = std::ranges::any_of(places, [&](const FrontPlace& place) {
        const double behind = scaled.norm() - place.candidates.front().distance;
        return place.cell == buffer.CellOf(scaled) && behind >= 0 &&
               behind <= std::max(kDeltaB, width * scaled.norm()) + 1e-12;
      });
      EXPECT_TRUE(covered) << scaled.transpose();
    }
  }
}

// Of many that are the best in a metric one that none dominates, whichever came first.
TEST(FrontPlaces, OfEquallyGoodOnesTakeOneThatNoneDominates) {
  const MatrixXd metrics{{0, 0, 0, 1, 1}, {3, 1, 2, 0, 0}, {3, 2, 1, 2, 1}};
  Archive archive;
  for (const auto& column : metrics.colwise()) {
    archive.Add({VectorXd::Zero(1), true, VectorXd(column), {}, {}});
  }
  EXPECT_EQ(EndsOfFront(archive), (std::vector<std::size_t>{1, 2, 4}));
}

using Formula = std::function<VectorXd(const VectorXd&)>;

class FormulaEvaluator : public Evaluator {
 public:
  explicit FormulaEvaluator(Formula metrics, Formula constraints = {})
      : metrics_(std::move(metrics)), constraints_(std::move(constraints)) {}

  absl::StatusOr<std::vector<Evaluation>> Evaluate(const std::vector<VectorXd>& designs) override {
    if (lost_after >= 0 && calls_++ >= lost_after) return absl::UnavailableError("away");
    std::vector<Evaluation> results;
    for (const VectorXd& x : designs) {
      Evaluation& result = results.emplace_back();
      result.x = x;
      result.status = EvaluationStatus::kEvaluated;
      result.metrics = metrics_(x);
      if (constraints_) result.constraints = constraints_(x);
    }
    return results;
  }

  int lost_after = -1;

 private:
  Formula metrics_, constraints_;
  int calls_ = 0;
};

// Squared distances to d places: the first corners of the box.
Formula Distances(Index d) {
  return [d](const VectorXd& x) {
    VectorXd metrics(d);
    for (Index k = 0; k < d; ++k) {
      VectorXd place = VectorXd::Zero(x.size());
      for (Index i = 0; i < x.size(); ++i) place[i] = (k >> i) & 1;
      metrics[k] = (x - place).squaredNorm();
    }
    return metrics;
  };
}

DesignSpace Box(Index size) { return {VectorXd::Zero(size), VectorXd::Ones(size)}; }

Discovery::Options Budget(std::int64_t evaluations, std::uint64_t seed) {
  Discovery::Options options;
  options.evaluations = evaluations;
  options.seed = seed;
  options.surrogate = Discovery::Surrogate::kNever;
  return options;
}

// The metrics x^2 and (1 - x)^2: the ends, both evaluated, are 0 and 0 exactly.
TEST(FrontPlaces, KeepTheEndsOfTwoParabolas) {
  for (const std::int64_t evaluations : {30, 100, 300}) {
    auto discovery = *Discovery::Create(Box(1), 2, Budget(evaluations, 1));
    FormulaEvaluator evaluator(Distances(2));
    ASSERT_TRUE(pareto::Run(*discovery, evaluator, {}).ok());
    const Front front = discovery->front();
    ExpectReachesAsFar(discovery->archive(), front);
    EXPECT_EQ(front.points.front().metrics, Vector2d(1, 0));
    EXPECT_EQ(front.points.back().metrics, Vector2d(0, 1));
    const FrontExploration exploration = Exploration(front);
    const int last = exploration.size() - 1;
    EXPECT_EQ(*exploration.AtEmbedding(VectorXd::Zero(1)), 0);
    EXPECT_EQ(*exploration.AtEmbedding(VectorXd::Ones(1)), last);
    EXPECT_EQ(*exploration.AtMetric(0, 0), last);
    EXPECT_EQ(exploration.Walk(last / 2, 0, 1000).back(), last);
    EXPECT_EQ(exploration.Walk(last / 2, 1, 1000).back(), 0);
    EXPECT_EQ(exploration.Within({{true, 0, {}, 0.0}}).points, std::vector<int>{last});
  }
}

class EndsOfDiscoveries : public testing::TestWithParam<int> {
 protected:
  void ExpectEnds(AskTell& discovery, Evaluator& evaluator) {
    ASSERT_TRUE(pareto::Run(discovery, evaluator, {}).ok());
    ExpectReachesAsFar(discovery.archive(), discovery.front());
  }

  Index d() const { return GetParam(); }
};
INSTANTIATE_TEST_SUITE_P(Metrics, EndsOfDiscoveries, testing::Values(2, 3, 4, 5, 6));

TEST_P(EndsOfDiscoveries, AreKeptForAnySeed) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    FormulaEvaluator evaluator(Distances(d()));
    ExpectEnds(**Discovery::Create(Box(3), d(), Budget(400, seed)), evaluator);
  }
}

TEST_P(EndsOfDiscoveries, AreKeptWithConstraintsAndSteps) {
  DesignSpace space = Box(3);
  space.step = Eigen::Vector3d(0, 0.05, 0);
  Discovery::Options options = Budget(300, 2);
  options.constraints = 1;
  // Off the corners, so that ends are on the limit.
  FormulaEvaluator evaluator(Distances(d()), [](const VectorXd& x) {
    return VectorXd::Constant(1, 0.15 - (x.array() - 0.1).square().sum());
  });
  ExpectEnds(**Discovery::Create(space, d(), options), evaluator);
}

TEST_P(EndsOfDiscoveries, AreKeptWithTolerances) {
  const Robustness robustness{.tolerances = {{0, "a", 0.05, Tolerance::Distribution::kUniform}},
                              .deviations = 3,
                              .range = Box(3)};
  FormulaEvaluator evaluator(Distances(d()));
  RobustEvaluator robust(evaluator, robustness);
  ExpectEnds(**Discovery::Create(Box(3), d(), Budget(200, 3)), robust);
}

TEST_P(EndsOfDiscoveries, AreKeptOfMergedFronts) {
  DesignSpace space = Box(4);
  space.upper[0] = 2;
  space.step = Eigen::Vector4d(1, 0, 0, 0);
  const Formula distances = Distances(d());
  FormulaEvaluator evaluator([&](const VectorXd& x) {
    return VectorXd(distances(x.tail(3)).array() + 0.1 * std::cos(3 * x[0]));
  });
  auto merged = *MakeDiscovery(space, {{0, {0, 1, 2}}}, d(), Budget(400, 4));
  ExpectEnds(*merged, evaluator);
}

TEST_P(EndsOfDiscoveries, AreKeptWhenGivenAndWhenResumed) {
  Discovery::Options options = Budget(200, 5);
  options.initial_designs = MatrixXd::Identity(3, 3);
  const auto make = [&] { return *Discovery::Create(Box(3), d(), options); };
  std::string saved;
  RunOptions run;
  run.checkpoint = [&](const std::vector<std::pair<std::int64_t, Evaluation>>& batch) {
    DiscoveryCheckpoint part;
    part.results.insert(batch.begin(), batch.end());
    saved += Serialize(part);
    return absl::OkStatus();
  };
  auto first = make();
  FormulaEvaluator lost(Distances(d()));
  lost.lost_after = 90;
  EXPECT_TRUE(absl::IsUnavailable(pareto::Run(*first, lost, run)));
  ExpectReachesAsFar(first->archive(), first->front());
  auto second = make();
  FormulaEvaluator evaluator(Distances(d()));
  ASSERT_TRUE(pareto::Run(*second, evaluator, {}, ParseCheckpoint(saved)->results).ok());
  ExpectReachesAsFar(second->archive(), second->front());
}

// Through outlier repair, finishing and polishing, with pieces that are followed by gradients.
TEST(EndsOfBenchmarks, AreKept) {
  for (const auto& [name, size, evaluations, gradients] :
       std::vector<std::tuple<const char*, int, int, bool>>{{"ZDT1", 3, 1600, false},
                                                            {"ZDT3", 15, 300, true},
                                                            {"Kursawe", 3, 500, false},
                                                            {"OSY", 6, 600, false},
                                                            {"DTLZ7", 6, 500, true}}) {
    SCOPED_TRACE(name);
    const BenchmarkProblem problem = *MakeBenchmarkProblem(name, size);
    Discovery::Options options = Budget(evaluations, 6);
    options.constraints = problem.constraint_count;
    auto discovery = *Discovery::Create(problem.space, problem.metric_count, options);
    while (!discovery->Finished()) {
      const auto proposal = discovery->Ask();
      if (!proposal) continue;
      ASSERT_TRUE(discovery->Tell(proposal->number, problem.evaluate(proposal->x, gradients)).ok());
    }
    ExpectReachesAsFar(discovery->archive(), discovery->front());
  }
}

}  // namespace
}  // namespace mortise::pareto
