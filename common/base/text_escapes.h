// Writes texts into files of other formats so that their readers get them back.
#pragma once

#include <string>
#include <string_view>

namespace mortise {

// Returns the text as a field of CSV (RFC 4180): in quotes, with quotes doubled, where it has a
// comma, a quote or the end of a line; otherwise as it is.
std::string CsvField(std::string_view text);

// Returns the text as a terminal shows it and nothing else: control characters, which move its
// cursor, change its colours or ring its bell, become "\\x1b". Line ends and tabs stay.
std::string EscapeControls(std::string_view text);

// Returns the text as XML and HTML have it between tags and in attributes.
std::string EscapeXml(std::string_view text);

}  // namespace mortise
