#include "common/cad/step/step_statements.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "common/cad/step/step_tokens.h"

namespace mortise::cad {
namespace {

constexpr int kMaxDepth = 32;            // lists in lists; the standards' types need four
constexpr double kMaxCoordinate = 1e12;  // in whatever unit
// Of any other number. Programs write 2e100 for what has no end.
constexpr double kLargest = 1e101;

absl::string_view Of(std::string_view text) { return {text.data(), text.size()}; }

// As compilers write what is no number.
bool IsNoNumber(std::string_view word) {
  for (const absl::string_view name : {"NAN", "INF", "INFINITY", "QNAN", "SNAN", "IND"}) {
    if (absl::EqualsIgnoreCase(Of(word), name)) return true;
  }
  return false;
}

// Where "#12=…;" stands.
struct Definition {
  std::uint64_t number = 0;
  std::size_t at = 0, end = 0;
};

class Reader {
 public:
  Reader(std::string_view text, std::size_t limit) : text_(text), limit_(limit) {}

  std::vector<std::string> Faults() {
    StepTokens tokens(text_);
    StepToken token = tokens.Next();
    while (token.kind != StepToken::Kind::kEnd && faults_.size() < limit_) {
      const StepToken next = tokens.Next();
      Take(token, next);
      token = next;
    }
    CheckRepeated();
    return std::move(faults_);
  }

 private:
  void Take(const StepToken& token, const StepToken& next) {
    using Kind = StepToken::Kind;
    if (token.IsSign(';')) return End(token);
    if (!is_open_) {
      is_open_ = true;
      is_entity_ = token.kind == Kind::kReference && next.IsSign('=');
      if (is_entity_) Begin(token);
      return;
    }
    if (!is_entity_) return;
    if (token.kind == Kind::kWord && next.IsSign('(')) {
      type_ = token.text;
      numbers_ = 0;
    } else if (token.kind == Kind::kWord && IsNoNumber(token.text)) {
      Tell(token, absl::StrCat(Of(token.text), " is no finite number"));
    } else if (token.kind == Kind::kNumber) {
      TakeNumber(token);
    } else if (token.kind == Kind::kReference && NumberOf(token) == entity_.number) {
      Tell(token, "refers to itself");
    } else if (token.IsSign('(')) {
      if (++depth_ == kMaxDepth) {
        Tell(token, absl::StrCat("has lists in lists, deeper than ", kMaxDepth, " levels"));
      }
    } else if (token.IsSign(')')) {
      CheckPoint(token);
      --depth_;
    }
  }

  void Begin(const StepToken& reference) {
    entity_ = {NumberOf(reference), reference.at, reference.at};
    type_ = {};
    depth_ = 0;
    numbers_ = 0;
  }

  void End(const StepToken& semicolon) {
    if (is_open_ && is_entity_) {
      entity_.end = semicolon.at;
      definitions_.push_back(entity_);
    }
    is_open_ = is_entity_ = false;
  }

  void TakeNumber(const StepToken& token) {
    ++numbers_;
    double value = 0;
    std::string_view digits = token.text;
    if (digits.front() == '+' || digits.front() == '-') digits.remove_prefix(1);
    const bool is_decimal = digits.find_first_not_of("0123456789.+-eE") == std::string_view::npos;
    if (IsNoNumber(digits) || absl::StrContains(Of(digits), '#')) {
      Tell(token, absl::StrCat(Of(token.text), " is no finite number"));
    } else if (!is_decimal || !absl::SimpleAtod(Of(token.text), &value)) {
      Tell(token, absl::StrCat(Of(token.text), " is no number"));
    } else if (!std::isfinite(value)) {
      Tell(token, absl::StrCat(Of(token.text), " is no finite number"));
    } else if (std::abs(value) > (type_ == "CARTESIAN_POINT" ? kMaxCoordinate : kLargest)) {
      Tell(token, absl::StrCat(Of(token.text), " is larger than anything that is drawn"));
    }
  }

  // At the end of a list of numbers.
  void CheckPoint(const StepToken& token) {
    if (type_ != "CARTESIAN_POINT" && type_ != "DIRECTION") return;
    if (numbers_ > 3) {
      Tell(token, absl::StrCat(Of(type_), " has ", numbers_,
                               " numbers, not three; is a comma among them meant for a point?"));
    }
    numbers_ = 0;
  }

  void CheckRepeated() {
    const auto by_number = [](const Definition& a, const Definition& b) {
      return std::pair(a.number, a.at) < std::pair(b.number, b.at);
    };
    std::sort(definitions_.begin(), definitions_.end(), by_number);
    for (std::size_t i = 1; i < definitions_.size() && faults_.size() < limit_; ++i) {
      const Definition& first = definitions_[i - 1];
      const Definition& second = definitions_[i];
      if (first.number != second.number || TextOf(first) == TextOf(second)) continue;
      faults_.push_back(absl::StrCat("#", first.number, ": is defined twice, in lines ",
                                     LineOf(text_, first.at), " and ", LineOf(text_, second.at)));
    }
  }

  std::string_view TextOf(const Definition& definition) const {
    return text_.substr(definition.at, definition.end - definition.at);
  }

  void Tell(const StepToken& token, std::string_view what) {
    faults_.push_back(
        absl::StrCat("#", entity_.number, ", line ", LineOf(text_, token.at), ": ", Of(what)));
  }

  const std::string_view text_;
  const std::size_t limit_;
  std::vector<std::string> faults_;
  std::vector<Definition> definitions_;
  bool is_open_ = false, is_entity_ = false;  // of the statement that is read
  Definition entity_;
  std::string_view type_;  // or one of the types, of which a complex entity has several
  int depth_ = 0;
  int numbers_ = 0;  // in the list that is read
};

}  // namespace

std::vector<std::string> StatementFaults(std::string_view text, std::size_t limit) {
  return Reader(text, limit).Faults();
}

}  // namespace mortise::cad
