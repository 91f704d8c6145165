#include "services/pareto/discovery/track_pool.h"

#include <gtest/gtest.h>

#include <deque>
#include <map>
#include <vector>

namespace mortise::pareto {
namespace {

using Eigen::VectorXd;

// A source of given points, which keeps what it is told.
class ScriptedSource : public PointSource {
 public:
  ScriptedSource(std::deque<double> points, std::vector<std::size_t>* told)
      : points_(std::move(points)), told_(told) {}

  std::optional<VectorXd> Ask(Archive&) override {
    if (points_.empty()) return std::nullopt;
    const double value = points_.front();
    points_.pop_front();
    ++outstanding_;
    return VectorXd::Constant(1, value);
  }
  void Tell(Archive&, std::size_t entry) override {
    --outstanding_;
    told_->push_back(entry);
  }
  bool Finished() const override { return points_.empty() && outstanding_ == 0; }

 private:
  std::deque<double> points_;
  std::vector<std::size_t>* told_;
  int outstanding_ = 0;
};

class TrackPoolTest : public testing::Test {
 protected:
  std::int64_t Start(std::deque<double> points, TrackKind kind = TrackKind::kGap) {
    return pool_.Start(Scripted(std::move(points)), kind);
  }

  std::unique_ptr<PointSource> Scripted(std::deque<double> points) {
    return std::make_unique<ScriptedSource>(std::move(points), &told_.emplace_back());
  }

  std::optional<TrackPool::Request> AskFor(std::int64_t number, bool only_polishes = false) {
    return pool_.Ask(archive_, number, find_, only_polishes);
  }

  TrackPool pool_;
  Archive archive_;
  std::deque<std::vector<std::size_t>> told_;  // by track, in the order of starting
  std::map<double, TrackPool::KnownDesign> known_;
  TrackPool::FindDesign find_ = [this](const VectorXd& u) {
    const auto at = known_.find(u[0]);
    return at == known_.end() ? TrackPool::KnownDesign() : at->second;
  };
};

TEST_F(TrackPoolTest, AsksTheOldestTrackThatHasAPoint) {
  const std::int64_t first = Start({1});
  const std::int64_t second = Start({2, 3});
  EXPECT_EQ(AskFor(0)->track, first);
  EXPECT_EQ(AskFor(1)->track, second);
  EXPECT_EQ(AskFor(2)->u[0], 3);
  EXPECT_FALSE(AskFor(3));
  EXPECT_EQ(pool_.started(), 2);
}

TEST_F(TrackPoolTest, AnswersInTheOrderAskedForThoughResultsComeInAnother) {
  Start({1, 2, 3});
  for (const int number : {0, 1, 2}) AskFor(number);
  EXPECT_TRUE(pool_.Answer(archive_, 2, 12));
  EXPECT_TRUE(pool_.Answer(archive_, 1, 11));
  EXPECT_TRUE(told_[0].empty());
  EXPECT_TRUE(pool_.Answer(archive_, 0, 10));
  EXPECT_EQ(told_[0], (std::vector<std::size_t>{10, 11, 12}));
  EXPECT_FALSE(pool_.Answer(archive_, 7, 17)) << "no track asked for it";
}

TEST_F(TrackPoolTest, EvaluatesNoDesignTwice) {
  known_[1] = {.entry = 41};
  known_[2] = {.number = 5};
  Start({1, 2, 3});
  const auto request = AskFor(6);
  ASSERT_TRUE(request);
  EXPECT_EQ(request->u[0], 3);
  EXPECT_EQ(told_[0], (std::vector<std::size_t>{41}));
  pool_.Answer(archive_, 5, 45);
  pool_.Answer(archive_, 6, 46);
  EXPECT_EQ(told_[0], (std::vector<std::size_t>{41, 45, 46}));
}

TEST_F(TrackPoolTest, AsksTheFinishingFirstAndTracksThatPolishOnly) {
  Start({1});
  const std::int64_t polish = Start({2}, TrackKind::kPolish);
  EXPECT_FALSE(pool_.IsFinishing());
  pool_.StartFinishing(Scripted({3}));
  EXPECT_TRUE(pool_.IsFinishing());
  EXPECT_EQ(pool_.started(), 2);
  EXPECT_EQ(AskFor(0, true)->u[0], 3);
  EXPECT_EQ(AskFor(1, true)->track, polish);
  EXPECT_FALSE(AskFor(2, true));
  EXPECT_EQ(AskFor(2)->u[0], 1);
}

TEST_F(TrackPoolTest, CountsWhatTracksBringAndRetiresThoseThatHaveFinished) {
  const std::int64_t first = Start({1});
  Start({2, 3}, TrackKind::kSweep);
  for (const int number : {0, 1}) AskFor(number);
  pool_.Credit(first, 0.25);
  pool_.Credit(99, 1);  // a track that is over
  pool_.Answer(archive_, 0, 0);
  std::vector<TrackKind> retired;
  pool_.RetireFinished([&](const Track& track) {
    retired.push_back(track.kind);
    EXPECT_EQ(track.gain, 0.25);
    EXPECT_EQ(track.evaluations, 1);
    Start({4}, TrackKind::kBridge);
  });
  EXPECT_EQ(retired, std::vector<TrackKind>{TrackKind::kGap});
  EXPECT_EQ(pool_.size(), 2u);
  EXPECT_TRUE(pool_.HasAny([](const Track& track) { return track.kind == TrackKind::kBridge; }));
  EXPECT_FALSE(pool_.HasAny([](const Track& track) { return track.kind == TrackKind::kGap; }));
}

}  // namespace
}  // namespace mortise::pareto
