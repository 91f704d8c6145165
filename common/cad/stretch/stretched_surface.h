// Stretches surfaces by different factors along the axes. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <Eigen/Core>
#include <Geom_Surface.hxx>
#include <optional>
#include <vector>

namespace mortise::cad {

// Says where a parameter of a drawn surface goes on the stretched one.
struct ParameterMap {
  double scale = 1;
  double shift = 0;
  // The angles, rad, between which circles that have become rational splines are one arc. Scale and
  // shift do not count if there are any.
  std::vector<double> knots;

  bool IsLinear() const { return knots.empty(); }
  double At(double parameter) const;
};

// A surface whose point at (`u`(u), `v`(v)) is that of the drawn one at (u, v), stretched. That
// does not hold for planes.
struct StretchedSurface {
  Handle(Geom_Surface) surface;
  ParameterMap u, v;
};

// The part of a surface's parameters that a face takes up.
struct ParameterRange {
  double u_minimum = 0, u_maximum = 0, v_minimum = 0, v_maximum = 0;
};

// Stretches a surface exactly; `factors` > 0. Returns nothing for surfaces that are not listed
// here:
// - Planes stay planes.
// - Cylinders, cones and surfaces of revolution stay such if they are about a coordinate axis
//   across which the factors agree.
// - Other cylinders become elliptic ones.
// - Other surfaces of revolution, as balls are, become rational splines over `range`.
std::optional<StretchedSurface> StretchSurface(const Handle(Geom_Surface) & drawn,
                                               const Eigen::Vector3d& factors,
                                               const ParameterRange& range);

}  // namespace mortise::cad
