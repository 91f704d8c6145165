#include "services/fabplanner/plan/bill_of_materials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <tuple>

#include "absl/strings/str_cat.h"
#include "common/base/errors.h"
#include "services/fabplanner/plan/dimension_text.h"
#include "services/fabplanner/plan/money.h"

namespace mortise::fabplanner {
namespace {

constexpr double kMaxAmount = 1e12;

// Prices of small things, such as a peg, need more than the decimals of money.
double RoundUnitPrice(double amount) { return std::round(amount * 1e4) / 1e4; }

std::string DimensionsOf(const Item& item, const Eigen::Vector3d& size) {
  switch (item.kind) {
    case ItemKind::kDowel:
    case ItemKind::kScrew:
    case ItemKind::kBolt:
      return absl::StrCat("diameter ", Millimetres(size.y()), " × ", Millimetres(size.x()), " mm");
    default:
      return SizeText(size);
  }
}

BillLine MakeLine(const Item& item, const Purchase& purchase) {
  BillLine line;
  line.item = item.name;
  line.title = item.title;
  line.quantity = purchase.quantity;
  line.size = purchase.size;
  line.dimensions = DimensionsOf(item, purchase.size);
  line.supplier = item.supplier;
  line.supplier_number = item.supplier_number;
  line.supplier_url = item.supplier_url;
  if (!item.price.currency.empty() && !purchase.is_unpriced) {
    const double volumes = item.price_per_volume ? purchase.size.prod() : 1;
    const double piece = purchase.piece_price.value_or(item.price.amount * volumes);
    line.unit_price = {item.price.currency, RoundUnitPrice(piece)};
    line.price = RoundAsMoney({item.price.currency, piece * purchase.quantity});
  }
  return line;
}

bool IsAmount(double amount) {
  return std::isfinite(amount) && amount >= 0 && amount <= kMaxAmount;
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
    if (!IsAmount(item->second.price.amount) || !IsAmount(purchase.piece_price.value_or(0))) {
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
  std::map<std::string, double> totals;
  for (const auto& [key, purchase] : merged) {
    const BillLine& line = bill.lines.emplace_back(MakeLine(items.at(purchase.item), purchase));
    if (line.price.currency.empty()) continue;
    double& total = totals[line.price.currency];
    total = RoundAsMoney({line.price.currency, total + line.price.amount}).amount;
  }
  for (const auto& [currency, amount] : totals) bill.totals.push_back({currency, amount});
  return bill;
}

int UnpricedLines(const Bill& bill) {
  return static_cast<int>(
      std::count_if(bill.lines.begin(), bill.lines.end(),
                    [](const BillLine& l) { return l.price.currency.empty(); }));
}

}  // namespace mortise::fabplanner
