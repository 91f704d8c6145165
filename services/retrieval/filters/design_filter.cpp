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

bool MeetsPrice(const parametric::Cost& most, const std::optional<parametric::Cost>& cost) {
  return cost && cost->currency == most.currency && cost->amount <= most.amount;
}

bool MeetsAnySize(const DesignFilter& filter) {
  const DesignFilter none;
  return filter.min_size == none.min_size && filter.max_size == none.max_size;
}

}  // namespace

bool IsEmpty(const DesignFilter& filter) {
  return MeetsAnySize(filter) && !filter.materials && !filter.max_price && !filter.items;
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

MissedParts MissedBy(const DesignFacts& facts, const DesignFilter& filter) {
  const bool none = !facts.has_parts;
  return {.size = !MeetsAnySize(filter) && (none || !MeetsSize(filter, facts.size)),
          .materials =
              filter.materials && (none || !MeetsMaterials(*filter.materials, facts.materials)),
          .price = filter.max_price && (none || !MeetsPrice(*filter.max_price, facts.cost)),
          .items = filter.items && (none || !facts.needs || !LackingItems(filter, facts).empty())};
}

bool Meets(const DesignFilter& filter, const DesignFacts& facts) {
  return !MissedBy(facts, filter).Any();
}

std::vector<LackingItem> LackingItems(const DesignFilter& filter, const DesignFacts& facts) {
  std::vector<LackingItem> lacking;
  if (!filter.items || !facts.needs) return lacking;
  for (const parametric::ItemNeed& need : *facts.needs) {
    const auto found = filter.items->find(need.item);
    const double there = found == filter.items->end() ? 0 : found->second;
    const bool suffices = found != filter.items->end() && need.pieces <= there + kRounding;
    if (!suffices) lacking.push_back({need.item, need.pieces, there});
  }
  return lacking;
}

}  // namespace mortise::retrieval
