// Measures of a ranked list in which some entries are relevant.
#pragma once

#include <vector>

namespace mortise::retrieval {

// The interpolated precision at `count` >= 2 recalls from 0 to 1, evenly apart: the largest
// precision at that recall or a larger one. `relevant` tells of each entry, nearest first; at least
// one must be.
std::vector<double> InterpolatedPrecisions(const std::vector<char>& relevant, int count);

// Of the first R entries, R of which are relevant in all, the share that is.
double FirstTier(const std::vector<char>& relevant);

}  // namespace mortise::retrieval
