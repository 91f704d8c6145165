// Closes the gaps that a mesh leaves between parts that are meant to touch.
#pragma once

#include <Eigen/Geometry>
#include <vector>

namespace mortise::catalog {

// Stretches boxes until those meet that are apart by no more than `contact`, m, along each axis:
// parts that are only near each other hold nothing.
//
// Of two the smaller one is stretched. But parts that are alike stay so, as rows of them are
// patterns: all of them are stretched as the one that needs it most, on the same side, which keeps
// their spacing. Where they do not all need it, and what they are to touch has fewer that are like
// it, that is stretched instead.
//
// `first_alike` is of each box the first one that is alike, its own number if that is itself; boxes
// that are alike have one size. The rules are our own. O(B²) for B boxes.
void CloseGaps(double contact, const std::vector<int>& first_alike,
               std::vector<Eigen::AlignedBox3d>& boxes);

}  // namespace mortise::catalog
