// Gives corresponding paths of two surfaces corresponding vertices. Private to this folder.
#pragma once

#include <vector>

#include "services/interpolator/mapping/layout_surface.h"

namespace mortise::interpolator {

// Where both are to have a vertex.
struct CommonSample {
  double share = 0;                                // of the path's length
  bool is_in_first = false, is_in_second = false;  // whether they have one
};

// Returns the shares of both lists, in order. Both ascend from 0 to 1. A share of each that lie
// within a hundredth of the gaps beside them are one sample, so that none come too near each other.
std::vector<CommonSample> CommonSamples(const std::vector<double>& first,
                                        const std::vector<double>& second);

// Splits the paths so that they have as many vertices as each other, at the same shares of their
// lengths (CommonSamples).
void ShareSamples(LayoutSurface& source, LayoutSurface& target, int path);

}  // namespace mortise::interpolator
