// Limits that every point of a front must keep to.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "services/pareto/archive/archive.h"

namespace mortise::v1 {
class DiscoverySpecification;
}

namespace mortise::pareto {

// minimum <= metric <= maximum, of which at least one is given.
struct Constraint {
  std::string metric;
  std::string unit;
  std::optional<double> minimum;
  std::optional<double> maximum;
  bool offers_gradient = false;
  std::optional<double> single_value = {};  // that minimum and maximum are a band about

  // Both limits at one value ask for that value. No design meets it to the last bit but by chance,
  // so that what is kept to is a band about it, a thousandth of the value wide.
  void WidenSingleValue();

  // A metric's value as discovery sees it: one g <= 0 for each limit.
  void AppendTo(double value, std::vector<double>& rows) const;
  // Returns the value that the first of its rows stands for.
  double ValueOf(double row) const;
  int rows() const { return (minimum ? 1 : 0) + (maximum ? 1 : 0); }

  // "mass is 7.1, not at most 7", for each limit that its rows miss; the numbers differ as printed.
  std::vector<std::string> Missed(const Eigen::Ref<const Eigen::VectorXd>& rows) const;
};

// Checks counts, limits and names given twice. INVALID_ARGUMENT naming the field: of limits apart
// from each other too, where they are less than a millionth of their size apart, with the least
// distance that makes sense, and for the single value 0, which says nothing of how wide a band it
// might be.
absl::Status CheckConstraints(const v1::DiscoverySpecification& specification);

// Returns what the design misses that is nearest to meeting all constraints. One must have been
// evaluated.
std::string MissedByNearest(const std::vector<Constraint>& constraints, const Archive& archive);

// Returns a remark for each constraint whose single value became a band.
std::vector<std::string> BandRemarks(const std::vector<Constraint>& constraints);

}  // namespace mortise::pareto
