#include "common/maps/known_points.h"

#include <algorithm>

namespace mortise::maps {

int KnownPoints::Want(const LatticePoint& position, bool probe) {
  const auto [entry, added] = index_.try_emplace(position, count());
  if (added) {
    positions_.push_back(position);
    probe_.push_back(probe ? 1 : 0);
    states_.push_back(State::kWaiting);
    values_.resize(values_.size() + static_cast<std::size_t>(outputs_), 0.0);
    ++waiting_;
  }
  return entry->second;
}

void KnownPoints::SetValues(int number, const Eigen::VectorXd& values) {
  std::copy(values.begin(), values.end(),
            values_.begin() + static_cast<std::ptrdiff_t>(number) * outputs_);
  least_ = least_.cwiseMin(values);
  most_ = most_.cwiseMax(values);
  states_[number] = State::kGood;
  --waiting_;
}

void KnownPoints::SetFailure(int number, const std::string& reason) {
  states_[number] = State::kFailed;
  reasons_[number] = reason;
  --waiting_;
}

Eigen::VectorXd KnownPoints::Range() const {
  const bool is_any = waiting() + failed() < count();
  return is_any ? Eigen::VectorXd(most_ - least_) : Eigen::VectorXd::Zero(outputs_);
}

}  // namespace mortise::maps
