#include "services/pareto/front_finishing.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "services/pareto/front_bridging.h"
#include "services/pareto/outlier_repair.h"

namespace mortise::pareto {
namespace {

constexpr double kScarceShare = 0.05;  // of a budget that is not ample, left at the first round
constexpr double kTrialShare = 0.45;   // of an ample one, at the first two
constexpr double kLateShare = 0.12;    // at the third,
constexpr double kPayingShare = 0.2;   // if polishing pays
constexpr int kEarlyRounds = 2;
constexpr int kMostRounds = 12;
constexpr int kOutlierRounds = 3;  // of these, where polishing pays
constexpr std::size_t kTrial = 32;
constexpr std::int64_t kLastPart = 50;  // a fiftieth of the budget, for polishing alone,
constexpr double kLastGain = 1e-9;      // of whatever gains anything

}  // namespace

// Designs put back in line, then polished ones.
class FrontFinishing::Round : public PointSource {
 public:
  Round(std::vector<Eigen::VectorXd> points, std::size_t repaired, std::shared_ptr<Outcome> outcome)
      : list_(std::move(points)), repaired_(repaired), outcome_(std::move(outcome)) {
    outcome_->has_ended = list_.Finished();
  }

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override { return list_.Ask(archive); }

  void Tell(Archive& archive, std::size_t entry) override {
    list_.Tell(archive, entry);
    const std::vector<std::size_t>& front = archive.non_dominated();
    if (told_++ >= repaired_ && std::ranges::find(front, entry) != front.end()) ++outcome_->kept;
    outcome_->has_ended = list_.Finished();
  }

  bool Finished() const override { return list_.Finished(); }

 private:
  PointList list_;
  std::size_t repaired_;
  std::size_t told_ = 0;
  std::shared_ptr<Outcome> outcome_;
};

// What part of the budget is left when the next round begins.
double FrontFinishing::ShareLeft() const {
  if (!options_.is_ample) return std::ldexp(kScarceShare, -rounds_);
  if (rounds_ == 0 || (rounds_ < kEarlyRounds && Pays())) return kTrialShare;
  return std::ldexp(Pays() ? kPayingShare : kLateShare, -std::max(0, rounds_ - kEarlyRounds));
}

bool FrontFinishing::IsDue(std::int64_t left) const {
  if (!outcome_->has_ended) return false;
  if (PolishesOnly(left)) return true;
  if (rounds_ >= kMostRounds) return false;
  const double share = ShareLeft() * static_cast<double>(options_.evaluations);
  return left <= std::max<std::int64_t>(options_.window, static_cast<std::int64_t>(share));
}

bool FrontFinishing::PolishesOnly(std::int64_t left) const {
  return options_.is_ample && rounds_ >= kOutlierRounds && Pays() &&
         left < options_.evaluations / kLastPart;
}

std::unique_ptr<PointSource> FrontFinishing::NextRound(const Archive& archive, std::int64_t left) {
  if (!IsDue(left)) return nullptr;
  const bool is_trial = rounds_ == 0 || !Pays();
  const auto most = static_cast<std::size_t>(left);
  const std::size_t some = most * 3 / 5;  // the rest for what that brings, and was under way
  // What is put back in line is not quite on the front, which is the last thing to see to.
  const std::size_t outliers = is_trial || rounds_ < kOutlierRounds ? (most + 1) / 2 : 0;
  const Scaling scaling = archive.CurrentScaling();
  std::vector<Eigen::VectorXd> points = RepairedOutliers(archive, scaling, outliers);
  const std::size_t repaired = points.size();
  // Cells are those of the front at the end.
  PerformanceBuffer cells(options_.cells, scaling.ideal.size());
  cells.Rebuild(archive, scaling);
  const std::size_t wanted =
      std::min(most - repaired, is_trial ? std::min(kTrial, some) : std::max<std::size_t>(some, 1));
  std::vector<Eigen::VectorXd> polished = PolishesOnly(left)
                                              ? polishing_.Next(archive, cells, wanted, kLastGain)
                                              : polishing_.Next(archive, cells, wanted);
  outcome_ = std::make_shared<Outcome>();
  outcome_->polished = polished.size();
  std::ranges::move(polished, std::back_inserter(points));
  ++rounds_;
  return std::make_unique<Round>(std::move(points), repaired, outcome_);
}

}  // namespace mortise::pareto
