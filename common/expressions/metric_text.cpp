#include "common/expressions/metric_text.h"

#include <optional>

#include "absl/strings/str_cat.h"
#include "common/base/decimal_number.h"
#include "common/base/errors.h"
#include "common/base/names/offered_names.h"

namespace mortise::parametric {
namespace {

bool IsWord(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

absl::Status At(std::size_t position, const std::string& message) {
  return absl::InvalidArgumentError(absl::StrCat("column ", position + 1, ": ", message));
}

class MetricTextReader {
 public:
  explicit MetricTextReader(std::string_view text) : source_(text) { read_.text = text; }

  absl::StatusOr<MetricText> Read() {
    while ((position_ = source_.find('\'', position_)) != std::string_view::npos) {
      if (SkipValue()) continue;
      const std::size_t begin = CallBefore(position_);
      QuotedTerm term{absl::StrCat("_", read_.terms.size()), {}, {}};
      MORTISE_RETURN_IF_ERROR(begin == position_ ? ReadQuantity(term) : ReadCall(begin, term));
      read_.text.replace(begin, position_ - begin, position_ - begin, ' ');
      read_.text.replace(begin, term.name.size(), term.name);
      read_.terms.push_back(std::move(term));
    }
    return std::move(read_);
  }

 private:
  // Where the call begins whose first argument is at `quote`; `quote` where there is no call.
  std::size_t CallBefore(std::size_t quote) const {
    std::size_t at = quote;
    while (at > 0 && IsBlank(source_[at - 1])) --at;
    if (at == 0 || source_[at - 1] != '(') return quote;
    --at;
    while (at > 0 && IsBlank(source_[at - 1])) --at;
    std::size_t begin = at;
    while (begin > 0 && IsWord(source_[begin - 1])) --begin;
    return begin == at ? quote : begin;
  }

  // Leaves the name of a choice's value where it is: what is compared and is no number.
  bool SkipValue() {
    const std::size_t end = source_.find('\'', position_ + 1);
    if (end == std::string_view::npos) return false;
    const std::string_view quoted = source_.substr(position_ + 1, end - position_ - 1);
    const auto compares = [](std::string_view text) { return text == "==" || text == "!="; };
    std::size_t before = position_;
    while (before > 0 && IsBlank(source_[before - 1])) --before;
    std::size_t after = end + 1;
    while (after < source_.size() && IsBlank(source_[after])) ++after;
    const bool is_compared = (before >= 2 && compares(source_.substr(before - 2, 2))) ||
                             compares(source_.substr(after, 2));
    if (!is_compared || DecimalNumberPrefix(quoted)) return false;
    position_ = end + 1;
    return true;
  }

  absl::StatusOr<std::string> ReadQuoted() {
    const std::size_t end = source_.find('\'', position_ + 1);
    if (end == std::string_view::npos) return At(position_, "the quotation has no end");
    std::string quoted(source_.substr(position_ + 1, end - position_ - 1));
    if (quoted.find_first_not_of(" \t\r\n") == std::string::npos) {
      return At(position_, "there is nothing between the quotes");
    }
    position_ = end + 1;
    return quoted;
  }

  char Next() {
    while (position_ < source_.size() && IsBlank(source_[position_])) ++position_;
    return position_ < source_.size() ? source_[position_] : '\0';
  }

  absl::Status ReadQuantity(QuotedTerm& term) {
    const std::size_t begin = position_;
    MORTISE_ASSIGN_OR_RETURN(const std::string quoted, ReadQuoted());
    const std::optional<DecimalPrefix> number = DecimalNumberPrefix(quoted);
    if (!number) {
      return At(begin, "outside of a function, quotes hold a number and its unit, as '30 N m'");
    }
    const auto unit = ParseUnit(std::string_view(quoted).substr(number->length));
    if (!unit.ok()) return At(begin, std::string(unit.status().message()));
    term.quantity = {number->value * unit->factor, unit->dimension};
    return absl::OkStatus();
  }

  absl::Status ReadCall(std::size_t begin, QuotedTerm& term) {
    const std::size_t end = source_.find_first_of("( \t\r\n", begin);
    const std::string name(source_.substr(begin, end - begin));
    term.call.function = FindMetricFunction(name);
    if (term.call.function == nullptr) {
      const auto name_of = [](const MetricFunction& each) { return std::string(each.name); };
      return At(begin, absl::StrCat("there is no function '", name, "' of faces and points",
                                    NamesOffered(name, MetricFunctions(), name_of)));
    }
    const MetricFunction& function = *term.call.function;
    std::vector<std::string>& places = term.call.places;
    while (true) {
      if (Next() != '\'') return At(position_, "expected a name in quotes");
      MORTISE_ASSIGN_OR_RETURN(places.emplace_back(), ReadQuoted());
      if (Next() != ',') break;
      ++position_;
    }
    if (Next() != ')') return At(position_, "expected ',' or ')'");
    ++position_;
    const auto wanted = static_cast<std::size_t>(function.places);
    if (function.source == MetricFunctionSource::kLoads && places.size() == wanted + 1) {
      term.call.load_case = std::move(places.back());
      places.pop_back();
    }
    if (places.size() == wanted) return absl::OkStatus();
    return At(begin, absl::StrCat(name, " takes ", wanted, wanted == 1 ? " place" : " places",
                                  function.source == MetricFunctionSource::kLoads
                                      ? " and a load case, which may be left out"
                                      : ""));
  }

  const std::string_view source_;
  std::size_t position_ = 0;
  MetricText read_;
};

}  // namespace

absl::StatusOr<MetricText> ReadMetricText(std::string_view text) {
  return MetricTextReader(text).Read();
}

}  // namespace mortise::parametric
