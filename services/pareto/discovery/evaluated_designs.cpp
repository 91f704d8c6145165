#include "services/pareto/discovery/evaluated_designs.h"

#include <algorithm>
#include <functional>
#include <string_view>

namespace mortise::pareto {
namespace {

std::size_t HashOf(const Eigen::VectorXd& u) {
  const Eigen::VectorXd one_zero = u.array() + 0.0;
  return std::hash<std::string_view>()(
      {reinterpret_cast<const char*>(one_zero.data()), sizeof(double) * one_zero.size()});
}

}  // namespace

void EvaluatedDesigns::Add(const Archive& archive, std::size_t entry) {
  const Eigen::VectorXd& u = archive[entry].u;
  if (!Find(archive, u)) entries_.emplace(HashOf(u), entry);
}

std::optional<std::size_t> EvaluatedDesigns::Find(const Archive& archive,
                                                  const Eigen::VectorXd& u) const {
  const auto [first, last] = entries_.equal_range(HashOf(u));
  const auto known =
      std::find_if(first, last, [&](const auto& each) { return archive[each.second].u == u; });
  return known == last ? std::nullopt : std::optional(known->second);
}

}  // namespace mortise::pareto
