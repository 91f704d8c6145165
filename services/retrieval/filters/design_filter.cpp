#include "services/retrieval/filters/design_filter.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "absl/status/statusor.h"

namespace mortise::retrieval {
namespace {

constexpr double kNanometre = 1e-9;
constexpr double kRounding = 1e-9;  // of a number of pieces

bool MeetsSize(const DesignFilter& filter, const Eigen::Array3d& size) {
  return (size >= filter.min_size.array() - kNanometre).all() &&
         (size <= filter.max_size.array() + kNanometre).all();
}

bool MeetsMaterials(const std::set<std::string>& wanted, const std::set<std::string>& materials) {
  return !materials.empty() &&
         std::all_of(materials.begin(), materials.end(),
                     [&](const std::string& each) { return wanted.contains(each); });
}

bool CanBeBuilt(const std::map<std::string, double>& available,
                const std::vector<parametric::ItemNeed>& needs) {
  return std::all_of(needs.begin(), needs.end(), [&](const parametric::ItemNeed& need) {
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

DesignFacts FactsOf(const parametric::EvaluatedDesign& design,
                    const std::vector<parametric::Item>& items) {
  DesignFacts facts;
  if (design.parts.empty()) return facts;
  facts.has_parts = true;
  Eigen::AlignedBox3d box;
  for (const parametric::EvaluatedPart& part : design.parts) {
    box.extend(part.minimum).extend(part.maximum);
    if (!part.connecting) facts.materials.insert(part.material);
  }
  facts.size = box.sizes();
  if (auto cost = parametric::CostOf(design, items); cost.ok()) facts.cost = *std::move(cost);
  if (auto needs = parametric::NeedsOf(design, items); needs.ok()) facts.needs = *std::move(needs);
  return facts;
}

bool Meets(const DesignFilter& filter, const DesignFacts& facts) {
  if (IsEmpty(filter)) return true;
  if (!facts.has_parts || !MeetsSize(filter, facts.size)) return false;
  if (filter.materials && !MeetsMaterials(*filter.materials, facts.materials)) return false;
  if (filter.max_price && (!facts.cost || facts.cost->currency != filter.max_price->currency ||
                           facts.cost->amount > filter.max_price->amount)) {
    return false;
  }
  return !filter.items || (facts.needs && CanBeBuilt(*filter.items, *facts.needs));
}

}  // namespace mortise::retrieval
