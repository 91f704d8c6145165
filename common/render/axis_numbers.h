// Chooses the numbers that stand along an axis or a scale of colours, and writes them.
#pragma once

#include <string>
#include <vector>

namespace mortise::render {

// Returns round numbers that divide [minimum, maximum] into about `count` steps, all within it.
std::vector<double> NiceTicks(double minimum, double maximum, int count);

// Returns a number as an axis writes it: at most `digits` significant digits, "1.2e6" outside 1e-4
// to 1e6.
std::string ShortNumber(double value, int digits = 4);

// Returns the numbers of one axis as ShortNumber writes them, but in as many more digits as it
// takes for different ones to be written differently. On a narrow range both ends would look alike.
std::vector<std::string> ShortNumbers(const std::vector<double>& values, int digits = 4);

}  // namespace mortise::render
