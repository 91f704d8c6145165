// Stretches surfaces by different factors along the axes. Private to this folder: it brings Open
// CASCADE.
#pragma once

#include <Eigen/Core>
#include <Geom_Surface.hxx>
#include <optional>
#include <vector>

namespace mortise::cad {

// Where a parameter of a drawn surface goes on the stretched one.
struct ParameterMap {
  double scale = 1;
  double shift = 0;
  // Of circles that have become rational splines, the angles, rad, between which they are one arc;
  // scale and shift do not count then.
  std::vector<double> knots;

  bool IsLinear() const { return knots.empty(); }
  double At(double parameter) const;
};

// A surface whose point at (`u`(u), `v`(v)) is that of the drawn one at (u, v), stretched. Of
// planes that does not hold.
struct StretchedSurface {
  Handle(Geom_Surface) surface;
  ParameterMap u, v;
};

// The part of a surface's parameters that a face takes up.
struct ParameterRange {
  double u_minimum = 0, u_maximum = 0, v_minimum = 0, v_maximum = 0;
};

// Exact: planes stay planes, cylinders and cones and what is turned about a coordinate axis across
// which the factors agree stay such, other cylinders become elliptic ones, and what is turned
// otherwise, as balls are, rational splines over `range`. Nothing for other surfaces. factors > 0.
std::optional<StretchedSurface> StretchSurface(const Handle(Geom_Surface) & drawn,
                                               const Eigen::Vector3d& factors,
                                               const ParameterRange& range);

}  // namespace mortise::cad
