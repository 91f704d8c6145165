// Takes the noise out of coordinates that were measured in a drawing.
#pragma once

#include <vector>

namespace mortise::catalog {

// Returns the coordinates, m, with those that lie within `tolerance` > 0 of each other made equal.
// What is left of rounding in a drawing goes too: of the numbers between those that are made equal,
// or within 0.1 µm of them, the one of fewest decimals is taken, 0.3 for 0.29999997; unless it is
// so near by chance, as 0.0433013 is to 0.04330127, the height of a hexagon.
std::vector<double> SnapCoordinates(const std::vector<double>& coordinates, double tolerance);

// Returns the number of fewest decimals within `slack` of `value`.
double RoundestNear(double value, double slack);

}  // namespace mortise::catalog
