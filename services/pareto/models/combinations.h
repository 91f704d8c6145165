// Combines the values of discrete parameters: choices, whose values have no order (material,
// topology), and whole numbers of which there are few.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "common/base/random.h"
#include "services/pareto/archive/evaluation.h"

namespace mortise::pareto {

// A parameter that takes each of its values by itself.
struct DiscreteParameter {
  Eigen::Index parameter = 0;
  std::vector<double> values;  // ascending, within its bounds, at least one
};

// The value that each discrete parameter takes, by its index among the parameter's values.
using Combination = std::vector<int>;

// Fails with INVALID_ARGUMENT naming "discrete[i].parameter" for one that is not there or given
// twice, or "discrete[i].values" for values that do not ascend, lie beyond the bounds, or are none.
absl::Status Validate(const std::vector<DiscreteParameter>& discrete, const DesignSpace& space);

// Returns `choices`, and with them other parameters that are whole numbers (a step of 1 from a
// whole bound) of up to 8 values: those of fewest values first, as long as `evaluations` make some
// twenty for each combination. Where nothing but choices and whole numbers varies, and no more than
// `evaluations` designs are possible, it takes all of them: then every design can be evaluated.
std::vector<DiscreteParameter> WithWholeNumbers(const DesignSpace& space,
                                                std::vector<DiscreteParameter> choices,
                                                std::int64_t evaluations);

// Returns the parameters that can take more than one value and are not discrete.
std::vector<Eigen::Index> OtherParameters(const DesignSpace& space,
                                          const std::vector<DiscreteParameter>& discrete);

class CombinationSpace {
 public:
  CombinationSpace(DesignSpace space, std::vector<DiscreteParameter> discrete);

  // Returns how many combinations there are, at most 2^56.
  std::int64_t count() const { return count_; }
  const std::vector<DiscreteParameter>& discrete() const { return discrete_; }

  // Returns a combination by its number, 0 <= number < count(), with the last parameter varying
  // fastest.
  Combination At(std::int64_t number) const;

  // Returns the combination of a design; nullopt where one of its discrete parameters has none of
  // its values.
  std::optional<Combination> Of(const Eigen::VectorXd& x) const;

  // Returns the designs of a combination: the space with its discrete parameters fixed.
  DesignSpace SpaceOf(const Combination& combination) const;

  // Returns `wanted` different combinations (all, in order, if there are no more) in which each
  // value of a parameter comes about equally often.
  std::vector<Combination> SpaceFilling(std::int64_t wanted, Random& random) const;

  // Returns the combination with one parameter at another value, uniformly at random; the same if
  // there is no other.
  Combination Changed(const Combination& combination, Random& random) const;

  // Returns the combinations that differ in one parameter.
  std::vector<Combination> Neighbours(const Combination& combination) const;

 private:
  DesignSpace space_;
  std::vector<DiscreteParameter> discrete_;
  std::int64_t count_ = 1;
};

}  // namespace mortise::pareto
