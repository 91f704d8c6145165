#include "services/pareto/models/combinations.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::pareto {
namespace {

constexpr std::int64_t kMaxCombinations = std::int64_t{1} << 56;
constexpr std::int64_t kFewValues = 8;  // of a whole number
constexpr std::int64_t kEvaluationsACombination = 20;

// The product, or kMaxCombinations where it is more.
std::int64_t Times(std::int64_t count, std::int64_t values) {
  return count > kMaxCombinations / values ? kMaxCombinations : count * values;
}

// How many values a whole number takes; 0 for a parameter that is none, or takes but one.
std::int64_t WholeNumbers(const DesignSpace& space, Eigen::Index i) {
  if (space.step.size() == 0 || space.step[i] != 1 ||
      space.lower[i] != std::round(space.lower[i])) {
    return 0;
  }
  const double count = std::floor(space.upper[i] - space.lower[i]) + 1;
  return count < 2 || count > 1e9 ? 0 : static_cast<std::int64_t>(count);
}

DiscreteParameter WholeNumber(const DesignSpace& space, Eigen::Index i) {
  DiscreteParameter parameter{i, {}};
  for (double value = space.lower[i]; value <= space.upper[i]; ++value) {
    parameter.values.push_back(value);
  }
  return parameter;
}

}  // namespace

absl::Status Validate(const std::vector<DiscreteParameter>& discrete, const DesignSpace& space) {
  std::set<Eigen::Index> known;
  for (std::size_t k = 0; k < discrete.size(); ++k) {
    const auto& [parameter, values] = discrete[k];
    const std::string field = absl::StrCat("discrete[", k, "]");
    if (parameter < 0 || parameter >= space.size()) {
      return InvalidField(field + ".parameter", "there is no such parameter");
    }
    if (!known.insert(parameter).second) {
      return InvalidField(field + ".parameter", "is given twice");
    }
    if (values.empty()) return InvalidField(field + ".values", "at least one is needed");
    if (std::ranges::adjacent_find(values, std::greater_equal<>()) != values.end()) {
      return InvalidField(field + ".values", "must ascend");
    }
    if (!(values.front() >= space.lower[parameter]) || !(values.back() <= space.upper[parameter])) {
      return InvalidField(field + ".values", "must lie within the parameter's bounds");
    }
  }
  return absl::OkStatus();
}

std::vector<Eigen::Index> OtherParameters(const DesignSpace& space,
                                          const std::vector<DiscreteParameter>& discrete) {
  const Eigen::VectorXd most = space.FromUnit(Eigen::VectorXd::Ones(space.size()));
  std::vector<Eigen::Index> others;
  for (Eigen::Index i = 0; i < space.size(); ++i) {
    if (most[i] > space.lower[i] &&
        std::ranges::find(discrete, i, &DiscreteParameter::parameter) == discrete.end()) {
      others.push_back(i);
    }
  }
  return others;
}

std::vector<DiscreteParameter> WithWholeNumbers(const DesignSpace& space,
                                                std::vector<DiscreteParameter> choices,
                                                std::int64_t evaluations) {
  std::int64_t count = 1;
  for (const DiscreteParameter& choice : choices) {
    count = Times(count, static_cast<std::int64_t>(choice.values.size()));
  }
  std::vector<std::pair<std::int64_t, Eigen::Index>> whole;  // values, parameter
  std::int64_t all = count;
  bool others = false;
  for (const Eigen::Index i : OtherParameters(space, choices)) {
    const std::int64_t values = WholeNumbers(space, i);
    if (values > 0) whole.emplace_back(values, i);
    others = others || values == 0;
    all = Times(all, std::max<std::int64_t>(values, 1));
  }
  std::ranges::sort(whole);
  const bool enumerable = !others && all <= evaluations;
  for (const auto& [values, i] : whole) {
    if (!enumerable &&
        (values > kFewValues || kEvaluationsACombination * Times(count, values) > evaluations)) {
      break;
    }
    count = Times(count, values);
    choices.push_back(WholeNumber(space, i));
  }
  return choices;
}

CombinationSpace::CombinationSpace(DesignSpace space, std::vector<DiscreteParameter> discrete)
    : space_(std::move(space)), discrete_(std::move(discrete)) {
  for (const DiscreteParameter& each : discrete_) {
    count_ = Times(count_, static_cast<std::int64_t>(each.values.size()));
  }
}

Combination CombinationSpace::At(std::int64_t number) const {
  Combination combination(discrete_.size());
  for (std::size_t k = discrete_.size(); k-- > 0;) {
    const auto values = static_cast<std::int64_t>(discrete_[k].values.size());
    combination[k] = static_cast<int>(number % values);
    number /= values;
  }
  return combination;
}

std::optional<Combination> CombinationSpace::Of(const Eigen::VectorXd& x) const {
  Combination combination;
  for (const DiscreteParameter& each : discrete_) {
    const auto at = std::ranges::find(each.values, x[each.parameter]);
    if (at == each.values.end()) return std::nullopt;
    combination.push_back(static_cast<int>(at - each.values.begin()));
  }
  return combination;
}

DesignSpace CombinationSpace::SpaceOf(const Combination& combination) const {
  DesignSpace space = space_;
  for (std::size_t k = 0; k < discrete_.size(); ++k) {
    const auto& [parameter, values] = discrete_[k];
    space.lower[parameter] = space.upper[parameter] =
        values[static_cast<std::size_t>(combination[k])];
  }
  return space;
}

std::vector<Combination> CombinationSpace::SpaceFilling(std::int64_t wanted, Random& random) const {
  std::vector<Combination> chosen;
  if (count_ <= wanted) {
    for (std::int64_t number = 0; number < count_; ++number) chosen.push_back(At(number));
    return chosen;
  }
  std::set<Combination> known;
  std::vector<std::vector<int>> decks(discrete_.size());
  while (static_cast<std::int64_t>(chosen.size()) < wanted) {
    Combination combination;
    for (std::size_t k = 0; k < discrete_.size(); ++k) {
      std::vector<int>& deck = decks[k];
      if (deck.empty()) {
        for (std::size_t v = 0; v < discrete_[k].values.size(); ++v) {
          deck.push_back(static_cast<int>(v));
        }
        for (std::size_t v = deck.size(); v > 1; --v) std::swap(deck[v - 1], deck[random.Index(v)]);
      }
      combination.push_back(deck.back());
      deck.pop_back();
    }
    while (!known.insert(combination).second) combination = Changed(combination, random);
    chosen.push_back(std::move(combination));
  }
  return chosen;
}

Combination CombinationSpace::Changed(const Combination& combination, Random& random) const {
  std::vector<std::size_t> varying;
  for (std::size_t k = 0; k < discrete_.size(); ++k) {
    if (discrete_[k].values.size() > 1) varying.push_back(k);
  }
  if (varying.empty()) return combination;
  const std::size_t k = varying[random.Index(varying.size())];
  const std::size_t values = discrete_[k].values.size();
  Combination changed = combination;
  changed[k] = static_cast<int>(
      (static_cast<std::size_t>(changed[k]) + 1 + random.Index(values - 1)) % values);
  return changed;
}

std::vector<Combination> CombinationSpace::Neighbours(const Combination& combination) const {
  std::vector<Combination> neighbours;
  for (std::size_t k = 0; k < discrete_.size(); ++k) {
    for (int v = 0; v < static_cast<int>(discrete_[k].values.size()); ++v) {
      if (v == combination[k]) continue;
      neighbours.push_back(combination);
      neighbours.back()[k] = v;
    }
  }
  return neighbours;
}

}  // namespace mortise::pareto
