#include "common/maps/map_sampling.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/base/errors.h"
#include "tests/unit/common/maps/random_tree.h"

namespace mortise::maps {
namespace {

Eigen::VectorXd Smooth(const Eigen::VectorXd& x) {
  return Eigen::Vector2d(std::sin(3 * x[0]) + x[1] * x[1], std::exp(-4 * x[0] * x[1]));
}

// Answers everything that is asked, `batch` points at a time, each batch in an order by `seed`.
template <typename Function>
void Answer(MapSampling& sampling, const Function& function, int batch = 1000,
            std::uint64_t seed = 0) {
  Random random(seed);
  std::vector<AskedPoint> waiting;
  while (!sampling.Done()) {
    for (AskedPoint& point : sampling.Ask(batch)) waiting.push_back(std::move(point));
    ASSERT_FALSE(waiting.empty());
    const std::size_t chosen = seed == 0 ? 0 : random.Index(waiting.size());
    const AskedPoint point = waiting[chosen];
    waiting.erase(waiting.begin() + static_cast<std::ptrdiff_t>(chosen));
    const absl::StatusOr<Eigen::VectorXd> answer = function(point.position);
    ASSERT_TRUE((answer.ok() ? sampling.Tell(point.number, *answer)
                             : sampling.TellFailure(point.number, answer.status()))
                    .ok());
  }
}

MapSampling Sampling(int dimension, int outputs, const MapSamplingOptions& options) {
  return *MapSampling::Create(dimension, outputs, options);
}

void ExpectSame(const MapContent& a, const MapContent& b) {
  EXPECT_EQ(a.splits, b.splits);
  EXPECT_EQ(a.values, b.values);
  EXPECT_EQ(a.errors, b.errors);
  EXPECT_EQ(a.cut_off, b.cut_off);
}

TEST(MapSampling, GivesTheSameMapInWhateverOrderAnswersCome) {
  const MapSamplingOptions options{.budget = 150, .round_points = 20};
  MapSampling expected = Sampling(2, 2, options);
  Answer(expected, Smooth);
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    MapSampling other = Sampling(2, 2, options);
    Answer(other, Smooth, static_cast<int>(seed * 3), seed);
    ExpectSame(*expected.Content(), *other.Content());
  }
}

TEST(MapSampling, GoesOnFromACheckpointAsIfNothingHadHappened) {
  const MapSamplingOptions options{.budget = 120, .round_points = 16};
  MapSampling expected = Sampling(2, 2, options);
  Answer(expected, Smooth);
  MapSampling begun = Sampling(2, 2, options);
  std::set<int> told;
  while (told.size() < 57) {
    std::vector<AskedPoint> asked = begun.Ask(5);
    std::reverse(asked.begin(), asked.end());
    if (told.size() > 40 && asked.size() > 1) asked.pop_back();  // one is lost
    for (const AskedPoint& point : asked) {
      ASSERT_TRUE(begun.Tell(point.number, Smooth(point.position)).ok());
      told.insert(point.number);
    }
    if (asked.empty()) break;
  }
  EXPECT_GT(told.size(), 40U);
  auto restored = MapSampling::Restore(2, 2, options, begun.Checkpoint());
  ASSERT_TRUE(restored.ok()) << restored.status();
  for (const AskedPoint& point : restored->Ask(1000)) {
    EXPECT_FALSE(told.contains(point.number));
    ASSERT_TRUE(restored->Tell(point.number, Smooth(point.position)).ok());
  }
  Answer(*restored, Smooth);
  ExpectSame(*expected.Content(), *restored->Content());
}

TEST(MapSampling, AsksNoMoreThanTheBudgetAndNothingTwice) {
  for (const int budget : {6, 7, 30, 101}) {
    MapSampling sampling = Sampling(2, 2, {.budget = budget});
    std::set<std::pair<double, double>> positions;
    int asked = 0;
    Answer(sampling, [&](const Eigen::VectorXd& x) {
      ++asked;
      EXPECT_TRUE(positions.emplace(x[0], x[1]).second);
      return Smooth(x);
    });
    EXPECT_LE(asked, budget);
    EXPECT_GE(asked, budget - 8);
    EXPECT_EQ(sampling.Progress().asked, asked);
    EXPECT_EQ(sampling.Progress().told, asked);
  }
}

TEST(MapSampling, EndsWhenTheToleranceIsReached) {
  MapSampling sampling = Sampling(2, 2, {.budget = 5000, .tolerance = .01});
  Answer(sampling, Smooth);
  const MapSamplingProgress progress = sampling.Progress();
  EXPECT_LT(progress.asked, 3000);
  EXPECT_GT(progress.errors.probes, 20);
  for (int output : {0, 1}) {
    EXPECT_LE(progress.errors.largest[output], .01 * progress.errors.range[output]);
    EXPECT_LE(progress.errors.mean[output], progress.errors.largest[output]);
  }
}

TEST(MapSampling, SplitsAlongTheDirectionThatBends) {
  MapSampling sampling = Sampling(3, 1, {.budget = 100});
  Answer(sampling, [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd::Constant(1, std::sin(5 * x[1]) + 2 * x[0] - x[0] * x[2]);
  });
  int along = 0;
  for (const ElementSplit& split : sampling.tree().history()) along += split.direction == 1 ? 1 : 0;
  EXPECT_EQ(along, static_cast<int>(sampling.tree().history().size()));
}

// A narrow peak beside the centres: errors at centres alone stay small around it.
TEST(MapSampling, FindsWhatTheCentresOfElementsDoNotShow) {
  const auto peak = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd::Constant(1,
                                     .02 / (.02 + std::pow(x[0] - .3, 2) + std::pow(x[1] - .6, 2)));
  };
  MapSampling sampling = Sampling(2, 1, {.budget = 150});
  Answer(sampling, peak);
  const auto map = *InterpolationMap::Create(*sampling.Content());
  Random random(4);
  double largest = 0;
  for (int n = 0; n < 2000; ++n) {
    const Eigen::VectorXd point = RandomPoint(2, random);
    largest = std::max(largest, std::abs(map.Evaluate(point).values(0) - peak(point)[0]));
  }
  EXPECT_LT(largest, .09);
}

