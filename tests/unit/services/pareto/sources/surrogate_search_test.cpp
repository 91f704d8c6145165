// What a surrogate believes, and which designs it proposes.
#include "services/pareto/sources/surrogate_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "services/pareto/archive/stochastic_sampling.h"
#include "services/pareto/models/surrogate_model.h"

namespace mortise::pareto {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Distances from two places of the box: the designs between them are the front.
VectorXd Metrics(const VectorXd& u) {
  return Eigen::Vector2d((u.array() - 0.25).square().sum(), (u.array() - 0.75).square().sum());
}

ArchiveEntry FailedAt(const VectorXd& u) {
  ArchiveEntry entry;
  entry.u = u;
  return entry;
}

using Answer = std::function<ArchiveEntry(const VectorXd& u)>;

ArchiveEntry Answered(const VectorXd& u) {
  ArchiveEntry entry;
  entry.u = u;
  entry.evaluated = true;
  entry.metrics = Metrics(u);
  return entry;
}

Archive Sampled(Index D, int count, const Answer& answer = Answered) {
  Random random(1);
  Archive archive;
  for (const VectorXd& u : LatinHypercube(count, D, random)) archive.Add(answer(u));
  return archive;
}

DesignSpace UnitBox(Index D) { return {VectorXd::Zero(D), VectorXd::Ones(D)}; }

VectorXd Propose(SurrogateSearch& search, Archive& archive,
                 const std::vector<VectorXd>& under_way = {}) {
  const auto source = search.Next(archive, under_way);
  const std::optional<VectorXd> u = source->Ask(archive);
  EXPECT_TRUE(u);
  EXPECT_FALSE(source->Ask(archive));
  EXPECT_FALSE(source->Finished());
  return *u;
}

// Lets the surrogate propose and answers, so often; the archive with all.
Archive Searched(Archive archive, Index D, int proposals, const Answer& answer,
                 SurrogateSearch& search) {
  for (int k = 0; k < proposals; ++k) {
    const auto source = search.Next(archive, {});
    const std::optional<VectorXd> u = source->Ask(archive);
    EXPECT_TRUE(u && u->size() == D);
    source->Tell(archive, archive.Add(answer(*u)));
    EXPECT_TRUE(source->Finished());
  }
  return archive;
}

TEST(SurrogateModelTest, BelievesMetricsAsTheyAre) {
  const Archive archive = Sampled(3, 40);
  SurrogateModel model({});
  model.Learn(archive);
  const VectorXd u = Eigen::Vector3d(0.4, 0.5, 0.6);
  const VectorXd learnt = model.learnt().Of(Metrics(u));
  const SurrogateModel::Belief belief = model.At(u);
  ASSERT_EQ(belief.metrics.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_NEAR(belief.metrics[k].mean, learnt[static_cast<Index>(k)], 0.05);
  }
  EXPECT_EQ(belief.log_feasibility, 0);
}

TEST(SurrogateModelTest, LearnsTheGoodEndWhereTheBadEndIsFarAway) {
  const Answer explosive = [](const VectorXd& u) {
    ArchiveEntry entry = Answered(u);
    if (u[0] > 0.7) entry.metrics *= std::exp(80 * (u[0] - 0.7));
    return entry;
  };
  const Archive archive = Sampled(2, 40, explosive);
  SurrogateModel model({});
  model.Learn(archive);
  const VectorXd u = Eigen::Vector2d(0.35, 0.4);
  const VectorXd learnt = model.learnt().Of(Metrics(u));
  EXPECT_NEAR(model.At(u).metrics[0].mean, learnt[0], 0.2);
  // Better stays better.
  double last = -1;
  for (double y = 0; y < 1e9; y = 2 * y + 0.1) {
    const double value =
        model.learnt().Of(archive.CurrentScaling().ideal + y * archive.CurrentScaling().range)[0];
    EXPECT_GT(value, last);
    last = value;
  }
}

TEST(SurrogateModelTest, LearnsConstraintsAndWhatFails) {
  const Answer limited = [](const VectorXd& u) {
    ArchiveEntry entry = Answered(u);
    entry.constraints = Eigen::Vector2d(u[0] - 0.5, -1);  // the second was never violated
    if (u[1] > 0.6) entry = FailedAt(u);
    return entry;
  };
  const Archive archive = Sampled(2, 60, limited);
  SurrogateModel model({});
  model.Learn(archive);
  const auto probability = [&](double x, double y) {
    return std::exp(model.At(Eigen::Vector2d(x, y)).log_feasibility);
  };
  EXPECT_GT(probability(0.3, 0.3), 0.8);
  EXPECT_LT(probability(0.8, 0.3), 0.05);
  EXPECT_LT(probability(0.3, 0.9), 0.2);
}

TEST(SurrogateModelTest, TellsTheSlopeOfItsDoubts) {
  const Answer failing = [](const VectorXd& u) { return u[1] > 0.6 ? FailedAt(u) : Answered(u); };
  SurrogateModel model({});
  model.Learn(Sampled(2, 30, failing));
  const VectorXd u = Eigen::Vector2d(0.4, 0.58);
  const SurrogateModel::Belief belief = model.At(u);
  EXPECT_LT(belief.log_feasibility, 0);
  EXPECT_NEAR(model.AtAll(u).log_feasibilities[0], belief.log_feasibility, 1e-6);
  for (Index i = 0; i < 2; ++i) {
    const VectorXd move = 1e-5 * VectorXd::Unit(2, i);
    const double slope =
        (model.At(u + move).log_feasibility - model.At(u - move).log_feasibility) / 2e-5;
    EXPECT_NEAR(belief.log_feasibility_gradient[i], slope, 1e-3 * (1 + std::abs(slope)));
  }
}

TEST(SurrogateSearchTest, ProposesDesignsOfTheFront) {
  SurrogateSearch search({}, UnitBox(4), 1);
  const Archive archive = Searched(Sampled(4, 12), 4, 20, Answered, search);
  // On the line between the two places all parameters are the same.
  int on_front = 0;
  for (std::size_t entry = 12; entry < archive.size(); ++entry) {
    const VectorXd& u = archive[entry].u;
    if ((u.array() - u.mean()).abs().maxCoeff() < 0.05 && u.mean() > 0.2 && u.mean() < 0.8) {
      ++on_front;
    }
  }
  EXPECT_GE(on_front, 10);  // half of them
  const SurrogateQuality quality = search.quality();
  EXPECT_EQ(quality.proposals, 20);
  EXPECT_EQ(quality.predictions, 40);
  EXPECT_GT(quality.within_two_deviations, 0.6);
  EXPECT_LT(quality.median_error, 0.1);
}

TEST(SurrogateSearchTest, LeavesAloneWhatFails) {
  const auto fails = [](const VectorXd& u) { return u[0] + u[1] > 1.1; };
  const Answer failing = [&](const VectorXd& u) { return fails(u) ? FailedAt(u) : Answered(u); };
  SurrogateSearch search({}, UnitBox(2), 1);
  const Archive archive = Searched(Sampled(2, 16, failing), 2, 20, failing, search);
  int failed = 0;
  for (std::size_t entry = 16; entry < archive.size(); ++entry) {
    if (!archive[entry].evaluated) ++failed;
  }
  EXPECT_LE(failed, 7);  // of random ones 8
  EXPECT_EQ(search.quality().predictions, 2 * (20 - failed));
}

TEST(SurrogateSearchTest, ProposesSomethingElseWhileAProposalIsUnderWay) {
  Archive archive = Sampled(3, 15);
  SurrogateSearch search({}, UnitBox(3), 1);
  std::vector<VectorXd> under_way;
  for (int k = 0; k < 5; ++k) {
    const VectorXd u = Propose(search, archive, under_way);
    for (const VectorXd& other : under_way) EXPECT_GT((u - other).norm(), 0.01);
    under_way.push_back(u);
  }
}

TEST(SurrogateSearchTest, ASeedGivesTheSameProposals) {
  Archive archive = Sampled(3, 15);
  SurrogateSearch one({}, UnitBox(3), 7), other({}, UnitBox(3), 7);
  for (int k = 0; k < 2; ++k) EXPECT_EQ(Propose(one, archive), Propose(other, archive));
}

TEST(SurrogateSearchTest, ProposesWhatCanBeSetAndNothingTwice) {
  DesignSpace box = UnitBox(2);
  box.step = VectorXd::Constant(2, 0.5);
  Archive archive;
  archive.Add(Answered(Eigen::Vector2d(0, 0)));
  archive.Add(Answered(Eigen::Vector2d(1, 1)));
  SurrogateSearch search({}, box, 1);
  for (int k = 0; k < 7; ++k) {
    const auto source = search.Next(archive, {});
    const std::optional<VectorXd> u = source->Ask(archive);
    if (!u) break;
    for (const double value : *u) EXPECT_EQ(2 * value, std::round(2 * value));
    for (std::size_t entry = 0; entry < archive.size(); ++entry) EXPECT_NE(archive[entry].u, *u);
    source->Tell(archive, archive.Add(Answered(*u)));
  }
  if (archive.size() == 9) {
    const auto source = search.Next(archive, {});
    EXPECT_FALSE(source->Ask(archive));
    EXPECT_TRUE(source->Finished());
  }
}

TEST(SurrogateTallyTest, CountsWhatWasWithinTwoDeviations) {
  SurrogateTally tally;
  EXPECT_EQ(tally.quality().predictions, 0);
  for (const double value : {0.1, -0.3, 0.5, 2.5}) tally.AddPrediction(0, 1, value);
  tally.AddProposal();
  const SurrogateQuality quality = tally.quality();
  EXPECT_EQ(quality.proposals, 1);
  EXPECT_EQ(quality.predictions, 4);
  EXPECT_EQ(quality.within_two_deviations, 0.75);
  EXPECT_EQ(quality.median_error, 0.5);
}

}  // namespace
}  // namespace mortise::pareto
