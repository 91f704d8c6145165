#include "common/render/axis_numbers.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>

#include "absl/strings/str_cat.h"

namespace mortise::render {

std::vector<double> NiceTicks(double minimum, double maximum, int count) {
  const double range = maximum - minimum;
  if (!(range > 0) || !std::isfinite(range) || count < 1) return {minimum};
  const double raw = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  const double fraction = raw / power;
  const double step = power * (fraction <= 1     ? 1
                               : fraction <= 2   ? 2
                               : fraction <= 2.5 ? 2.5
                               : fraction <= 5   ? 5
                                                 : 10);
  std::vector<double> ticks;
  // Multiples are counted as integers, so that 0 is exactly 0.
  for (double k = std::ceil(minimum / step - 1e-9); k * step <= maximum + 1e-9 * step; ++k) {
    ticks.push_back(k == 0 ? 0.0 : k * step);
    if (ticks.size() > 1000) break;
  }
  return ticks;
}

std::string ShortNumber(double value, int digits) {
  if (value == 0) return "0";
  if (!std::isfinite(value)) return std::isnan(value) ? "NaN" : value > 0 ? "∞" : "−∞";
  const double size = std::abs(value);
  char text[48];
  if (size >= 1e-4 && size < 1e6) {
    const int decimals = std::max(0, digits - 1 - static_cast<int>(std::floor(std::log10(size))));
    std::snprintf(text, sizeof text, "%.*f", decimals, value);
    std::string number = text;
    if (number.find('.') != std::string::npos) {
      number.erase(number.find_last_not_of('0') + 1);
      if (number.back() == '.') number.pop_back();
    }
    return number;
  }
  std::snprintf(text, sizeof text, "%.*e", digits - 1, value);
  std::string number = text;
  const std::size_t e = number.find('e');
  std::string mantissa = number.substr(0, e);
  if (mantissa.find('.') != std::string::npos) {
    mantissa.erase(mantissa.find_last_not_of('0') + 1);
    if (mantissa.back() == '.') mantissa.pop_back();
  }
  return absl::StrCat(mantissa, "e", std::atoi(number.c_str() + e + 1));
}

std::vector<std::string> ShortNumbers(const std::vector<double>& values, int digits) {
  constexpr int kMaxDigits = 15;
  const std::size_t different = std::set<double>(values.begin(), values.end()).size();
  std::vector<std::string> texts;
  do {
    texts.clear();
    for (const double value : values) texts.push_back(ShortNumber(value, digits));
  } while (std::set<std::string>(texts.begin(), texts.end()).size() < different &&
           ++digits <= kMaxDigits);
  return texts;
}

}  // namespace mortise::render
