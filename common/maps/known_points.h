// The points that a sampling has asked for, by position, with what became of them.
// Private to this folder.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "common/maps/lattice.h"

namespace mortise::maps {

class KnownPoints {
 public:
  enum class State { kWaiting, kGood, kFailed };

  explicit KnownPoints(int outputs)
      : outputs_(outputs),
        least_(Eigen::VectorXd::Constant(outputs, std::numeric_limits<double>::infinity())),
        most_(-least_) {}

  int count() const { return static_cast<int>(positions_.size()); }
  int waiting() const { return waiting_; }
  int failed() const { return static_cast<int>(reasons_.size()); }
  bool IsKnown(const LatticePoint& position) const { return index_.contains(position); }
  // The number of the point, which is added if it is new.
  int Want(const LatticePoint& position, bool probe);

  const LatticePoint& PositionOf(int number) const { return positions_[number]; }
  bool IsProbe(int number) const { return probe_[number] != 0; }
  State StateOf(int number) const { return states_[number]; }
  Eigen::Map<const Eigen::VectorXd> ValuesOf(int number) const {
    return {values_.data() + static_cast<std::size_t>(number) * outputs_, outputs_};
  }
  const std::map<int, std::string>& reasons() const { return reasons_; }

  void SetValues(int number, const Eigen::VectorXd& values);
  void SetFailure(int number, const std::string& reason);

  // For each output the difference between the largest and the smallest value known; 0 before there
  // is any. It is kept as values come, as each split asks for it.
  Eigen::VectorXd Range() const;

 private:
  int outputs_;
  int waiting_ = 0;
  std::vector<LatticePoint> positions_;
  std::vector<std::uint8_t> probe_;
  std::vector<State> states_;
  std::vector<double> values_;
  Eigen::VectorXd least_, most_;  // of the values known
  std::map<int, std::string> reasons_;
  std::unordered_map<LatticePoint, int, LatticeHash> index_;
};

}  // namespace mortise::maps
