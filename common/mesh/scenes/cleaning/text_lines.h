// Text taken apart into lines and words.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>

namespace mortise::mesh {

// Lines of a text, whether "\n", "\r\n" or "\r" ends them.
class TextLines {
 public:
  explicit TextLines(std::string_view text) : rest_(text) {}

  // Returns the next line without its end; nothing at the end of the text.
  std::optional<std::string_view> Next() {
    if (rest_.empty()) return std::nullopt;
    ++number_;
    const std::size_t end = rest_.find_first_of("\r\n");
    const std::string_view line = rest_.substr(0, end);
    if (end == std::string_view::npos) {
      rest_ = {};
    } else {
      rest_.remove_prefix(rest_.compare(end, 2, "\r\n") == 0 ? end + 2 : end + 1);
    }
    return line;
  }

  // Returns the number of the line that was read last, from 1.
  long number() const { return number_; }

 private:
  std::string_view rest_;
  long number_ = 0;
};

inline std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kSpaces = " \t\v\f\r";
  const std::size_t begin = text.find_first_not_of(kSpaces);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpaces) + 1 - begin);
}

// Returns what stands before a comment.
inline std::string_view WithoutComment(std::string_view line) {
  return line.substr(0, line.find('#'));
}

// Takes the next word off a line; empty at its end.
inline std::string_view TakeWord(std::string_view& line) {
  constexpr std::string_view kSpaces = " \t\v\f\r";
  const std::size_t begin = line.find_first_not_of(kSpaces);
  if (begin == std::string_view::npos) {
    line = {};
    return {};
  }
  const std::size_t end = std::min(line.find_first_of(kSpaces, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(end);
  return word;
}

// Returns a whole number that fills the word; nothing for another word, or one beyond `Number`.
template <typename Number>
std::optional<Number> WholeNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number number = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (fault != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

// Returns a decimal number that fills the word, also NaN and infinity; nothing for another word.
// Numbers beyond double precision are infinite, or 0.
inline std::optional<double> DecimalNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double number = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (end != word.data() + word.size() || word.empty()) return std::nullopt;
  if (fault == std::errc::result_out_of_range) {
    return word.find("e-") != word.npos || word.find("E-") != word.npos ? 0 : HUGE_VAL;
  }
  if (fault != std::errc()) return std::nullopt;
  return number;
}

}  // namespace mortise::mesh
