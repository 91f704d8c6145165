// Sampling for what is interpolated beside the outputs: its errors are told from outside.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "common/base/errors.h"
#include "common/maps/map_sampling.h"
#include "tests/unit/common/maps/random_tree.h"

namespace mortise::maps {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// What is interpolated from outside: a step along the first of three directions, narrow at 0.3.
double Step(const Eigen::VectorXd& x) {
  return std::tanh(12 * (x[0] - .3)) * (1 + .1 * x[1]) + x[2];
}

template <typename Function>
double Interpolated(const MapSampling& sampling, const Eigen::VectorXd& point,
                    const Function& function) {
  const PointWeights weights = sampling.tree().Weights(point);
  double sum = 0;
  for (std::size_t k = 0; k < weights.samples.size(); ++k) {
    sum += weights.weights[static_cast<Eigen::Index>(k)] *
           function(sampling.PositionOf(sampling.PointOfSample(weights.samples[k])));
  }
  return sum;
}

// Measures an element at its probes, and how it bends from the corners to the middle of edges.
template <typename Function>
OutsideError Measured(const MapSampling& sampling, int element, const Function& function) {
  OutsideError error;
  for (const int probe : sampling.ProbesOf(element)) {
    const Eigen::VectorXd position = sampling.PositionOf(probe);
    error.error = std::max(
        error.error, std::abs(Interpolated(sampling, position, function) - function(position)));
  }
  const ElementBox box = sampling.tree().BoxOf(element);
  const Eigen::VectorXd centre = (box.low + box.high) / 2;
  error.bending = Eigen::VectorXd::Zero(centre.size());
  for (Eigen::Index d = 0; d < centre.size(); ++d) {
    Eigen::VectorXd low = centre, high = centre;
    low[d] = box.low[d];
    high[d] = box.high[d];
    error.bending[d] = std::abs(function(low) + function(high) - 2 * function(centre));
  }
  return error;
}

using Values = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;
using Outside = std::function<OutsideError(const MapSampling&, int element)>;

const Values kNoValues = [](const Eigen::VectorXd&) { return Eigen::VectorXd(0); };
const Outside kStep = [](const MapSampling& sampling, int element) {
  return Measured(sampling, element, Step);
};

template <typename Thing>
Thing TakeOne(std::vector<Thing>& things, Random& random) {
  const std::size_t chosen = random.Index(things.size());
  const Thing thing = things[chosen];
  things.erase(things.begin() + static_cast<std::ptrdiff_t>(chosen));
  return thing;
}

// Answers points and errors in an order by `seed`, `most` answers at the most.
void Answer(MapSampling& sampling, const Values& values, const Outside& outside,
            std::uint64_t seed = 0, int most = 1'000'000) {
  Random random(seed);
  std::vector<AskedPoint> waiting;
  for (int n = 0; n < most && !sampling.Done(); ++n) {
    std::vector<int> awaited = sampling.AwaitedErrors();
    if (!awaited.empty()) {
      EXPECT_THAT(sampling.Ask(10), IsEmpty());
      const int element = TakeOne(awaited, random);
      ASSERT_TRUE(sampling.TellError(element, outside(sampling, element)).ok());
      continue;
    }
    for (AskedPoint& point : sampling.Ask(1 + static_cast<int>(seed) * 3)) {
      waiting.push_back(std::move(point));
    }
    ASSERT_FALSE(waiting.empty());
    const AskedPoint point = TakeOne(waiting, random);
    ASSERT_TRUE(sampling.Tell(point.number, values(point.position)).ok());
  }
}

MapSampling Sampling(int dimension, int outputs, MapSamplingOptions options) {
  options.errors_from_outside = true;
  return *MapSampling::Create(dimension, outputs, options);
}

void ExpectSame(const MapContent& a, const MapContent& b) {
  EXPECT_EQ(a.splits, b.splits);
  EXPECT_EQ(a.values, b.values);
  EXPECT_EQ(a.errors, b.errors);
  EXPECT_EQ(a.cut_off, b.cut_off);
}

TEST(OutsideErrors, DriveSplitsToWhereItBends) {
  MapSampling sampling = Sampling(3, 0, {.budget = 150});
  Answer(sampling, kNoValues, kStep);
  int along = 0, splits = 0;
  for (const ElementSplit& split : sampling.tree().history()) {
    ++splits;
    along += split.direction == 0 ? 1 : 0;
  }
  EXPECT_GT(along, .8 * splits);
  // It is no worse than what the values themselves lead to.
  auto plain = *MapSampling::Create(3, 1, {.budget = 150});
  Answer(
      plain, [](const Eigen::VectorXd& x) { return Eigen::VectorXd::Constant(1, Step(x)); }, kStep);
  Random random(4);
  double largest = 0, plainly = 0;
  for (int n = 0; n < 1000; ++n) {
    const Eigen::VectorXd point = RandomPoint(3, random);
    largest = std::max(largest, std::abs(Interpolated(sampling, point, Step) - Step(point)));
    plainly = std::max(plainly, std::abs(Interpolated(plain, point, Step) - Step(point)));
  }
  EXPECT_LT(largest, 1.2 * plainly);
  EXPECT_LT(largest, .1);
}

TEST(OutsideErrors, AreNotAwaitedWithoutBeingAskedFor) {
  auto sampling = *MapSampling::Create(2, 1, {.budget = 60});
  while (!sampling.Done()) {
    EXPECT_THAT(sampling.AwaitedErrors(), IsEmpty());
    for (const AskedPoint& point : sampling.Ask(100)) {
      ASSERT_TRUE(
          sampling.Tell(point.number, Eigen::VectorXd::Constant(1, point.position.norm())).ok());
    }
  }
}

// Outputs and what comes from outside bend in different places: both become exact there.
TEST(OutsideErrors, CountBesideThoseOfOutputs) {
  const Values ramp = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd::Constant(1, std::tanh(6 * (x[1] - .7)));
  };
  const Outside step = [](const MapSampling& sampling, int element) {
    return Measured(sampling, element,
                    [](const Eigen::VectorXd& x) { return std::tanh(6 * (x[0] - .3)); });
  };
  MapSampling sampling = Sampling(2, 1, {.budget = 900, .tolerance = .02});
  Answer(sampling, ramp, step);
  const MapSamplingProgress progress = sampling.Progress();
  EXPECT_LE(progress.outside_error, .02);
  EXPECT_LE(progress.errors.largest[0], .02 * progress.errors.range[0]);
  EXPECT_LT(progress.asked, 900);
  const auto edges = [&](double x, double y) {
    const ElementBox box = sampling.tree().BoxOf(sampling.tree().Locate(Eigen::Vector2d(x, y)));
    return Eigen::Vector2d(box.high - box.low);
  };
  EXPECT_LT(edges(.3, .1)[0], edges(.9, .1)[0]);
  EXPECT_LT(edges(.9, .7)[1], edges(.9, .1)[1]);
}

