#include "services/pareto/sources/front_finishing.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "services/pareto/sources/front_bridging.h"
#include "services/pareto/sources/outlier_repair.h"

namespace mortise::pareto {
namespace {

constexpr double kScarceShare = 0.05;  // of a budget that is not ample, left at the first round
constexpr double kEarlyShare = 0.45;   // of an ample one, and at the second if polishing pays,
constexpr double kPayingShare = 0.2;   // at the third, if it does
constexpr double kAgain = 2.0 / 3;     // of what was left at the last trial, at the next one
constexpr int kMaxRounds = 12;
constexpr int kOutlierRounds = 3;  // of these, where polishing pays
constexpr std::size_t kTrial = 32;
constexpr std::int64_t kLastPart = 50;  // a fiftieth of the budget, for polishing alone,
constexpr std::int64_t kPause = 16;
constexpr double kLastGain = 1e-9;     // of whatever gains anything,
constexpr double kMaxLastGain = 1e-3;  // at the very end of what models know exactly

}  // namespace

// Designs put back in line, then polished ones.
class FrontFinishing::Round : public PointSource {
 public:
  Round(const Archive& archive, std::vector<Eigen::VectorXd> points, std::size_t repaired,
        std::shared_ptr<Outcome> outcome)
      : list_(std::move(points)),
        known_(archive.size()),
        repaired_(repaired),
        outcome_(std::move(outcome)) {
    outcome_->has_ended = list_.Finished();
  }

  std::optional<Eigen::VectorXd> Ask(Archive& archive) override { return list_.Ask(archive); }

  void Tell(Archive& archive, std::size_t entry) override {
    list_.Tell(archive, entry);
    outcome_->has_ended = list_.Finished();
    // Where values can only be set in steps, a polished design may be what it came from.
    if (told_++ < repaired_ || entry < known_) return;
    const std::vector<std::size_t>& front = archive.non_dominated();
    ++outcome_->polished;
    if (std::ranges::find(front, entry) != front.end()) ++outcome_->kept;
  }

  bool Finished() const override { return list_.Finished(); }

 private:
  PointList list_;
  std::size_t known_;  // entries when it began
  std::size_t repaired_;
  std::size_t told_ = 0;
  std::shared_ptr<Outcome> outcome_;
};

bool FrontFinishing::Pays() const {
  return outcome_->polished > 0 ? 4 * outcome_->kept >= outcome_->polished : paid_;
}

// What part of the budget is left when the next round begins.
double FrontFinishing::ShareLeft() const {
  if (!options_.is_ample) return std::ldexp(kScarceShare, -rounds_);
  if (!Pays()) return kEarlyShare * std::pow(kAgain, rounds_);
  return rounds_ == 1 ? kEarlyShare : std::ldexp(kPayingShare, 2 - rounds_);
}

bool FrontFinishing::IsDue(std::int64_t left) const {
  if (!outcome_->has_ended) return false;
  if (PolishesOnly(left)) {
    // Each looks at all of the front, which takes time.
    if (outcome_->polished == 0) return left <= last_left_ / 2;
    return left <= last_left_ - std::max<std::int64_t>(options_.window, last_left_ / kPause);
  }
  if (rounds_ >= kMaxRounds) return false;
  const std::int64_t share = std::llround(ShareLeft() * static_cast<double>(options_.evaluations));
  return left <= (rounds_ == 0 ? std::max<std::int64_t>(options_.window, share) : share);
}

bool FrontFinishing::PolishesOnly(std::int64_t left) const {
  return options_.is_ample && rounds_ >= kOutlierRounds && Pays() &&
         left < options_.evaluations / kLastPart;
}

std::unique_ptr<PointSource> FrontFinishing::NextRound(const Archive& archive, std::int64_t left) {
  if (!IsDue(left)) return nullptr;
  const bool is_trial = rounds_ == 0 || !Pays();
  const auto most = static_cast<std::size_t>(left);
  // Nothing comes after the last round that could mend what goes wrong in it. Of the others the
  // rest is for what they bring, and what was under way.
  const bool is_last = PolishesOnly(left) && left <= 2 * options_.window;
  const std::size_t some = is_last ? most : std::max<std::size_t>(1, most * 3 / 5);
  // What is put back in line is not quite on the front, which is the last thing to see to.
  const std::size_t outliers = is_trial || rounds_ < kOutlierRounds ? (most + 1) / 2 : 0;
  const Scaling scaling = archive.CurrentScaling();
  std::vector<Eigen::VectorXd> points = RepairedOutliers(archive, scaling, outliers);
  const std::size_t repaired = points.size();
  // Cells are those of the front at the end.
  PerformanceBuffer cells(options_.cells, scaling.ideal.size());
  cells.Rebuild(archive, scaling);
  const std::size_t wanted = std::min(most - repaired, is_trial ? std::min(kTrial, some) : some);
  FrontPolishing::Choice choice{.typical = is_trial && options_.is_ample};
  if (PolishesOnly(left)) choice.least = kLastGain;
  if (is_last) choice.most = kMaxLastGain;
  std::vector<Eigen::VectorXd> polished = polishing_.Next(archive, cells, wanted, choice);
  paid_ = Pays();
  outcome_ = std::make_shared<Outcome>();
  std::ranges::move(polished, std::back_inserter(points));
  ++rounds_;
  last_left_ = left;
  return std::make_unique<Round>(archive, std::move(points), repaired, outcome_);
}

}  // namespace mortise::pareto
