#include "services/fabplanner/plan/money.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <utility>

#include "absl/strings/str_format.h"

namespace mortise::fabplanner {
namespace {

// What a few products and sums of doubles are wrong by, of their size.
constexpr double kSlack = 16 * std::numeric_limits<double>::epsilon();

// Of the smallest amount of a currency, what sums of shares are wrong by at most.
constexpr double kAlmost = 1e-6;

double HalfToEven(double value) {
  const double lower = std::floor(value);
  const bool is_half = std::abs(value - lower - 0.5) <= kSlack * std::max(1.0, std::abs(value));
  if (!is_half) return std::round(value);
  return std::fmod(lower, 2) == 0 ? lower : lower + 1;
}

}  // namespace

int MinorDigits(const std::string& currency) {
  static const std::set<std::string> kWhole = {"BIF", "CLP", "DJF", "GNF", "ISK", "JPY",
                                               "KMF", "KRW", "PYG", "RWF", "UGX", "UYI",
                                               "VND", "VUV", "XAF", "XOF", "XPF"};
  static const std::set<std::string> kThousandths = {"BHD", "IQD", "JOD", "KWD",
                                                     "LYD", "OMR", "TND"};
  if (kWhole.contains(currency)) return 0;
  if (kThousandths.contains(currency)) return 3;
  return currency == "CLF" || currency == "UYW" ? 4 : 2;
}

double MinorUnits(const Money& money) {
  return HalfToEven(money.amount * std::pow(10.0, MinorDigits(money.currency)));
}

Money FromMinorUnits(double units, const std::string& currency) {
  return {currency, units / std::pow(10.0, MinorDigits(currency))};
}

Money RoundAsMoney(const Money& money) {
  return money.currency.empty() ? Money{} : FromMinorUnits(MinorUnits(money), money.currency);
}

std::vector<double> SharedUnits(double units, const std::vector<double>& weights) {
  const double total = std::accumulate(weights.begin(), weights.end(), 0.0);
  double left = units;
  std::vector<double> shares;
  std::vector<std::pair<int64_t, std::size_t>> remainders;  // negative: the largest come first
  for (const double weight : weights) {
    const double share = units * weight / total;
    shares.push_back(std::floor(share + kAlmost));
    left -= shares.back();
    remainders.emplace_back(std::llround((shares.back() - share) / kAlmost), remainders.size());
  }
  std::sort(remainders.begin(), remainders.end());
  for (const auto& [remainder, place] : remainders) {
    if (left < 1) break;
    ++shares[place];
    --left;
  }
  return shares;
}

std::string AmountText(const Money& money) {
  if (money.currency.empty()) return "";
  return absl::StrFormat("%.*f", MinorDigits(money.currency), money.amount);
}

}  // namespace mortise::fabplanner
