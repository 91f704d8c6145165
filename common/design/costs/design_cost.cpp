#include "common/design/costs/design_cost.h"

#include <map>
#include <utility>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"

namespace mortise::parametric {
namespace {

// The share of a piece as sold that is this long, and this wide where that is cut, too.
double ShareOf(const Item& item, const Eigen::Vector3d& size) {
  double share = 1;
  for (int axis = 0; axis < 3; ++axis) {
    const ItemDimension& stock = item.dimensions[static_cast<std::size_t>(axis)];
    const bool is_cut = stock.process != Process::kNone && stock.size > 0;
    if (is_cut) share *= size[axis] / stock.size;
  }
  return share;
}

// What a piece of this size and volume takes of the item's stock, in the units that its price buys.
double Quantity(const Item& item, const Eigen::Vector3d& size, double volume) {
  return item.price_basis == PriceBasis::kPerVolume ? volume : ShareOf(item, size);
}

// Adds up in one currency.
class Bill {
 public:
  explicit Bill(const std::vector<Item>& items) : items_(items) {}

  absl::Status Add(const std::string& who, const std::string& item_name,
                   const Eigen::Vector3d& size, double volume) {
    const Item* const item = FindItem(items_, item_name);
    if (item == nullptr || item->price.currency.empty()) {
      return PreconditionFailed(
          "NO_PRICE",
          item == nullptr ? absl::StrCat(who, " is made of no item, so that nobody says its price")
                          : absl::StrCat(who, ": ", item_name, " has no price"),
          who);
    }
    if (total_.currency.empty()) {
      total_.currency = item->price.currency;
      first_ = item_name;
    }
    if (item->price.currency != total_.currency) {
      return PreconditionFailed("MIXED_CURRENCIES",
                                absl::StrCat(item_name, " has its price in ", item->price.currency,
                                             ", and ", first_, " in ", total_.currency),
                                who);
    }
    total_.amount += PartCost(*item, size, volume).amount;
    return absl::OkStatus();
  }

  const Cost& total() const { return total_; }

 private:
  const std::vector<Item>& items_;
  Cost total_;
  std::string first_;  // the item that decided on the currency
};

// The size of a peg in its item's axes: it is cut along its length, if at all.
Eigen::Vector3d SizeOf(const EvaluatedConnector& peg) {
  return {peg.length, peg.diameter, peg.diameter};
}

// Adds up by item.
class Needs {
 public:
  explicit Needs(const std::vector<Item>& items) : items_(items) {}

  absl::Status Add(const std::string& who, const std::string& item_name,
                   const Eigen::Vector3d& size) {
    const Item* const item = FindItem(items_, item_name);
    if (item == nullptr) {
      return PreconditionFailed("NO_ITEM", absl::StrCat(who, " is made of no item that is known"),
                                who);
    }
    pieces_[item_name] += ShareOf(*item, size);
    return absl::OkStatus();
  }

  std::vector<ItemNeed> Take() const {
    std::vector<ItemNeed> needs;
    for (const auto& [item, pieces] : pieces_) needs.push_back({item, pieces});
    return needs;
  }

 private:
  const std::vector<Item>& items_;
  std::map<std::string, double> pieces_;
};

std::string NameOf(const EvaluatedPart& part) { return absl::StrCat("part '", part.name, "'"); }

std::string NameOf(const EvaluatedConnector& peg) {
  return absl::StrCat("a peg of '", peg.connection, "'");
}

}  // namespace

absl::StatusOr<std::vector<ItemNeed>> NeedsOf(const EvaluatedDesign& design,
                                              const std::vector<Item>& items) {
  Needs needs(items);
  for (const EvaluatedPart& part : design.parts) {
    MORTISE_RETURN_IF_ERROR(needs.Add(NameOf(part), part.item, part.size));
  }
  for (const EvaluatedConnector& peg : design.connectors) {
    MORTISE_RETURN_IF_ERROR(needs.Add(NameOf(peg), peg.item, SizeOf(peg)));
  }
  return needs.Take();
}

Cost PartCost(const Item& item, const Eigen::Vector3d& size, double volume) {
  Cost cost;
  cost.currency = item.price.currency;
  if (!cost.currency.empty()) cost.amount = item.price.amount * Quantity(item, size, volume);
  return cost;
}

absl::StatusOr<Cost> CostOf(const EvaluatedDesign& design, const std::vector<Item>& items) {
  Bill bill(items);
  for (const EvaluatedPart& part : design.parts) {
    MORTISE_RETURN_IF_ERROR(bill.Add(NameOf(part), part.item, part.size, part.volume));
  }
  constexpr double kQuarterTurn = 0.78539816339744831;  // π/4
  for (const EvaluatedConnector& peg : design.connectors) {
    MORTISE_RETURN_IF_ERROR(bill.Add(NameOf(peg), peg.item, SizeOf(peg),
                                     kQuarterTurn * peg.diameter * peg.diameter * peg.length));
  }
  return bill.total();
}

std::string CurrencyOf(const std::vector<Item>& items) {
  std::string currency;
  for (const Item& item : items) {
    if (item.price.currency.empty()) continue;
    if (!currency.empty() && item.price.currency != currency) return "";
    currency = item.price.currency;
  }
  return currency;
}

}  // namespace mortise::parametric
