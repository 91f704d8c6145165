// How the bytes of a text that somebody gives stand for characters: UTF-8 with or without a mark.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace mortise {

// Returns what is wrong with a text in UTF-16 or UTF-32, with a mark or without, and how to save it
// as UTF-8; empty for others. What is wrong within a text of UTF-8 is the reader's to find.
std::string EncodingFault(std::string_view bytes);

// Returns the text without the byte-order mark that editors and spreadsheets put before UTF-8; one,
// as a second is a character.
std::string_view SkipByteOrderMark(std::string_view text);

// Both: the text without its mark, or INVALID_ARGUMENT naming `field` with the fault.
absl::StatusOr<std::string_view> WithoutByteOrderMark(std::string_view bytes,
                                                      std::string_view field);

}  // namespace mortise
