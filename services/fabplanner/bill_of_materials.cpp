#include "services/fabplanner/bill_of_materials.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/dimension_text.h"

namespace mortise::fabplanner {
namespace {

constexpr double kLargestAmount = 1e12;

double RoundToCent(double amount) { return std::round(amount * 100) / 100; }

// Prices of small things, such as a peg, need more than cents.
double RoundUnitPrice(double amount) { return std::round(amount * 1e4) / 1e4; }

std::string DimensionsOf(const Item& item, const Eigen::Vector3d& size) {
  switch (item.kind) {
    case ItemKind::kDowel:
    case ItemKind::kScrew:
      return absl::StrCat("diameter ", Millimetres(size.y()), " × ", Millimetres(size.x()), " mm");
    default:
      return SizeText(size);
  }
}

BillLine MakeLine(const Item& item, const Eigen::Vector3d& size, int quantity) {
  BillLine line;
  line.item = item.name;
  line.title = item.title;
  line.quantity = quantity;
  line.dimensions = DimensionsOf(item, size);
  line.supplier = item.supplier;
  line.supplier_number = item.supplier_number;
  line.supplier_url = item.supplier_url;
  if (!item.price.currency.empty()) {
    const double pieces = item.price_per_volume ? size.prod() : 1;
    line.unit_price = {item.price.currency, RoundUnitPrice(item.price.amount * pieces)};
    line.price = {item.price.currency, RoundToCent(item.price.amount * pieces * quantity)};
  }
  return line;
}

// Adds the line's price to the bill's total. `priced_by` is the first item with a price.
absl::Status AddToTotal(const BillLine& line, Bill* bill, std::string* priced_by) {
  if (line.price.currency.empty()) return absl::OkStatus();
  if (bill->total.currency.empty()) {
    bill->total.currency = line.price.currency;
    *priced_by = line.item;
  }
  if (bill->total.currency != line.price.currency) {
    return PreconditionFailed(
        "CURRENCIES_DIFFER",
        absl::StrCat(line.item, " is priced in ", line.price.currency, " but ", *priced_by, " in ",
                     bill->total.currency, ": a bill needs one currency"),
        line.item);
  }
  bill->total.amount = RoundToCent(bill->total.amount + line.price.amount);
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Bill> MakeBill(const std::vector<Purchase>& purchases, const Items& items) {
  using Key = std::tuple<ItemKind, std::string, std::array<int64_t, 3>>;
  std::map<Key, Purchase> merged;
  for (std::size_t i = 0; i < purchases.size(); ++i) {
    const Purchase& purchase = purchases[i];
    const std::string field = absl::StrCat("purchases[", i, "]");
    const auto item = items.find(purchase.item);
    if (item == items.end()) return InvalidField(field, absl::StrCat("no item ", purchase.item));
    if (purchase.quantity <= 0) return InvalidField(field, "has no positive quantity");
    if (!purchase.size.allFinite() || purchase.size.minCoeff() <= 0 ||
        purchase.size.maxCoeff() > 1e3) {
      return InvalidField(field, absl::StrCat("has an unusable size of ", purchase.item));
    }
    if (!std::isfinite(item->second.price.amount) || item->second.price.amount < 0 ||
        item->second.price.amount > kLargestAmount) {
      return InvalidField(field, absl::StrCat("the price of ", purchase.item, " is unusable"));
    }
    const auto micrometres = [&](int axis) -> int64_t {
      return std::llround(purchase.size[axis] * 1e6);
    };
    const Key key{
        item->second.kind, purchase.item, {micrometres(0), micrometres(1), micrometres(2)}};
    const auto [entry, is_new] = merged.emplace(key, purchase);
    if (!is_new) entry->second.quantity += purchase.quantity;
  }

  Bill bill;
  std::string priced_by;
  for (const auto& [key, purchase] : merged) {
    bill.lines.push_back(MakeLine(items.at(purchase.item), purchase.size, purchase.quantity));
    MORTISE_RETURN_IF_ERROR(AddToTotal(bill.lines.back(), &bill, &priced_by));
  }
  return bill;
}

}  // namespace mortise::fabplanner
