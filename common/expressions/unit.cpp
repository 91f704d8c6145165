#include "common/expressions/unit.h"

#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "common/base/names/offered_names.h"

namespace mortise::parametric {
namespace {

struct KnownUnit {
  const char* symbol;
  const char* prefixes;
  double factor;
  Dimension dimension;
};

const std::vector<KnownUnit>& KnownUnits() {
  static const std::vector<KnownUnit> units{{"1", "", 1, {}},
                                            {"m", "umck", 1, {{"m", 1}}},
                                            {"kg", "", 1, {{"kg", 1}}},
                                            {"g", "m", 1e-3, {{"kg", 1}}},
                                            {"s", "um", 1, {{"s", 1}}},
                                            {"min", "", 60, {{"s", 1}}},
                                            {"h", "", 3600, {{"s", 1}}},
                                            {"K", "", 1, {{"K", 1}}},
                                            {"rad", "", 1, {}},
                                            {"deg", "", std::numbers::pi / 180, {}},
                                            {"Hz", "kM", 1, {{"s", -1}}},
                                            {"N", "mkM", 1, {{"kg", 1}, {"m", 1}, {"s", -2}}},
                                            {"Pa", "kMG", 1, {{"kg", 1}, {"m", -1}, {"s", -2}}},
                                            {"J", "mkM", 1, {{"kg", 1}, {"m", 2}, {"s", -2}}},
                                            {"W", "mkM", 1, {{"kg", 1}, {"m", 2}, {"s", -3}}}};
  return units;
}

double FactorOf(char prefix) {
  switch (prefix) {
    case 'u':
      return 1e-6;
    case 'm':
      return 1e-3;
    case 'c':
      return 1e-2;
    case 'k':
      return 1e3;
    case 'M':
      return 1e6;
    default:
      return 1e9;
  }
}

bool IsLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool IsCurrency(std::string_view symbol) {
  return symbol.size() == 3 &&
         symbol.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") == std::string_view::npos;
}

absl::StatusOr<Unit> FindUnit(std::string_view symbol) {
  for (const KnownUnit& known : KnownUnits()) {
    if (symbol == known.symbol) return Unit{known.dimension, known.factor};
  }
  for (const KnownUnit& known : KnownUnits()) {
    const std::string_view prefixes = known.prefixes;
    if (symbol.size() > 1 && symbol.substr(1) == known.symbol &&
        prefixes.find(symbol[0]) != std::string_view::npos) {
      return Unit{known.dimension, known.factor * FactorOf(symbol[0])};
    }
  }
  if (IsCurrency(symbol)) return Unit{{{std::string(symbol), 1}}, 1};
  const std::string unknown(symbol);
  const auto symbol_of = [](const KnownUnit& known) { return std::string(known.symbol); };
  return absl::InvalidArgumentError(absl::StrCat("there is no unit '", unknown, "'",
                                                 NamesOffered(unknown, KnownUnits(), symbol_of)));
}

void Multiply(Unit& product, const Unit& by, double power) {
  product.factor *= std::pow(by.factor, power);
  for (const auto& [symbol, exponent] : by.dimension) {
    double& sum = product.dimension[symbol];
    sum += power * exponent;
    if (sum == 0) product.dimension.erase(symbol);
  }
}

class UnitParser {
 public:
  explicit UnitParser(std::string_view text) : text_(text) {}

  absl::StatusOr<Unit> Parse() {
    Unit unit;
    absl::Status status = ParseFactors(1, unit);
    if (status.ok() && Take('/')) {
      const bool is_group = Take('(');
      status = is_group ? ParseFactors(-1, unit) : ParseFactor(-1, unit);
      if (status.ok() && is_group && !Take(')')) status = Fault();
    }
    if (!status.ok()) return status;
    if (Peek() != '\0') return Fault();
    return unit;
  }

 private:
  char Peek() {
    while (position_ < text_.size() && text_[position_] == ' ') ++position_;
    return position_ < text_.size() ? text_[position_] : '\0';
  }
  bool Take(char c) {
    if (Peek() != c) return false;
    ++position_;
    return true;
  }
  absl::Status Fault() const {
    return absl::InvalidArgumentError(absl::StrCat(
        "'", std::string(text_), "' is no unit: write it as 'N m', 'kg/m^3' or 'W/(m^2 K)'"));
  }
  absl::Status ParseFactors(double sign, Unit& unit) {
    absl::Status status = ParseFactor(sign, unit);
    while (status.ok() && (Take('*') || IsLetter(Peek()))) status = ParseFactor(sign, unit);
    return status;
  }
  absl::Status ParseFactor(double sign, Unit& unit) {
    const char first = Peek();
    const std::size_t begin = position_;
    if (first == '1') {
      ++position_;
    } else {
      while (position_ < text_.size() && IsLetter(text_[position_])) ++position_;
    }
    if (position_ == begin) return Fault();
    const auto found = FindUnit(text_.substr(begin, position_ - begin));
    if (!found.ok()) return found.status();
    double power = 1;
    if (Take('^')) {
      Peek();
      const char* const from = text_.data() + position_;
      int value = 0;
      const auto [end, error] = std::from_chars(from, text_.data() + text_.size(), value);
      if (error != std::errc() || std::abs(value) > 12) return Fault();
      position_ += static_cast<std::size_t>(end - from);
      power = value;
    }
    Multiply(unit, *found, sign * power);
    return absl::OkStatus();
  }

  const std::string_view text_;
  std::size_t position_ = 0;
};

}  // namespace

absl::StatusOr<Unit> ParseUnit(std::string_view text) { return UnitParser(text).Parse(); }

std::string ToText(const Dimension& dimension) {
  if (dimension.empty()) return "1";
  return absl::StrJoin(dimension, " ", [](std::string* out, const auto& entry) {
    absl::StrAppend(out, entry.first);
    if (entry.second != 1) absl::StrAppend(out, "^", entry.second);
  });
}

}  // namespace mortise::parametric