TEST(MapSampling, DoesNotChaseNoiseBelowItsFloor) {
  const auto noisy = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd::Constant(1, x.sum() + .01 * std::sin(1e5 * x[0] + 3e5 * x[1]));
  };
  MapSampling chasing = Sampling(2, 1, {.budget = 400, .tolerance = .001});
  Answer(chasing, noisy);
  EXPECT_GT(chasing.Progress().asked, 350);
  MapSampling calm = Sampling(2, 1, {.budget = 400, .tolerance = .001, .noise_floor = {.025}});
  Answer(calm, noisy);
  EXPECT_LT(calm.Progress().asked, 50);
}

TEST(MapSampling, CutsOffWhereItFailsAndGoesOnElsewhere) {
  const auto partial = [](const Eigen::VectorXd& x) -> absl::StatusOr<Eigen::VectorXd> {
    if (x[0] + x[1] > 1.6) return absl::FailedPreconditionError("the shelf meets the top");
    return Smooth(x);
  };
  MapSampling sampling = Sampling(2, 2, {.budget = 300});
  Answer(sampling, partial);
  const MapSamplingProgress progress = sampling.Progress();
  EXPECT_GT(progress.failed, 0);
  EXPECT_GT(progress.cut_off, 0);
  ASSERT_EQ(static_cast<int>(sampling.Failures().size()), progress.failed);
  for (const auto& [position, reason] : sampling.Failures()) {
    EXPECT_GT(position.sum(), 1.6);
    EXPECT_EQ(reason, "the shelf meets the top");
  }
  const auto map = *InterpolationMap::Create(*sampling.Content());
  Random random(4);
  int lost = 0, fails = 0;
  for (int n = 0; n < 2000; ++n) {
    const Eigen::VectorXd point = RandomPoint(2, random);
    const bool has_value = map.Evaluate(point).values.allFinite();
    if (point.sum() > 1.6) {
      ++fails;
      EXPECT_FALSE(has_value && point.sum() > 1.75);
    } else if (!has_value) {
      ++lost;
    } else {
      EXPECT_LT((map.Evaluate(point).values - Smooth(point)).cwiseAbs().maxCoeff(), .1);
    }
  }
  EXPECT_GT(fails, 50);
  EXPECT_LT(lost, 300);
}

