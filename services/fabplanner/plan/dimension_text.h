// Writes lengths as people in a workshop read them: millimetres, to a tenth, without needless
// zeros.
#pragma once

#include <Eigen/Core>
#include <string>

namespace mortise::fabplanner {

// Returns "720.5" for 0.7205.
std::string Millimetres(double metres);

// Returns "2400 × 45 × 45 mm" for a size given as length, width, thickness, m.
std::string SizeText(const Eigen::Vector3d& size);

}  // namespace mortise::fabplanner