TEST(OutsideErrors, GiveTheSameMapInWhateverOrderTheyCome) {
  const MapSamplingOptions options{.budget = 120, .round_points = 20};
  const Values values = [](const Eigen::VectorXd& x) {
    return Eigen::VectorXd::Constant(1, x[1] * x[1]);
  };
  MapSampling expected = Sampling(3, 1, options);
  Answer(expected, values, kStep);
  for (std::uint64_t seed = 1; seed < 5; ++seed) {
    MapSampling other = Sampling(3, 1, options);
    Answer(other, values, kStep, seed);
    ExpectSame(*expected.Content(), *other.Content());
  }
}

TEST(OutsideErrors, GoOnFromACheckpointAsIfNothingHadHappened) {
  const MapSamplingOptions options{.budget = 100, .round_points = 12};
  MapSampling expected = Sampling(3, 0, options);
  Answer(expected, kNoValues, kStep);
  for (int answers = 1; answers < 160; answers += 7) {
    MapSampling begun = Sampling(3, 0, options);
    Answer(begun, kNoValues, kStep, 2, answers);
    MapSamplingOptions same = options;
    same.errors_from_outside = true;
    auto restored = MapSampling::Restore(3, 0, same, begun.Checkpoint());
    ASSERT_TRUE(restored.ok()) << restored.status();
    EXPECT_EQ(restored->AwaitedErrors(), begun.AwaitedErrors());
    EXPECT_EQ(restored->Progress().told, begun.Progress().told);
    Answer(*restored, kNoValues, kStep);
    ExpectSame(*expected.Content(), *restored->Content());
  }
}