TEST(MapSampling, MakesCubicMapsThatAreMoreExactThanLinearOnes) {
  double largest[2] = {0, 0};
  for (const Basis basis : {Basis::kLinear, Basis::kCubic}) {
    MapSampling sampling = Sampling(2, 2, {.basis = basis, .budget = 120});
    Answer(sampling, Smooth);
    const auto map = *InterpolationMap::Create(*sampling.Content());
    EXPECT_EQ(map.tree().basis(), basis);
    Random random(4);
    for (int n = 0; n < 1000; ++n) {
      const Eigen::VectorXd point = RandomPoint(2, random);
      double& error = largest[basis == Basis::kCubic ? 1 : 0];
      error = std::max(error, (map.Evaluate(point).values - Smooth(point)).cwiseAbs().maxCoeff());
    }
    const MapErrors errors = sampling.Progress().errors;
    EXPECT_GT(errors.probes, 10);
    EXPECT_GT(errors.largest.maxCoeff(), largest[basis == Basis::kCubic ? 1 : 0] / 10);
  }
  EXPECT_LT(largest[1], largest[0] / 2);
}

// What failed is not read: its neighbours' values are as exact as without it.
TEST(MapSampling, TakesNoiseFloorsThatAreKnownBeforeAnythingIsTold) {
  const MapSamplingOptions given{.budget = 400, .tolerance = .001, .noise_floor = {.025}};
  MapSampling expected = Sampling(2, 1, given);
  MapSampling later = Sampling(2, 1, {.budget = 400, .tolerance = .001});
  EXPECT_EQ(DetailOf(later.SetNoiseFloor({1, 2})).field, "noise_floor");
  EXPECT_EQ(DetailOf(later.SetNoiseFloor({-1})).field, "noise_floor");
  const std::vector<AskedPoint> first = later.Ask(3);
  ASSERT_TRUE(later.SetNoiseFloor({.025}).ok());
  const auto bowl = [](const Eigen::VectorXd& x) { return std::sin(3 * x[0]) + x[1] * x[1]; };
  for (const AskedPoint& point : first) {
    ASSERT_TRUE(later.Tell(point.number, Eigen::VectorXd::Constant(1, bowl(point.position))).ok());
  }
  EXPECT_EQ(DetailOf(later.SetNoiseFloor({0})).reason, "SAMPLING_HAS_BEGUN");
  for (MapSampling* const sampling : {&expected, &later}) {
    while (!sampling->Done()) {
      for (const AskedPoint& point : sampling->Ask(10)) {
        ASSERT_TRUE(
            sampling->Tell(point.number, Eigen::VectorXd::Constant(1, bowl(point.position))).ok());
      }
    }
  }
  EXPECT_EQ(later.Progress().asked, expected.Progress().asked);
  EXPECT_EQ(later.Content()->splits, expected.Content()->splits);
}

TEST(MapSampling, MakesCubicMapsBesideWhatIsCutOff) {
  MapSampling sampling = Sampling(2, 2, {.basis = Basis::kCubic, .budget = 200});
  Answer(sampling, [](const Eigen::VectorXd& x) -> absl::StatusOr<Eigen::VectorXd> {
    if (x[0] > .8) return absl::FailedPreconditionError("too wide");
    return Eigen::VectorXd(Smooth(x).array() + 100);
  });
  const auto map = *InterpolationMap::Create(*sampling.Content());
  EXPECT_GT(sampling.Progress().cut_off, 0);
  Random random(4);
  int good = 0;
  for (int n = 0; n < 1000; ++n) {
    const Eigen::VectorXd point = RandomPoint(2, random);
    const MapValues values = map.Evaluate(point);
    if (!values.values.allFinite()) continue;
    ++good;
    const Eigen::VectorXd truth = Smooth(point).array() + 100;
    EXPECT_LT((values.values - truth).cwiseAbs().maxCoeff(), .1);
  }
  EXPECT_GT(good, 600);
}

