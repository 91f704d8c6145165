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

// Returns a text as a cell that spreadsheets show and do not run: with a ' in front where they
// would take it for a formula (OWASP, "CSV injection"). Those are texts that begin with "=", "@", a
// tab or a carriage return, or with "+" or "-" where more than a number follows; and, so that
// FromSpreadsheetText gives every text back, these with a ' or several in front. Comes before
// CsvField.
std::string SpreadsheetText(std::string_view text);

// Returns the text of which SpreadsheetText made the cell; other cells as they are.
std::string FromSpreadsheetText(std::string_view cell);

// Returns the text as XML and HTML have it between tags and in attributes.
std::string EscapeXml(std::string_view text);

}  // namespace mortise
