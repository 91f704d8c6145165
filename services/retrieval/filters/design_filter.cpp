#include "services/retrieval/filters/design_filter.h"

#include <algorithm>

#include "absl/status/statusor.h"

namespace mortise::retrieval {
namespace {

constexpr double kNanometre = 1e-9;
constexpr double kRounding = 1e-9;  // of a number of pieces

bool MeetsSize(const DesignFilter& filter, const parametric::EvaluatedDesign& design) {
  Eigen::Vector3d lower = design.parts.front().minimum;
  Eigen::Vector3d upper = design.parts.front().maximum;
  for (const parametric::EvaluatedPart& part : design.parts) {
    lower = lower.cwiseMin(part.minimum);
    upper = upper.cwiseMax(part.maximum);
  }
  const Eigen::Array3d size = upper - lower;
  return (size >= filter.min_size.array() - kNanometre).all() &&
         (size <= filter.max_size.array() + kNanometre).all();
}

bool MeetsMaterials(const std::set<std::string>& materials,
                    const parametric::EvaluatedDesign& design) {
  bool has_any = false;
  for (const parametric::EvaluatedPart& part : design.parts) {
    if (part.connecting) continue;
    if (!materials.contains(part.material)) return false;
    has_any = true;
  }
  return has_any;
}

bool MeetsPrice(const parametric::Cost& most, const parametric::EvaluatedDesign& design,
                const std::vector<parametric::Item>& items) {
  const absl::StatusOr<parametric::Cost> cost = parametric::CostOf(design, items);
  return cost.ok() && cost->currency == most.currency && cost->amount <= most.amount;
}

bool CanBeBuilt(const std::map<std::string, double>& available,
                const parametric::EvaluatedDesign& design,
                const std::vector<parametric::Item>& items) {
  const absl::StatusOr<std::vector<parametric::ItemNeed>> needs =
      parametric::NeedsOf(design, items);
  if (!needs.ok()) return false;
  return std::all_of(needs->begin(), needs->end(), [&](const parametric::ItemNeed& need) {
    const auto found = available.find(need.item);
    return found != available.end() && need.pieces <= found->second + kRounding;
  });
}

}  // namespace

bool IsEmpty(const DesignFilter& filter) {
  const DesignFilter none;
  return filter.min_size == none.min_size && filter.max_size == none.max_size &&
         !filter.materials && !filter.max_price && !filter.items;
}

bool MayMeet(const DesignFilter& filter, const std::vector<std::string>& items,
             const std::vector<std::string>& materials) {
  const auto has = [](const auto& wanted) {
    return [&wanted](const std::string& name) { return wanted.contains(name); };
  };
  if (filter.materials &&
      std::none_of(materials.begin(), materials.end(), has(*filter.materials))) {
    return false;
  }
  return !filter.items || std::any_of(items.begin(), items.end(), has(*filter.items));
}

bool Meets(const DesignFilter& filter, const parametric::EvaluatedDesign& design,
           const std::vector<parametric::Item>& items) {
  if (IsEmpty(filter)) return true;
  if (design.parts.empty()) return false;
  return MeetsSize(filter, design) &&
         (!filter.materials || MeetsMaterials(*filter.materials, design)) &&
         (!filter.max_price || MeetsPrice(*filter.max_price, design, items)) &&
         (!filter.items || CanBeBuilt(*filter.items, design, items));
}

}  // namespace mortise::retrieval
