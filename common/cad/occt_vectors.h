// Vectors of Open CASCADE as those of Eigen, and back.
#pragma once

#include <Eigen/Core>
#include <gp_Pnt.hxx>
#include <gp_XYZ.hxx>

namespace mortise::cad {

inline Eigen::Vector3d ToEigen(const gp_XYZ& vector) {
  return {vector.X(), vector.Y(), vector.Z()};
}

inline Eigen::Vector3d ToEigen(const gp_Pnt& point) { return ToEigen(point.XYZ()); }

inline gp_Pnt ToPoint(const Eigen::Vector3d& place) { return {place.x(), place.y(), place.z()}; }

}  // namespace mortise::cad
