#include "services/pareto/service/number_text.h"

#include "absl/strings/str_format.h"

namespace mortise::pareto {
namespace {

constexpr int kDigits = 6;
constexpr int kAllDigits = 17;  // tell any two doubles apart

}  // namespace

std::string TextBeside(double value, double other) {
  if (value == other) return absl::StrFormat("%.*g", kDigits, value);
  for (int digits = kDigits;; ++digits) {
    std::string text = absl::StrFormat("%.*g", digits, value);
    if (digits == kAllDigits || text != absl::StrFormat("%.*g", digits, other)) return text;
  }
}

}  // namespace mortise::pareto
