// What a structure's map is made of, as messages from which others interpolate as it does.
#pragma once

#include <cstddef>
#include <vector>

#include "common/maps/interpolation_map.h"
#include "mortise/v1/interpolator.pb.h"

namespace mortise::interpolator {

// Numbers of a message: so many doubles leave room for what else a message holds.
inline constexpr int kMostNumbersOfPart = 300'000;

// Returns the tree of a map with the chosen ones of its metrics (`metrics`: rows of its values).
// What it says of shapes is left out.
v1::MapTree ExportTree(const maps::InterpolationMap& map, const std::vector<int>& metrics);

// Cuts a tree into parts that follow one another: of at most `most` numbers each, all but the last
// with `more`. Their lists, put together, are those of the tree.
std::vector<v1::MapTree> CutTree(const v1::MapTree& tree, int most = kMostNumbersOfPart);

// Cuts the shape of a sample into parts that follow one another: of at most `most` bytes of
// positions and values each, 4 at the least.
std::vector<v1::MapExportPart::Sample> CutSample(const v1::MapExportPart::Sample& sample,
                                                 std::size_t most = 8 * kMostNumbersOfPart);

}  // namespace mortise::interpolator
