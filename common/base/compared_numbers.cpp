#include "common/base/compared_numbers.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "common/base/units.h"

namespace mortise {
namespace {

constexpr int kMaxDigits = 17;      // with which every number reads back as itself
constexpr int kMaxDecimals = 6;     // a nanometre
constexpr double kSame = 0.999e-9;  // m; no further apart, lengths may read the same

std::string Text(double metres, int decimals) {
  std::string text = absl::StrFormat("%.*f", decimals, metres / kMillimetre);
  if (!std::isfinite(metres)) return text;
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text == "-0" ? "0" : text;
}

// Whether two that are further apart than `same` have one text.
bool HidesDifference(const std::vector<double>& numbers, const std::vector<std::string>& texts,
                     double same) {
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (texts[i] == texts[j] && std::abs(numbers[i] - numbers[j]) > same) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<std::string> ComparedMillimetres(const std::vector<double>& metres) {
  std::vector<std::string> texts(metres.size());
  for (int decimals = 1; decimals <= kMaxDecimals; ++decimals) {
    for (std::size_t i = 0; i < metres.size(); ++i) texts[i] = Text(metres[i], decimals);
    if (!HidesDifference(metres, texts, kSame)) break;
  }
  return texts;
}

std::vector<std::string> ComparedNumbers(const std::vector<double>& numbers) {
  std::vector<std::string> texts(numbers.size());
  for (int digits = 6; digits <= kMaxDigits; ++digits) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      texts[i] = absl::StrFormat("%.*g", digits, numbers[i]);
    }
    if (!HidesDifference(numbers, texts, 0)) break;
  }
  return texts;
}

}  // namespace mortise
