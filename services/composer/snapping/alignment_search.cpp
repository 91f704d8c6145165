#include "services/composer/snapping/alignment_search.h"

#include <cmath>
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
                  const std::vector<ChoiceOfPlanes>& choices, const IsAdmissible& is_admissible,
                  bool prunes)
      : set_(set), wish_(wish), choices_(choices), is_admissible_(is_admissible), prunes_(prunes) {}

  absl::StatusOr<std::optional<ChosenPlanes>> Find() {
    if (choices_.empty()) {
      MORTISE_RETURN_IF_ERROR(Look({}));
    } else {
      MORTISE_RETURN_IF_ERROR(Extend({}));
    }
    if (best_) best_->solved = solved_;
    return std::move(best_);
  }

 private:
  // What the choices are worth that have none of their values.
  struct Without {
    int given_up = 0;  // of an infinite worth
    double worth = 0;  // of the others
  };

  // Tries all values of the next choice, and none where it may have none.
  absl::Status Extend(const Without& without) {
    const ChoiceOfPlanes& choice = choices_[values_.size()];
    for (std::size_t i = 0; i < choice.values.size(); ++i) {
      held_.push_back({choice.form, choice.values[i], ""});
      values_.push_back(static_cast<int>(i));
      MORTISE_RETURN_IF_ERROR(Look(without));
      held_.pop_back();
      values_.pop_back();
    }
    if (!choice.worth) return absl::OkStatus();
    Without more = without;
    if (std::isinf(*choice.worth)) {
      ++more.given_up;
    } else {
      more.worth += *choice.worth;
    }
    values_.push_back(kNoPlane);
    MORTISE_RETURN_IF_ERROR(Look(more));
    values_.pop_back();
    return absl::OkStatus();
  }

  absl::Status Look(const Without& without) {
    const bool is_whole = values_.size() == choices_.size();
    if (!prunes_ && !is_whole) return Extend(without);
    ++solved_;
    MORTISE_ASSIGN_OR_RETURN(std::optional<MovableSet::Nearest> nearest,
                             set_.NearestTo(wish_, held_));
    if (!nearest) return absl::OkStatus();
    const double cost = nearest->cost + without.worth;
    if (!IsBetter(without.given_up, cost)) return absl::OkStatus();
    if (!is_whole) return Extend(without);
    if (is_admissible_) {
      MORTISE_ASSIGN_OR_RETURN(const bool is_admissible, is_admissible_(values_));
      if (!is_admissible) return absl::OkStatus();
    }
    best_ = ChosenPlanes{std::move(nearest->q), cost, without.given_up, values_, 0};
    return absl::OkStatus();
  }

  bool IsBetter(int given_up, double cost) const {
    if (!best_ || given_up != best_->given_up) return !best_ || given_up < best_->given_up;
    return cost < best_->cost * (1 - kSameCost);
  }

  const MovableSet& set_;
  const Eigen::VectorXd& wish_;
  const std::vector<ChoiceOfPlanes>& choices_;
  const IsAdmissible& is_admissible_;
  const bool prunes_;
  std::vector<Demand> held_;
  std::vector<int> values_;
  std::optional<ChosenPlanes> best_;
  int solved_ = 0;
};

}  // namespace

absl::StatusOr<std::optional<ChosenPlanes>> ChoosePlanes(const MovableSet& set,
                                                         const Eigen::VectorXd& wish,
                                                         const std::vector<ChoiceOfPlanes>& choices,
                                                         const IsAdmissible& is_admissible) {
  return AlignmentSearch(set, wish, choices, is_admissible, true).Find();
}

absl::StatusOr<std::optional<ChosenPlanes>> EnumeratePlanes(
    const MovableSet& set, const Eigen::VectorXd& wish, const std::vector<ChoiceOfPlanes>& choices,
    const IsAdmissible& is_admissible) {
  return AlignmentSearch(set, wish, choices, is_admissible, false).Find();
}

}  // namespace mortise::composer
