// Makes round solids, which prisms (part_shape.h) only come near to, as CAD programs want them.
#pragma once

#include <Eigen/Core>
#include <string>

#include "absl/status/statusor.h"
#include "common/cad/solid.h"

namespace mortise::cad {

// A circle or ellipse extruded along w = u × v.
struct CylinderShape {
  std::string name;                                  // not empty
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // m, of the base
  Eigen::Vector3d u = Eigen::Vector3d::UnitX();      // unit vectors at a right angle
  Eigen::Vector3d v = Eigen::Vector3d::UnitY();
  double radius_u = 0;  // m, > 0; half the width along u
  double radius_v = 0;  // m, > 0; half the width along v
  double height = 0;    // m, > 0
};

// Makes the solid, with the faces "side", "base" and "cap". INVALID_ARGUMENT naming the field for a
// degenerate or non-finite shape.
absl::StatusOr<Solid> MakeCylinder(const CylinderShape& shape);

}  // namespace mortise::cad
