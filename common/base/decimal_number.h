// Numbers as people write them in files, on command lines and in expressions.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace mortise {

// The number that begins `text`, and how many bytes it takes.
struct DecimalPrefix {
  double value;
  std::size_t length;
};

// Returns a number in decimal notation: digits with a point among, before or after them, perhaps a
// sign before and a power of ten ("e-3") behind. Nothing else is one: no hexadecimal, infinity or
// NaN, no separators within, no comma for the point, whatever the locale; nothing that is too large
// or too small for a double.
std::optional<double> DecimalNumber(std::string_view text);

// Returns the longest such number at the beginning of a text; nothing if it begins with none.
std::optional<DecimalPrefix> DecimalNumberPrefix(std::string_view text);

// Returns a whole number in decimal notation, perhaps with a sign before; nothing if it is out of
// range.
std::optional<std::int64_t> DecimalInteger(std::string_view text);

}  // namespace mortise