TEST(MapSampling, EndsWhenEverythingFails) {
  MapSampling sampling = Sampling(2, 2, {.budget = 300});
  Answer(sampling, [](const Eigen::VectorXd&) -> absl::StatusOr<Eigen::VectorXd> {
    return absl::UnavailableError("no licence");
  });
  EXPECT_EQ(sampling.Progress().cut_off, sampling.Progress().elements);
  EXPECT_LE(sampling.Progress().asked, 10);
}

TEST(MapSampling, TakesValuesThatAreNotFiniteAsFailures) {
  MapSampling sampling = Sampling(1, 1, {.budget = 20});
  Answer(sampling, [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd::Constant(1, x[0] > .9 ? std::nan("") : x[0]);
  });
  EXPECT_GT(sampling.Progress().failed, 0);
  EXPECT_LT(sampling.Progress().cut_off, sampling.Progress().elements);
}

TEST(MapSampling, HasAContentAfterItsFirstRoundOnly) {
  MapSampling sampling = Sampling(2, 2, {.budget = 60});
  EXPECT_EQ(DetailOf(sampling.Content().status()).reason, "MAP_NOT_SAMPLED");
  const std::vector<AskedPoint> first = sampling.Ask(100);
  for (const AskedPoint& point : first) {
    ASSERT_TRUE(sampling.Tell(point.number, Smooth(point.position)).ok());
  }
  // The next round has split the tree already; the content is that of the round before.
  ASSERT_TRUE(sampling.Content().ok());
  EXPECT_TRUE(sampling.Content()->splits.empty());
  EXPECT_TRUE(InterpolationMap::Create(*sampling.Content()).ok());
}

TEST(MapSampling, RefusesWrongArgumentsAndAnswers) {
  const auto field = [](const absl::Status& status) { return DetailOf(status).field; };
  const auto created = [&](const MapSamplingOptions& options) {
    return field(MapSampling::Create(2, 2, options).status());
  };
  EXPECT_EQ(field(MapSampling::Create(0, 1, {}).status()), "dimension");
  EXPECT_EQ(field(MapSampling::Create(2, 0, {}).status()), "outputs");
  EXPECT_EQ(created({.budget = 5}), "options.budget");
  EXPECT_EQ(created({.tolerance = -1}), "options.tolerance");
  EXPECT_EQ(created({.noise_floor = {1}}), "options.noise_floor");
  EXPECT_EQ(created({.scale = {1, -1}}), "options.scale");
  EXPECT_EQ(created({.round_points = 0}), "options.round_points");

  MapSampling sampling = Sampling(2, 2, {.budget = 60});
  EXPECT_EQ(field(sampling.Tell(0, Eigen::Vector2d(1, 1))), "number");
  const std::vector<AskedPoint> asked = sampling.Ask(1);
  EXPECT_EQ(field(sampling.Tell(asked[0].number, Eigen::VectorXd::Ones(3))), "values");
  EXPECT_TRUE(sampling.Tell(asked[0].number, Eigen::Vector2d(1, 1)).ok());
  EXPECT_EQ(field(sampling.Tell(asked[0].number, Eigen::Vector2d(1, 1))), "number");

  MapSamplingCheckpoint wrong;
  wrong.numbers = {5000};
  wrong.failures = {""};
  wrong.values = Eigen::MatrixXd::Zero(2, 1);
  EXPECT_EQ(field(MapSampling::Restore(2, 2, {}, wrong).status()), "checkpoint.numbers[0]");
  wrong.failures.clear();
  EXPECT_EQ(field(MapSampling::Restore(2, 2, {}, wrong).status()), "checkpoint");
}

}  // namespace
}  // namespace mortise::maps
