// Numbers given as flags are decimal.
#pragma once

#include <CLI/CLI.hpp>

namespace mortise::cli {

// Makes every option of `app` and its commands that takes numbers refuse what is not in decimal
// notation: CLI11 by itself reads 0x10 as 16, 010 as 8, and infinity and NaN.
void RequireDecimalNumbers(CLI::App& app);

}  // namespace mortise::cli
