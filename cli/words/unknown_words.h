// Says which words of a command line no command knows, and which may be meant.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace mortise::cli {

// Returns "there is no command 'catlog'; did you mean 'catalog'?" or "there is no option '--hous'
// of mortise up; did you mean '--house'?" of the words that parsing `arguments` left over in `app`,
// joined by line ends. Empty where none was left over.
std::string UnknownWords(const CLI::App& app, const std::vector<std::string>& arguments);

}  // namespace mortise::cli
