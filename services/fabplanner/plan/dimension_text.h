// Lengths as people in a workshop read them: millimetres, to a tenth, without needless zeros.
#pragma once

#include <Eigen/Core>
#include <string>

namespace mortise::fabplanner {

// 0.7205 becomes "720.5".
std::string Millimetres(double metres);

// "2400 × 45 × 45 mm" for a size given as length, width, thickness, m.
std::string SizeText(const Eigen::Vector3d& size);

}  // namespace mortise::fabplanner