TEST(OutsideErrors, AreAwaitedAgainWhereInterpolationChanges) {
  MapSampling sampling = Sampling(2, 0, {.budget = 200, .round_points = 1});
  std::map<int, std::vector<std::pair<int, double>>> read;  // of each element at its probes
  int again = 0;
  while (!sampling.Done()) {
    for (const AskedPoint& point : sampling.Ask(100)) {
      ASSERT_TRUE(sampling.Tell(point.number, Eigen::VectorXd(0)).ok());
    }
    const std::vector<int> awaited = sampling.AwaitedErrors();
    for (const int element : sampling.tree().Elements()) {
      std::vector<std::pair<int, double>> now;
      for (const int probe : sampling.ProbesOf(element)) {
        const PointWeights weights = sampling.tree().Weights(sampling.PositionOf(probe));
        for (std::size_t k = 0; k < weights.samples.size(); ++k) {
          now.emplace_back(weights.samples[k], weights.weights[static_cast<Eigen::Index>(k)]);
        }
      }
      const bool is_awaited = std::count(awaited.begin(), awaited.end(), element) > 0;
      if (now != read[element]) {
        EXPECT_TRUE(is_awaited);
        again += read[element].empty() ? 0 : 1;
      }
      read[element] = now;
    }
    for (const int element : awaited) {
      const OutsideError error = Measured(
          sampling, element, [](const Eigen::VectorXd& x) { return std::exp(-3 * x.sum()); });
      ASSERT_TRUE(sampling.TellError(element, error).ok());
    }
  }
  EXPECT_GT(again, 5);
}

// As where a hole appears at x = 0.6, whatever y: elements that hold both kinds cannot be
// interpolated.
const Outside kHole = [](const MapSampling& sampling, int element) {
  OutsideError error;
  const std::vector<int>& samples = sampling.tree().ElementSamples(element);
  const auto holes = std::count_if(samples.begin(), samples.end(), [&](int sample) {
    return sampling.PositionOf(sampling.PointOfSample(sample))[0] > .6;
  });
  error.failed = holes != 0 && holes != static_cast<std::ptrdiff_t>(samples.size());
  error.bending = Eigen::Vector2d(1, 0);
  return error;
};

TEST(OutsideErrors, MakeSmallWhatCannotBeInterpolatedAlongItsOwnDirections) {
  MapSampling sampling = Sampling(2, 0, {.budget = 300, .tolerance = .1, .cut_off_depth = 4});
  Answer(sampling, kNoValues, kHole);
  EXPECT_EQ(sampling.Progress().failed, 0);
  EXPECT_EQ(sampling.Progress().outside_error, 0);
  const auto map = *InterpolationMap::Create(*sampling.Content());
  int lacking = 0;
  for (const int element : map.tree().Elements()) {
    if (!kHole(sampling, element).failed) continue;
    ++lacking;
    const ElementBox box = map.tree().BoxOf(element);
    EXPECT_NEAR((box.low[0] + box.high[0]) / 2, .6, 1.0 / 32);
    EXPECT_LE(map.tree().DepthOf(element, 1), 2);
  }
  EXPECT_GT(lacking, 0);
  // There is nothing but what cannot be interpolated.
  EXPECT_EQ(sampling.Progress().cut_off, lacking);
  EXPECT_EQ(sampling.Progress().lacking_outside, 0);
}

// Values there are as exact as elsewhere, however small the budget for what fails is.
TEST(OutsideErrors, LeaveOutputsTheirValuesWhereTheyFail) {
  const auto bump = [](const Eigen::VectorXd& x) {
    return std::exp(-40 * (Eigen::Vector2d(x) - Eigen::Vector2d(.6, .5)).squaredNorm());
  };
  const Values values = [&](const Eigen::VectorXd& x) {
    return Eigen::VectorXd::Constant(1, bump(x));
  };
  MapSampling sampling = Sampling(2, 1, {.budget = 2000, .tolerance = .02, .cut_off_depth = 2});
  Answer(sampling, values, kHole);
  EXPECT_GT(sampling.Progress().lacking_outside, 0);
  EXPECT_LE(sampling.Progress().errors.largest[0], .02);
  EXPECT_LT(sampling.Progress().asked, 2000);
  const auto map = *InterpolationMap::Create(*sampling.Content());
  Random random(4);
  int there = 0;
  for (int n = 0; n < 1000; ++n) {
    const Eigen::VectorXd point = RandomPoint(2, random);
    double value = 0, error = 0;
    ASSERT_TRUE(map.EvaluateOne(point.data(), &value, &error, nullptr));
    EXPECT_NEAR(value, bump(point), .05);
    const bool fails = kHole(sampling, map.tree().Locate(point)).failed;
    there += fails ? 1 : 0;
    if (fails) {
      EXPECT_LE(error, .02);
    }
  }
  EXPECT_GT(there, 20);
}

