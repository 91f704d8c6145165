#include "services/composer/snapping/alignment_search.h"

#include <limits>
#include <utility>

#include "common/base/errors.h"

namespace mortise::composer {
namespace {

using parametric::Demand;

constexpr double kSameCost =
    1e-6;  // of the cost; rounding must not choose among what costs the same

class AlignmentSearch {
 public:
  AlignmentSearch(const MovableSet& set, const Eigen::VectorXd& wish,
                  const std::vector<ChoiceOfPlanes>& choices, bool prunes)
      : set_(set), wish_(wish), choices_(choices), prunes_(prunes) {}

  absl::StatusOr<std::optional<ChosenPlanes>> Find() {
    if (choices_.empty()) {
      MORTISE_RETURN_IF_ERROR(Look());
    } else {
      MORTISE_RETURN_IF_ERROR(Extend());
    }
    if (best_) best_->solved = solved_;
    return std::move(best_);
  }

 private:
  // Tries all values of the next choice.
  absl::Status Extend() {
    const ChoiceOfPlanes& choice = choices_[held_.size()];
    for (std::size_t i = 0; i < choice.values.size(); ++i) {
      held_.push_back({choice.form, choice.values[i], ""});
      values_.push_back(static_cast<int>(i));
      MORTISE_RETURN_IF_ERROR(Look());
      held_.pop_back();
      values_.pop_back();
    }
    return absl::OkStatus();
  }

  absl::Status Look() {
    const bool is_whole = held_.size() == choices_.size();
    if (!prunes_ && !is_whole) return Extend();
    ++solved_;
    MORTISE_ASSIGN_OR_RETURN(std::optional<MovableSet::Nearest> nearest,
                             set_.NearestTo(wish_, held_));
    if (!nearest) return absl::OkStatus();
    if (best_ && nearest->cost >= best_->cost * (1 - kSameCost)) return absl::OkStatus();
    if (!is_whole) return Extend();
    best_ = ChosenPlanes{std::move(nearest->q), nearest->cost, values_, 0};
    return absl::OkStatus();
  }

  const MovableSet& set_;
  const Eigen::VectorXd& wish_;
  const std::vector<ChoiceOfPlanes>& choices_;
  const bool prunes_;
  std::vector<Demand> held_;
  std::vector<int> values_;
  std::optional<ChosenPlanes> best_;
  int solved_ = 0;
};

}  // namespace

absl::StatusOr<std::optional<ChosenPlanes>> ChoosePlanes(
    const MovableSet& set, const Eigen::VectorXd& wish,
    const std::vector<ChoiceOfPlanes>& choices) {
  return AlignmentSearch(set, wish, choices, true).Find();
}

absl::StatusOr<std::optional<ChosenPlanes>> EnumeratePlanes(
    const MovableSet& set, const Eigen::VectorXd& wish,
    const std::vector<ChoiceOfPlanes>& choices) {
  return AlignmentSearch(set, wish, choices, false).Find();
}

}  // namespace mortise::composer
