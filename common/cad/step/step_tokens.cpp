#include "common/cad/step/step_tokens.h"

#include <algorithm>
#include <limits>

namespace mortise::cad {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\0'; }
bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLetter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }
bool IsInWord(char c) { return IsLetter(c) || IsDigit(c) || c == '-'; }
bool IsInNumber(char c) { return IsLetter(c) || IsDigit(c) || c == '+' || c == '-' || c == '.'; }

// Where the characters end that `is_in` holds for.
template <typename IsIn>
std::size_t EndOf(std::string_view text, std::size_t from, const IsIn& is_in) {
  while (from < text.size() && is_in(text[from])) ++from;
  return from;
}

}  // namespace

StepToken StepTokens::Next() {
  using Kind = StepToken::Kind;
  SkipBlanks();
  if (at_ == text_.size()) return {Kind::kEnd, at_, {}};
  const char c = text_[at_];
  const char next = at_ + 1 < text_.size() ? text_[at_ + 1] : '\0';
  if (c == '\'') return Take(Kind::kText, EndOfText());
  if (c == '"') {
    return Take(Kind::kBinary, std::min(text_.find('"', at_ + 1), text_.size() - 1) + 1);
  }
  if (c == '#' && IsDigit(next)) return Take(Kind::kReference, EndOf(text_, at_ + 1, IsDigit));
  if (IsLetter(c)) return Take(Kind::kWord, EndOf(text_, at_, IsInWord));
  if (c == '.' && IsLetter(next)) {
    const std::size_t end = EndOf(text_, at_ + 1, IsInWord);
    const bool is_closed = end < text_.size() && text_[end] == '.';
    return Take(Kind::kEnum, end + (is_closed ? 1 : 0));
  }
  const bool is_signed = (c == '+' || c == '-') && (IsDigit(next) || IsLetter(next) || next == '.');
  if (IsDigit(c) || is_signed || (c == '.' && IsDigit(next))) {
    // "1.#INF" is what some compilers write for numbers that are none.
    const auto is_in = [](char letter) { return IsInNumber(letter) || letter == '#'; };
    return Take(Kind::kNumber, EndOf(text_, at_ + 1, is_in));
  }
  return Take(Kind::kSign, at_ + 1);
}

void StepTokens::SkipBlanks() {
  for (;;) {
    at_ = EndOf(text_, at_, IsBlank);
    if (text_.substr(at_, 2) != "/*") return;
    const std::size_t end = text_.find("*/", at_ + 2);
    at_ = end == std::string_view::npos ? text_.size() : end + 2;
  }
}

StepToken StepTokens::Take(StepToken::Kind kind, std::size_t end) {
  const StepToken token{kind, at_, text_.substr(at_, end - at_)};
  at_ = end;
  return token;
}

std::size_t StepTokens::EndOfText() const {
  for (std::size_t quote = text_.find('\'', at_ + 1); quote != std::string_view::npos;
       quote = text_.find('\'', quote + 2)) {
    if (quote + 1 == text_.size() || text_[quote + 1] != '\'') return quote + 1;
  }
  return text_.size();
}

std::uint64_t NumberOf(const StepToken& reference) {
  constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t number = 0;
  for (const char c : reference.text.substr(1)) {
    const auto digit = static_cast<std::uint64_t>(c - '0');
    if (number > (kLargest - digit) / 10) return kLargest;
    number = 10 * number + digit;
  }
  return number;
}

std::size_t LineOf(std::string_view text, std::size_t at) {
  const std::string_view before = text.substr(0, at);
  return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

}  // namespace mortise::cad