TEST(OutsideErrors, LeaveTheMapAsItWasUntilAllAreTold) {
  MapSampling sampling = Sampling(3, 0, {.budget = 100});
  EXPECT_EQ(DetailOf(sampling.Content().status()).reason, "MAP_NOT_SAMPLED");
  MapContent before;
  while (!sampling.Done()) {
    for (const AskedPoint& point : sampling.Ask(100)) {
      ASSERT_TRUE(sampling.Tell(point.number, Eigen::VectorXd(0)).ok());
    }
    for (const int element : sampling.AwaitedErrors()) {
      if (before.dimension > 0) ExpectSame(*sampling.Content(), before);
      OutsideError error = Measured(sampling, element, Step);
      error.failed = element % 5 == 3;
      ASSERT_TRUE(sampling.TellError(element, error).ok());
    }
    before = *sampling.Content();
  }
}

TEST(OutsideErrors, MayBeToldAnewWhileOthersAreAwaited) {
  MapSampling sampling = Sampling(2, 0, {.budget = 100, .tolerance = .1, .round_points = 1});
  std::set<int> told;
  const Outside falling = [](const MapSampling&, int) {
    return OutsideError{.error = 1, .bending = Eigen::Vector2d(1, 1)};
  };
  Answer(sampling, kNoValues, falling, 0, 40);
  // The range has grown: all that was told before is less of it.
  while (sampling.AwaitedErrors().empty()) {
    for (const AskedPoint& point : sampling.Ask(100)) {
      ASSERT_TRUE(sampling.Tell(point.number, Eigen::VectorXd(0)).ok());
    }
  }
  const std::vector<int> awaited = sampling.AwaitedErrors();
  for (const int element : sampling.tree().Elements()) {
    if (std::count(awaited.begin(), awaited.end(), element) > 0) continue;
    ASSERT_TRUE(sampling.TellError(element, {.error = .01}).ok());
  }
  for (const int element : awaited) {
    ASSERT_TRUE(sampling.TellError(element, {.error = .02}).ok());
  }
  EXPECT_EQ(sampling.Progress().outside_error, .02);
  EXPECT_TRUE(sampling.Done());
}

TEST(OutsideErrors, RefuseWhatIsNone) {
  const auto field = [](const absl::Status& status) { return DetailOf(status).field; };
  EXPECT_EQ(field(MapSampling::Create(2, 0, {}).status()), "outputs");
  MapSamplingOptions cubic{.basis = Basis::kCubic};
  cubic.errors_from_outside = true;
  EXPECT_EQ(field(MapSampling::Create(2, 1, cubic).status()), "options.errors_from_outside");
  MapSampling sampling = Sampling(2, 0, {.budget = 60});
  EXPECT_EQ(field(sampling.TellError(0, {})), "element");
  for (const AskedPoint& point : sampling.Ask(100)) {
    ASSERT_TRUE(sampling.Tell(point.number, Eigen::VectorXd(0)).ok());
  }
  EXPECT_THAT(sampling.AwaitedErrors(), ElementsAre(0));
  EXPECT_EQ(field(sampling.TellError(1, {})), "element");
  EXPECT_EQ(field(sampling.TellError(0, {.error = -1})), "error.error");
  EXPECT_EQ(field(sampling.TellError(0, {.error = std::nan("")})), "error.error");
  EXPECT_EQ(field(sampling.TellError(0, {.bending = Eigen::Vector3d(1, 1, 1)})), "error.bending");
  EXPECT_EQ(field(sampling.TellError(0, {.bending = Eigen::Vector2d(1, -1)})), "error.bending");
  MapSamplingCheckpoint wrong = sampling.Checkpoint();
  wrong.errors = {{0, {}}, {7, {}}};
  MapSamplingOptions outside{.budget = 60};
  outside.errors_from_outside = true;
  EXPECT_EQ(field(MapSampling::Restore(2, 0, outside, wrong).status()), "checkpoint.errors[1]");
}

}  // namespace
}  // namespace mortise::maps
