#include "cli/client/decimal_flags.h"

#include <string>

#include "common/base/decimal_number.h"

namespace mortise::cli {
namespace {

bool TakesNumbers(const CLI::Option& option) {
  // "FLOAT:POSITIVE" where it is checked besides.
  const std::string whole = option.get_type_name();
  const std::string type = whole.substr(0, whole.find(':'));
  return type == "INT" || type == "UINT" || type == "FLOAT";
}

// A number that CLI11 reads as it was meant: zeros before it would make it octal.
std::string CheckNumber(std::string& text) {
  if (!DecimalNumber(text)) return "must be a number in decimal notation, not " + text;
  const std::size_t sign = text.starts_with('+') || text.starts_with('-') ? 1 : 0;
  while (text.size() > sign + 1 && text[sign] == '0' && text[sign + 1] >= '0' &&
         text[sign + 1] <= '9') {
    text.erase(sign, 1);
  }
  return {};
}

}  // namespace

void RequireDecimalNumbers(CLI::App& app) {
  for (CLI::Option* const option : app.get_options()) {
    // First, so that checks of ranges see what it is.
    if (TakesNumbers(*option)) option->transform(CLI::Validator(CheckNumber, ""));
  }
  for (CLI::App* const command : app.get_subcommands([](CLI::App*) { return true; })) {
    RequireDecimalNumbers(*command);
  }
}

}  // namespace mortise::cli
