#include "common/design/costs/design_bill.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <tuple>

namespace mortise::parametric {
namespace {

constexpr double kMicrometre = 1e-6;  // m

class BillSum {
 public:
  explicit BillSum(const std::vector<Item>& items) : items_(items) {}

  void Add(const std::string& who, const std::string& item_name, const Eigen::Vector3d& size,
           double volume) {
    const Item* const item = FindItem(items_, item_name);
    // What is of no kind that is known comes after all kinds, and what is of no item last of all.
    int kind =
        item_name.empty() ? std::numeric_limits<int>::max() : std::numeric_limits<int>::max() - 1;
    if (item != nullptr) kind = static_cast<int>(item->kind);
    std::array<std::int64_t, 3> rounded{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      rounded[axis] = std::llround(size[static_cast<Eigen::Index>(axis)] / kMicrometre);
    }
    const auto [entry, is_new] = lines_.try_emplace(std::tuple(kind, item_name, rounded));
    BillLine& line = entry->second;
    if (is_new) {
      line.item = item_name;
      line.size = size;
      if (item != nullptr) line.piece_price = PartCost(*item, size, volume);
      line.price.currency = line.piece_price.currency;
    }
    if (line.parts.empty() || line.parts.back() != who) line.parts.push_back(who);
    ++line.quantity;
    // The volumes of one size may differ: a board with a corner cut off is priced by its own.
    if (item != nullptr) line.price.amount += PartCost(*item, size, volume).amount;
  }

  DesignBill Take() {
    DesignBill bill;
    std::map<std::string, double> totals;
    for (auto& [key, line] : lines_) {
      if (line.price.currency.empty()) {
        ++bill.unpriced;
      } else {
        totals[line.price.currency] += line.price.amount;
      }
      bill.lines.push_back(std::move(line));
    }
    for (const auto& [currency, amount] : totals) bill.totals.push_back({amount, currency});
    return bill;
  }

 private:
  const std::vector<Item>& items_;
  std::map<std::tuple<int, std::string, std::array<std::int64_t, 3>>, BillLine> lines_;
};

}  // namespace

DesignBill BillOf(const EvaluatedDesign& design, const std::vector<Item>& items) {
  BillSum sum(items);
  for (const EvaluatedPart& part : design.parts) {
    sum.Add(part.name, part.item, part.size, part.volume);
  }
  for (const EvaluatedConnector& peg : design.connectors) {
    sum.Add(peg.connection, peg.item, {peg.length, peg.diameter, peg.diameter},
            std::numbers::pi / 4 * peg.diameter * peg.diameter * peg.length);
  }
  return sum.Take();
}

}  // namespace mortise::parametric
