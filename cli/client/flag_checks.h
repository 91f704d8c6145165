// What numbers given as flags must be.
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace mortise::cli {

// Returns a finite number above 0; CLI11's own check lets NaN pass.
inline CLI::Validator PositiveFinite() {
  return CLI::Validator(
      [](const std::string& text) {
        double number = 0;
        const bool is_good =
            CLI::detail::lexical_cast(text, number) && std::isfinite(number) && number > 0;
        return is_good ? std::string() : "must be a finite number above 0, not " + text;
      },
      "POSITIVE");
}

}  // namespace mortise::cli
